"""Claims of the paper, judged by the paper's own numbers and by numbers that are turned round."""

import re

import numpy as np
import pandas as pd
import pytest
from claims import (
    CLAIMS,
    MARGINS,
    NOT_KEPT,
    NOT_TESTABLE,
    RV,
    claims_table,
    larger,
    reaches,
    sources_table,
    verdict,
    verdicts_by_margin,
    verdicts_of,
)
from kept_tables import PUBLISHED, Tables
from make_page import (
    DOCS,
    IN_DOCS,
    PUBLISHED_VALUES,
    UnsupportedError,
    pages,
    published_values,
    supported,
)

from burstcast.figures.parts.published import published_percentiles

CASES = {400: "Re400", 600: "Re600", 800: "Re800", 1000: "Re1000"}
HALF_WIDTH = 0.02  # of all intervals, relative
QUARTILES = {25: -0.6745, 50: 0.0, 75: 0.6745}  # of a normal distribution


def test_pages_are_those_of_the_kept_tables():
    made = pages()
    for path, text in made.items():
        assert path.read_text(encoding="utf-8") == text, "make results"
    assert PUBLISHED_VALUES.read_text(encoding="utf-8") == published_values(), "make results"
    in_docs = {DOCS / name for name in IN_DOCS}
    assert {*made} == {*in_docs, *(DOCS / "results").glob("*.md")}
    of_the_paper = " ".join(made[DOCS / "results" / "paper.md"].split())
    assert all(text in of_the_paper for text in NOT_KEPT)
    linked = set(re.findall(r"\]\((results/\w+\.md)[)#]", made[DOCS / "results.md"]))
    assert linked == {f"results/{path.name}" for path in (DOCS / "results").glob("*.md")}


def test_a_sentence_whose_comparison_fails_is_refused():
    assert supported(True, True, caller=lambda: "a is larger") == "a is larger"
    with pytest.raises(UnsupportedError, match=r"\(True, False\): a is larger"):
        supported(True, False, caller=lambda: "a is larger")


# -- the paper's numbers as if they were ours ------------------------------------------------------


def published(table):
    """Percentiles that the paper published, with the sizes and cases that are not published.

    What is missing is like the nearest that is there: 2500 and 3000 neurons like 2000 (but what
    the text says of 2500 and 3000), other Reynolds numbers like 600, later ones a little better in
    the horizon as the text says.
    """
    rows = published_percentiles(pd.read_csv(PUBLISHED), table)
    networks = rows[rows["forecaster"] == "esn"]
    keys = ["reynolds", "neurons", "validation", "prediction_time_lt", "metric"]
    like = networks.query("reynolds == 400 and neurons == 2000")
    parts = [rows, *(like.assign(neurons=float(size)) for size in (2500, 3000))]
    parts = [pd.concat(parts).drop_duplicates(keys)]
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
    low, high = (rows["p50"] * (1 + sign * HALF_WIDTH) for sign in (-1, 1))
    ends = rows.assign(seed=0, low=low, high=high)
    ends = ends.drop(columns=["p25", "p50", "p75", "networks"])
    ends.to_csv(directory / f"{name}_intervals.csv", index=False)
    return ends


@pytest.fixture(scope="module")
def like_the_paper(tmp_path_factory):
    tmp_path = tmp_path_factory.mktemp("paper")
    exponents = np.array([0.0163, 0.0135, 0.0126, 0.0121])
    ends = {"": 1.0, "_low": 0.99, "_high": 1.01}
    dataset = {
        **{"case": CASES.values(), "reynolds": CASES.keys(), "mean_observable": 0.06},
        **{"series_generated": 2000, "series_kept": [1436, 1900, 1980, 1998]},
        **{"events_per_series": 2.4, "lyapunov_exponent_given": exponents},
        **{f"lyapunov_exponent{end}": factor * exponents for end, factor in ends.items()},
        **{f"lyapunov_exponent_by_growth{end}": factor * exponents for end, factor in ends.items()},
    }
    pd.DataFrame(dataset).to_csv(tmp_path / "dataset.csv", index=False)
    for name in ("classification", "horizon", "statistics", "hyperparameters"):
        write(tmp_path, name, published(name))
    counts = {"true_positive": 360, "false_positive": 0, "true_negative": 6554}
    equations = {"case": "Re400", "forecaster": "equations", "prediction_time_lt": 5.0}
    scores = pd.DataFrame([{**equations, **counts, "false_negative": 0}])
    scores.to_csv(tmp_path / "classification.csv", index=False)
    # a tail that control makes steeper: times beyond 0.1 and 0.3 are divided by 4 and 11
    low = np.linspace(0.1, 0.48, 39)[:-1]
    without, left = np.exp(1 - low / 0.1), np.exp(1 / 0.6 - low / 0.06) / 3
    density = {"density_uncontrolled": without, "density_controlled": left}
    density = pd.DataFrame({"low": low, "high": low + 0.01, **density, "neurons": 2000, **RV})
    pd.concat(
        density.assign(case=case, prediction_time_lt=time)
        for case in CASES.values()
        for time in (1.0, 2.0)
    ).to_csv(tmp_path / "control_density.csv", index=False)
    control = published("control")
    without = control.assign(metric="exceedance_uncontrolled", p25=0.13, p50=0.13, p75=0.13)
    ends = write(tmp_path, "control", pd.concat([control, without]))
    (tmp_path / "control_intervals.csv").unlink()
    ours = ends[ends["metric"] == "exceedance_controlled"].reset_index(drop=True)
    ours = ours.assign(value=control["p50"].to_numpy(), strategy="prediction_triggered")
    ours.to_csv(tmp_path / "control_strategies.csv", index=False)
    ours.assign(exceedance_controlled=ours["value"]).to_csv(tmp_path / "control.csv", index=False)
    return tmp_path


def findings(tables):
    """Verdicts by claim, as the page shows them."""
    head, _, *lines = (line.strip("| ").split(" | ") for line in claims_table(tables).splitlines())
    agrees = head.index("agrees")
    return {line[0]: line[agrees] for line in lines}


def test_the_paper_agrees_with_its_own_claims(like_the_paper):
    agreement = findings(Tables(like_the_paper))
    assert {text: verdict_ for text, verdict_ in agreement.items() if verdict_ != "yes"} == {
        # the authors' networks of 1000 are worse than their training set, by the formulas
        "the density of k improves on the training set (Kantorovich metric; mean logarithmic "
        "error)": "11 yes, 1 no",
        "profiles improve on the training set (NRMSE of u; u^2; uv)": "15 yes, 1 nearly, 2 no",
        # their networks of 500 have clearly larger logarithmic errors than those from 2000 on
        "the density of k does not improve with size": "27 yes, 3 no",
        # and their profiles improve by more than their densities at two of six sizes
        "the flow field improves less on the training set than the kinetic energy": "4 yes, 2 no",
        # the paper says neither how many events, nor what is constant or similar
        "events predicted more than five Lyapunov times ahead": NOT_TESTABLE,
        "F-score from 1500 neurons on, 3 LT ahead, RV": NOT_TESTABLE,
        "F-score at Re = 600, 800 and 1000, 3 LT ahead": NOT_TESTABLE,
        # the quartiles of their networks leave some differences open
        "RV outperforms SSV in precision, recall and F-score, Re = 400": "169 yes, 11 nearly",
        "RV outperforms SSV at Re = 600, 800, 1000": "30 yes, 3 nearly",
        "F-score 3 LT ahead: 1500 neurons with RV exceed 3000 with SSV": "nearly",
        "mean PH_ee with the Reynolds number": "nearly",
    }


@pytest.fixture(scope="module")
def turned_round(like_the_paper, tmp_path_factory):
    """Numbers that are all the same, or turned round."""
    directory = tmp_path_factory.mktemp("turned")
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
            scores = table["metric"].eq("f_score")
            table[column] *= np.where(scores, np.where(sizes < 1000, 1, sizes / 3000), 1)
            errors = table["metric"].isin(["kantorovich", "mean_log_error", "nrmse_u"])
            table[column] *= np.where(errors, 3000 / sizes, 1)
        if "density_controlled" in table:
            table["density_controlled"] = table["density_uncontrolled"] * 1.1
        if "true_positive" in table:
            table["true_positive"] = 2 * table["true_positive"]
        for column in ("series_kept", "lyapunov_exponent_low", "lyapunov_exponent_high"):
            if column in table:
                table[column] = table[column] * 0.8 if "low" in column else table[column] * 0.9
        table.to_csv(directory / path.name, index=False)
    return Tables(directory)


def test_a_claim_without_a_bar_of_the_paper_has_no_verdict(like_the_paper):
    verdicts = findings(Tables(like_the_paper))
    without = {claim.text for claim in CLAIMS if not claim.source}
    assert without == {text for text, verdict_ in verdicts.items() if verdict_ == NOT_TESTABLE}
    counts = verdicts_of(Tables(like_the_paper))
    assert counts["claims"] + counts["untestable"] == len(CLAIMS)
    assert counts["claims"] == sum(counts[part] for part in ("yes", "nearly", "mixed", "no"))
    cells = [line.strip("| ").split(" | ") for line in sources_table().splitlines()[2:]]
    assert {text for text, source in cells if source == "none"} == without
    # a bar is a sentence in quotation marks, a figure, a section's numbers, or the authors' files
    sources = (claim.source for claim in CLAIMS if claim.source)
    assert all(re.search(r'"[^"]{9,}"|figure \d+|^[IV]+ [A-C]|files', each) for each in sources)


def test_margins_decide_no_more_than_the_page_says(like_the_paper):
    kept, tables = dict(MARGINS), Tables(like_the_paper)
    yes = [verdicts_by_margin(tables, factor)["yes"] for factor in (0.01, 1.0, 2.0)]
    assert yes[0] < yes[1] <= yes[2]
    assert yes[1] == verdicts_of(tables)["yes"]
    assert kept == MARGINS


@pytest.mark.parametrize("claim", CLAIMS, ids=lambda claim: claim.text)
def test_every_claim_can_fail(claim, turned_round):
    assert claim.find(turned_round).agrees != "yes"


def test_verdicts_are_of_equivalence():
    kind = "precision, recall, F-score"
    assert MARGINS[kind] == ("absolute", 0.05)
    assert verdict(kind, 0.8, 0.76, 0.84) == "yes"
    assert verdict(kind, 0.8, 0.74, 0.83) == "nearly"  # the middle alone is within the margin
    assert verdict(kind, 0.8, 0.84, 0.87) == "no" == verdict(kind, 0.8, 0.73, 0.76)
    assert verdict(kind, 0.8, 0.7, 0.9) == "undecided"
    assert verdict(kind, 0.8, 0.74, 0.84, digit=0.02) == "yes"  # what is printed as 0.8 may be 0.79
    assert verdict("exceedance under control", 0.04, 0.031, 0.049) == "yes"  # 25 % either way
    assert verdict("exceedance under control", 0.04, 0.029, 0.049) == "nearly"


def row(**of):
    return pd.Series({"networks": 10, **of})


def test_a_bound_is_reached_by_the_lower_end():
    kind = "precision, recall, F-score"
    assert reaches(kind, 0.9, row(low=0.86, p50=0.9)) == "yes"
    assert reaches(kind, 0.9, row(low=0.7, p50=0.9, high=1.0)) == "nearly"  # noise helps nothing
    assert reaches(kind, 0.9, row(low=0.7, p50=0.84, high=1.0)) == "no"


@pytest.mark.parametrize(("errors", "expected"), [(2.2, "yes"), (1.7, "nearly"), (-3, "no")])
def test_medians_differ_beyond_the_scatter_of_networks(errors, expected):
    # the standard error of the difference of medians of ten normal numbers of deviation 1
    numbers = np.random.default_rng(3).normal(size=(2, 100_000, 10))
    error = np.subtract(*np.median(numbers, axis=2)).std()
    first, other = (
        row(**{f"p{share}": middle + distance for share, distance in QUARTILES.items()})
        for middle in (errors * error, 0.0)
    )
    assert larger(first, other) == expected
