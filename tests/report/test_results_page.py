"""docs/results.md: made of the kept tables, and judged like the paper by its own numbers."""

import itertools
import re
import shutil
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import yaml

from burstcast.tables.published import published_percentiles
from burstcast_report import results_page
from burstcast_report.claims import CLAIMS, NOT_KEPT, RV, all_of, findings, verdict
from burstcast_report.results_tables import (
    PUBLISHED,
    Tables,
    forecasters_apart,
    own_training_set,
    quartiles,
    scatter,
    sweep,
)
from burstcast_workflow.campaign.campaign import Campaign
from burstcast_workflow.config.loading import load
from burstcast_workflow.tables.registry import table_names
from snaketrust.records import Records
from snaketrust.run import VARIABLE, Run

ROOT = Path(__file__).parents[2]
CASES = {400: "Re400", 600: "Re600", 800: "Re800", 1000: "Re1000"}
TIMES = np.arange(0.5, 5.5, 0.5)
HALF_WIDTH = 0.02  # of all intervals, relative


def test_the_page_is_that_of_the_kept_tables():
    page = (ROOT / "docs" / "results.md").read_text(encoding="utf-8")
    assert page == results_page.page(), "make results"


# -- the paper's numbers as if they were ours ------------------------------------------------------


def published(table):
    """Percentiles that the paper published, with the sizes and cases that are not published.

    What is missing is like the nearest that is there: 2500 and 3000 neurons like 2000 (but what
    the text says of 2500 and 3000), other Reynolds numbers like 600, later ones a little better in
    the horizon as the text says.
    """
    found = published_percentiles(pd.read_csv(PUBLISHED), table)
    networks = found[found["forecaster"] == "esn"]
    parts = [found]
    for size in (2500, 3000):
        like = networks[(networks["reynolds"] == 400) & (networks["neurons"] == 2000)]
        keys = ["reynolds", "neurons", "validation", "prediction_time_lt", "metric"]
        new = like.assign(neurons=float(size))
        there = set(map(str, found[keys].to_numpy().tolist()))
        parts.append(new[[str(row) not in there for row in new[keys].to_numpy().tolist()]])
    for number, reynolds in enumerate((800, 1000), 1):
        like = networks[networks["reynolds"] == 600].assign(reynolds=reynolds)
        later = 1 + 0.01 * number * (like["metric"] == "mean_horizon_lt")
        parts.append(like.assign(**{p: like[p] * later for p in ("p25", "p50", "p75")}))
    return pd.concat(parts, ignore_index=True)


def write(directory, name, rows):
    """Percentile table of a campaign, and intervals of one network, of published rows."""
    rows = rows.assign(case=rows["reynolds"].map(CASES), networks=10)
    rows[["p25", "p75"]] = rows[["p25", "p75"]].apply(lambda column: column.fillna(rows["p50"]))
    rows.to_csv(directory / f"{name}_percentiles.csv", index=False)
    ends = rows.assign(
        seed=0, low=rows["p50"] * (1 - HALF_WIDTH), high=rows["p50"] * (1 + HALF_WIDTH)
    )
    ends.drop(columns=["p25", "p50", "p75", "networks"]).to_csv(
        directory / f"{name}_intervals.csv", index=False
    )
    return ends


@pytest.fixture
def like_the_paper(tmp_path):
    exponents = (0.0163, 0.0135, 0.0126, 0.0121)
    dataset = pd.DataFrame(
        {
            "case": CASES.values(),
            "reynolds": CASES.keys(),
            "series_generated": 2000,
            "series_kept": [1436, 1900, 1980, 1998],
            "mean_observable": 0.06,
            "events_per_series": 2.4,
            **{
                f"lyapunov_exponent{way}{end}": np.array(exponents) * factor
                for way in ("", "_by_growth")
                for end, factor in (("", 1.0), ("_low", 0.99), ("_high", 1.01))
            },
            "lyapunov_exponent_paper": exponents,
        }
    )
    dataset.to_csv(tmp_path / "dataset.csv", index=False)
    for name in ("classification", "horizon", "statistics", "hyperparameters"):
        write(tmp_path, name, published(name))
    counts = {"true_positive": 360, "false_positive": 0, "true_negative": 6554}
    equations = {"case": "Re400", "forecaster": "equations", "prediction_time_lt": 5.0}
    pd.DataFrame([{**equations, **counts, "false_negative": 0}]).to_csv(
        tmp_path / "classification.csv", index=False
    )
    # a tail that control makes steeper: times beyond 0.1 and 0.3 are divided by 4 and 11
    low = np.linspace(0.1, 0.48, 39)[:-1]
    density = {
        "density_uncontrolled": np.exp(-low / 0.1) / np.exp(-1),
        "density_controlled": np.exp(-low / 0.06) / np.exp(-1 / 0.6) / 3,
    }
    pd.concat(
        pd.DataFrame({"low": low, "high": low + 0.01, **density}).assign(
            case=case, neurons=2000, prediction_time_lt=time, **RV
        )
        for case in CASES.values()
        for time in (1.0, 2.0)
    ).to_csv(tmp_path / "control_density.csv", index=False)
    control = published("control")
    without = control.assign(metric="exceedance_uncontrolled", p25=0.13, p50=0.13, p75=0.13)
    ends = write(tmp_path, "control", pd.concat([control, without]))
    (tmp_path / "control_intervals.csv").unlink()
    ours = ends[ends["metric"] == "exceedance_controlled"].reset_index(drop=True)
    ours["value"] = published("control")["p50"].to_numpy()
    ours.assign(strategy="prediction_triggered").to_csv(
        tmp_path / "control_strategies.csv", index=False
    )
    ours.assign(exceedance_controlled=ours["value"]).to_csv(tmp_path / "control.csv", index=False)
    return tmp_path


def test_the_paper_agrees_with_its_own_claims(like_the_paper):
    found = findings(Tables(like_the_paper)).set_index("claim")
    # the authors' networks of 1000 are worse than their training set, by the formulas
    density = (
        "the density of k improves on the training set (Kantorovich metric; mean logarithmic error)"
    )
    profiles = "profiles improve on the training set (NRMSE of u; u^2; uv)"
    assert found.loc[density, "agrees"] == "11 of 12"
    assert found.loc[profiles, "agrees"] == "16 of 18"
    # their networks of 500 have clearly larger logarithmic errors than those from 2000 on
    size = "and does not improve with size"
    assert found.loc[size, "agrees"] == "27 of 30"
    # and their profiles improve by more than their densities at two of six sizes
    field = "the flow field improves less on the training set than the kinetic energy"
    assert found.loc[field, "agrees"] == "4 of 6"
    others = found.drop(index=[density, profiles, size, field])
    assert others["agrees"].eq("yes").all(), others[["paper", "ours", "agrees"]].to_string()


@pytest.mark.parametrize("claim", CLAIMS, ids=lambda claim: claim.text)
def test_every_claim_can_fail(claim, like_the_paper):
    """Numbers that are all the same, or turned round, agree with no claim."""
    for path in like_the_paper.glob("*.csv"):
        table = pd.read_csv(path)
        for column in ("p25", "p50", "p75", "low", "high"):
            if column not in table or "metric" not in table:
                continue
            value = table[column]
            opposed = {"RV": 0.5, "SSV": 0.7}
            table[column] = value * table["validation"].map(opposed).fillna(0.1)
            early = table.get("prediction_time_lt", pd.Series(2.0, table.index)) < 1.5
            table[column] *= np.where(early & table["metric"].eq("exceedance_controlled"), 5, 1)
            table[column] *= np.where(table["case"] != "Re400", 3 - table["reynolds"] / 500, 1)
            sizes = table["neurons"].fillna(1000)
            table[column] *= np.where(table["metric"].eq("f_score"), sizes / 3000, 1)
            errors = table["metric"].isin(["kantorovich", "mean_log_error", "nrmse_u"])
            table[column] *= np.where(errors, 3000 / sizes, 1)
        if "density_controlled" in table:
            table["density_controlled"] = table["density_uncontrolled"] * 1.1
        if "true_positive" in table:
            table["true_positive"] = 2 * table["true_positive"]
        for column in ("series_kept", "lyapunov_exponent_low", "lyapunov_exponent_high"):
            if column in table:
                table[column] = table[column] * 0.8 if "low" in column else table[column] * 0.9
        table.to_csv(path, index=False)
    assert claim.find(Tables(like_the_paper)).agrees != "yes"


def claim(text):
    (found,) = (one for one in CLAIMS if one.text.startswith(text))
    return found


def test_an_order_of_magnitude_is_looked_up_for_each_prediction_time(like_the_paper):
    path = like_the_paper / "control_density.csv"
    table = pd.read_csv(path)
    weak = (table["prediction_time_lt"] == 2) & (table["case"] != "Re1000")
    table.loc[weak, "density_controlled"] = table.loc[weak, "density_uncontrolled"] / 3
    table.to_csv(path, index=False)
    found = claim("the density's tail").find(Tables(like_the_paper))
    assert found.agrees == "2 of 3"
    assert found.why == "by 5 or more 1 LT ahead at 4 of 4, 2 LT ahead at 1 of 4 Reynolds numbers"


@pytest.mark.parametrize(
    ("uncontrolled", "agrees"), [(0.13, "yes"), (0.11, "nearly"), (0.1, "1 of 2"), (0.06, "no")]
)
def test_how_much_rarer_events_become(like_the_paper, uncontrolled, agrees):
    path = like_the_paper / "control_percentiles.csv"
    table = pd.read_csv(path)
    free = table["metric"] == "exceedance_uncontrolled"
    table.loc[free, ["p25", "p50", "p75"]] = uncontrolled
    table.to_csv(path, index=False)
    found = claim("extreme events become rarer").find(Tables(like_the_paper))
    # what the paper leaves at Re = 600, the least: 0.0127 and 0.0220, the interval 2 % either way
    factors = (
        uncontrolled
        / published_percentiles(pd.read_csv(PUBLISHED), "control")
        .query("reynolds == 600 and metric == 'exceedance_controlled' and neurons == 2000")
        .set_index("prediction_time_lt")["p50"]
    )
    assert f"1 LT ahead by {factors[1]:.1f} (" in found.ours
    assert f"2 LT ahead by {factors[2]:.1f} (" in found.ours
    assert found.agrees == agrees


def test_claims_without_tables_are_on_the_page():
    page = results_page.page()
    assert all(one.text in page and one.missing in page for one in NOT_KEPT)
    assert not {one.text for one in NOT_KEPT} & {one.text for one in CLAIMS}


def test_verdicts():
    assert verdict(1.0, 0.8, 1.0) == "yes"
    assert verdict(1.03, 0.8, 1.0) == "nearly"  # within 0.1 * sqrt(2) of the middle
    assert verdict(1.05, 0.8, 1.0) == "no"
    assert verdict(1.04, 0.8, 1.0, unit=0.1) == "yes"  # what is printed as 1.0 may be 0.95
    assert verdict(1.08, 0.8, 1.0, unit=0.1) == "nearly" == verdict(0.72, 0.8, 1.0, unit=0.1)
    assert (all_of([True, True]), all_of([True, False]), all_of([False])) == ("yes", "1 of 2", "no")
    assert (all_of(["yes", "nearly"]), all_of(["nearly", "no"])) == ("nearly", "1 of 2")


def test_published_values_outside_are_listed(like_the_paper):
    path = like_the_paper / "horizon_percentiles.csv"
    table = pd.read_csv(path)
    chosen = (table["neurons"] == 1500) & (table["validation"] == "RV")
    table.loc[chosen, ["p25", "p50", "p75"]] *= 2
    table.to_csv(path, index=False)
    ends = like_the_paper / "horizon_intervals.csv"
    intervals = pd.read_csv(ends)
    chosen = (intervals["neurons"] == 1500) & (intervals["validation"] == "RV")
    intervals.loc[chosen, ["low", "high"]] *= 2
    intervals.to_csv(ends, index=False)
    compared = results_page.comparison(Tables(like_the_paper))
    _, _, *rows = results_page.outside_table(compared).splitlines()
    assert len(rows) == 1
    assert "| 400 | 1500 RV | mean horizon lt |  | 4.58 | 9.16 (" in rows[0]
    agreement = results_page.agreement_table(compared).splitlines()
    known = int(compared["inside"].notna().sum())
    assert agreement[-1] == f"| all | {known} | {known - 1} |"


def test_sides_of_published_values_are_counted(like_the_paper):
    compared = results_page.comparison(Tables(like_the_paper))
    compared = compared[compared["inside"].notna()].copy()
    theirs, metric = compared["published_p50"], compared["metric"]
    compared["p50"], compared["inside"] = theirs + 1e-6, True
    small = (compared["kind"] == "classification") & (compared["neurons"] == 500)
    compared.loc[small, "p50"] = theirs[small] + 0.1
    compared.loc[small & (metric == "recall"), "inside"] = False
    objectives = metric == "objective"
    compared.loc[objectives, ["p50", "inside"]] = [-9.0, False]
    late = (compared["prediction_time_lt"] == 5) & (compared["kind"] == "classification") & ~small
    compared.loc[late, ["p50", "inside"]] = [0.0, False]
    _, _, *lines = results_page.sides_table(compared).splitlines()
    rows = {
        name: [int(count) for count in counts]
        for name, *counts in (line.strip("| ").split(" | ") for line in lines)
    }
    recalls = int((small & (metric == "recall")).sum())
    assert rows["scores of fewer than 1000 neurons"] == [small.sum(), small.sum(), recalls, 0]
    assert rows["objectives"] == [objectives.sum(), objectives.sum(), objectives.sum(), 0]
    assert rows["scores of 1000 or more, 5 LT ahead"] == [late.sum(), 0, 0, late.sum()]
    between = rows["scores of 1000 or more, in between"]
    assert between[0] == between[1] > 0 == between[2]
    errors = compared["kind"] == "statistics"
    assert rows["long-term statistics"] == [errors.sum(), 0, 0, 0]
    counted = sum(counts[0] for counts in rows.values())
    assert counted == len(compared) - (metric == "spectral_radius").sum()


# -- tables ----------------------------------------------------------------------------------------


@pytest.fixture
def results(tmp_path, monkeypatch):
    """Results of a finished campaign, and an empty directory where tables are kept."""
    monkeypatch.setattr(results_page, "KEPT", tmp_path / "kept")
    results_page.KEPT.mkdir()
    results = tmp_path / "results" / "small"
    preset = yaml.safe_load((ROOT / "workflow/presets/tiny.yaml").read_text(encoding="utf-8"))
    config = load(preset, defaults=ROOT / "config.yaml")
    monkeypatch.setenv(VARIABLE, "")
    Run.new(str(results)).claim(config, [])
    (results / "tables").mkdir()
    for name in table_names(Campaign(config)):
        put_table(results, name, "case,seed,f_score\nRe400,0,0.5\nRe400,1,0.75\n")
    return results


def put_table(results, name, text):
    path = results / "tables" / f"{name}.csv"
    path.write_text(text)
    Records(str(results)).write([str(path)], {"rule": "all_cases"}, {}, {}, "a.log", 1.0)


def test_collected_tables_are_those_of_the_campaign(results, capsys):
    put_table(results, "survival", "")
    for _ in range(2):  # the second time over the first
        assert results_page.main(["collect", f"{results}/"]) == 0
        kept = {path.name for path in (results_page.KEPT / "small").iterdir()}
        assert {"classification.csv", "versions.json"} < kept < results_page.COLLECTED
        assert "survival.csv" not in kept  # empty: of a campaign without long runs
        assert [path.name for path in results_page.KEPT.iterdir()] == ["small"]
    assert results_page.main(["same", "small", str(results)]) == 0
    # one network alone, its last digit another one
    put_table(results, "classification", "case,seed,f_score\nRe400,1,0.7500000001\n")
    assert results_page.main(["same", "small", str(results)]) == 1
    assert "classification: Re400,1,0.7500000001" in capsys.readouterr().out
    # a later version has a further column
    put_table(results, "classification", "case,events,seed,f_score\nRe400,7,1,0.75\n")
    assert results_page.main(["same", "small", str(results)]) == 0
    put_table(results, "classification", "case,f_score\nRe400,0.75\n")
    assert results_page.main(["same", "small", str(results)]) == 1
    assert "classification: without seed" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("path", "message"),
    [
        ("results/small/..", "holds no campaign"),
        (".", "holds no campaign"),
        ("", "holds no campaign"),
        ("/", "holds no campaign"),
        ("results/smal", "holds no campaign"),
        ("results/small/tables", "holds no campaign"),
        ("results/page.md.jinja", "cannot be the name of a campaign"),
        ("results/unfinished", "horizon.csv is missing; run the campaign first"),
        ("results/edited", "is not what its job wrote"),
        ("results//small/", r"small holds what was not collected \(notes.txt\)"),
    ],
)
def test_nothing_is_removed_that_was_not_collected(path, message, results, monkeypatch, capsys):
    """Neither all kept tables nor all of docs, whatever directory is named."""
    monkeypatch.chdir(results.parents[1])
    for name in ("page.md.jinja", "unfinished", "edited"):
        shutil.copytree(results, results.parent / name)
    (results.parent / "unfinished/tables/horizon.csv").unlink()
    (results.parent / "edited/tables/horizon.csv").write_text("case\n")
    (results_page.KEPT / "page.md.jinja").write_text("of the page")
    assert results_page.main(["collect", str(results)]) == 0
    (results_page.KEPT / "small" / "notes.txt").write_text("a note")
    before = {one: one.is_file() and one.read_bytes() for one in results_page.KEPT.rglob("*")}
    assert results_page.main(["collect", path]) == 2
    assert re.search(message, capsys.readouterr().err)
    assert before == {one: one.is_file() and one.read_bytes() for one in before}


@pytest.mark.parametrize(
    ("campaign", "where", "message"),
    [("small", "resutls", "no tables to compare: "), ("smal", "results", "compare with: collect")],
)
def test_nothing_is_not_the_same(campaign, where, message, results, capsys):
    assert results_page.main(["collect", str(results)]) == 0
    other = results.parents[1] / where / "small"
    assert results_page.main(["same", campaign, str(other)]) == 2
    assert message in capsys.readouterr().err


def test_a_sweep_shows_each_median_once(tmp_path):
    cases, forecasters = ("b", "a"), ("quadratic", "equations_noisy")
    rows = [
        {
            "case": case,
            "forecaster": forecaster,
            "neurons": None,
            "validation": None,
            "prediction_time_lt": time,
            "metric": "f_score",
            **dict.fromkeys(("p25", "p50", "p75"), number / 100),
            "networks": 1,
        }
        for number, (case, forecaster, time) in enumerate(
            itertools.product(cases, forecasters, (1.0, 2.0, 3.0, 4.0, 5.0))
        )
    ]
    pd.DataFrame(rows).to_csv(tmp_path / "classification_percentiles.csv", index=False)
    pd.DataFrame({"case": cases}).to_csv(tmp_path / "dataset.csv", index=False)
    _, _, *lines = sweep(Tables(tmp_path)).splitlines()
    assert [line.split(" | ")[0] for line in lines] == ["| b", "| a"]
    assert re.findall(r"\.(\d\d)", " ".join(lines)) == [f"{number:02d}" for number in range(20)]


def test_forecasters_that_control_differently(tmp_path):
    def pair(compared, other, strategy, other_strategy, left):
        who = {
            "case": "Re400",
            "compared": compared,
            "strategy": strategy,
            "other": other,
            "other_strategy": other_strategy,
        }
        spent = (-0.01, -0.02, 0.0)
        return [
            {**who, "metric": metric, **dict(zip(("value", "low", "high"), ends, strict=True))}
            for metric, ends in (("relative_exceedance", left), ("control_fraction", spent))
        ]

    rows = [
        *pair("equations", "median of esn-N10-RV", "late", "late", (-0.04, -0.09, -0.005)),
        *pair("equations", "median of esn-N10-RV", "weak", "weak", (-0.04, -0.09, 0.005)),
        *pair("equations", "equations", "late", "weak", (0.5, 0.4, 0.6)),
        *pair("equations", "median of random-N10-RV", "late", "late", (-0.5, -0.6, -0.4)),
    ]
    pd.DataFrame(rows).to_csv(tmp_path / "control_differences.csv", index=False)
    first, _, _, _, *lines = forecasters_apart(Tables(tmp_path), "Re400").splitlines()
    assert first == "1 of 2 pairs:"
    assert lines == [
        "| `late` | equations | median of esn-N10-RV | -4 (-9 to -0.5) | -1 (-2 to 0) |"
    ]


def test_numbers_that_are_not_there(tmp_path):
    tables = Tables(tmp_path)
    assert not tables
    assert tables.ensemble("horizon", "mean_horizon_lt", case="Re400") is None
    assert quartiles(None) == ""
    with pytest.raises(LookupError, match="0 rows"):
        tables.number("dataset", "series_kept", case="Re400")


def test_sources_of_scatter_stand_beside_each_other(tmp_path):
    keys = {"forecaster": "esn", "neurons": 500, "validation": "RV", "prediction_time_lt": 3.0}
    spread = {"mean": 0.5, "networks": 4, "training_sets": 2}
    spread |= {"standard_deviation_over_training_sets": 0.02}
    spread |= {"standard_deviation_over_seeds": 0.03}
    row = {"case": "Re400", **keys, "metric": "f_score", **spread}
    pd.DataFrame([row]).to_csv(tmp_path / "training_realisations.csv", index=False)
    cases = ("Re400", "Re400-training1", "Re600")
    pd.DataFrame(
        [
            {"case": case, **keys, "seed": 0, "metric": "f_score", "low": 0.4, "high": high}
            for case, high in zip(cases, (0.5, 0.7, 0.99), strict=True)
        ]
    ).to_csv(tmp_path / "classification_intervals.csv", index=False)
    text = scatter(Tables(tmp_path), "Re400")
    # half of the median width, 0.2, over 1.96; another Reynolds number does not count
    assert text.splitlines()[-1].endswith(f"| 0.500 | 0.020 | 0.030 | {0.1 / 1.96:.3f} |")
    widths = {"Re400": (0.9, 0.4, 0.5), "Re400-training1": (0.8, 0.6, 0.6), "Re600": (1, 0, 1)}
    rows = [
        {"case": case, **keys, "seed": seed, "prediction_time_lt": time, "f_score": score + shift}
        for case, scores in widths.items()
        for time, score in zip((1.0, 2.0, 3.0), scores, strict=True)
        for seed, shift in ((0, -0.05), (1, 0.05))
    ]
    table = pd.DataFrame(rows)
    third = table["case"].eq("Re400-training1").to_numpy()
    last = table[third].assign(case="Re400-training2", f_score=lambda rows: rows["f_score"] - 0.2)
    single = {"forecaster": "quadratic_filtered", "neurons": np.nan, "validation": np.nan}
    learnt = [
        {**rows[0], **single, "seed": np.nan, "case": case, "f_score": score}
        for case, score in (("Re400", 0.7), ("Re400-training1", 0.8))
    ]
    whole = pd.concat([table, last, pd.DataFrame(learnt)])
    whole.to_csv(tmp_path / "classification.csv", index=False)
    assert own_training_set(Tables(tmp_path), "Re400").splitlines() == [
        "* 500 neurons, RV: the highest of 3 F-scores 1 LT ahead.",
        "* learnt equations, filtered: the lowest of 2 F-scores 1 LT ahead.",
    ]
