"""The paper's campaign in miniature, from end to end, and its tables computed anew by name."""

import base64
import io
import json
import re
from html import escape

import pytest
import yaml
from helpers_configs import ROOT, miniature_with_other_names, paper_with, read
from helpers_rebuilds import Project
from keep import rule_costs
from PIL import Image
from recomputation import TABLES, Recomputation, assert_same_rows, percentiles

from burstcast.base.files.tables import read_table
from burstcast.figures.registry import caption
from burstcast_workflow.jobs.report import MOST_ROWS
from burstcast_workflow.tables.declarations import SECTIONS
from burstcast_workflow.tables.declarations import TABLES as DECLARED
from burstcast_workflow.tables.registry import table_of, with_percentiles

PRESET = "workflow/presets/miniature.yaml"
METRICS = {
    "hyperparameters": (["spectral_radius", "input_scaling", "tikhonov", "objective"], []),
    "classification": (["precision", "recall", "f_score"], ["prediction_time_lt"]),
    "horizon": (["mean_horizon_lt", "median_horizon_lt"], []),
    "statistics": (["discarded_fraction", "kantorovich", "mean_log_error", "nrmse_uv"], []),
    "survival": (["survived_fraction", "escape_rate"], []),
    "lyapunov_spectrum": (["lyapunov_exponent"], ["number"]),
    "kaplan_yorke": (["kaplan_yorke_dimension"], []),
    "control": (["exceedance_controlled", "reduction", "alarms"], ["prediction_time_lt"]),
}


@pytest.fixture(scope="module")
def results(miniature):
    return miniature.directory / "results/miniature"


@pytest.fixture(scope="module")
def anew(results):
    return Recomputation(results, paper_with(miniature_with_other_names()))


def assert_table(results, name, expected):
    assert_same_rows(read_table(results / "tables" / f"{name}.csv"), expected)


def test_it_has_the_shape_of_the_paper():
    paper, small = (yaml.safe_load((ROOT / name).read_text()) for name in ("config.yaml", PRESET))
    for block, miniature_block in zip(paper["campaign"], small["campaign"], strict=True):
        assert block["reynolds"] == miniature_block["reynolds"]
        networks, small_networks = (part["forecasters"]["esn"] for part in (block, miniature_block))
        assert networks["validation"] == small_networks["validation"]
        assert small_networks["seeds"] >= 2
        assert block["forecasters"].keys() == miniature_block["forecasters"].keys()
    assert len(small["campaign"][0]["forecasters"]["esn"]["neurons"]) == 3


def test_it_makes_all_that_the_paper_has(miniature, results):
    figures = {path.stem for path in (results / "figures").glob("*.png")}
    for name in ("observable_and_density", "classification_scores", "long_term_density"):
        assert {name, f"{name}_alpha", f"{name}_Re400"} <= figures
    assert {"by_reynolds", "horizon_by_size", "control_density", "suppressed_event"} <= figures
    assert {path.name for path in (results / "figures").glob("[!.]*")} == {
        f"{stem}.{suffix}" for stem in figures for suffix in ("pdf", "png")
    }
    assert "Nothing to be done" in miniature.snakemake().text


def test_logs_tell_what_its_jobs_took(results):
    rows = rule_costs(results / "logs")
    assert {"simulate", "scan", "joined_horizon", "figure"} <= set(rows["rule"])
    assert rows["jobs"].sum() > 100
    assert (rows["minutes"] > 0).all()
    assert (rows["processor_minutes"] > 0).all()
    assert len((results / "logs/figure/by_reynolds.log").read_text().splitlines()) < 6


def test_costs_are_those_of_the_jobs_that_computed(tmp_path):
    """Also where results came from the cache, or from logs without the processor's time."""
    took, of_job = "x computed in 60.00 s, 30.00 s of processor\n", "x is done: {} MiB\n"
    logs = {
        "scan/a.log": f"{took}{of_job.format('61.00 s, 31.00 s of processor, peak memory 300')}",
        "scan/b.log": f"{took}taken from the cache: the outputs are those of this job, which took "
        f"60.00 s\n{of_job.format('0.10 s, 0.20 s of processor, peak memory 100')}",
        "old.log": of_job.format("3.00 s, peak memory 100"),
    }
    for name, text in logs.items():
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text(text)
    rows = rule_costs(tmp_path).set_index("rule")
    assert rows.loc["scan"].tolist() == [2, 121 / 60, 1.0, 300]
    assert rows.loc["old", ["jobs", "minutes", "memory_mib"]].tolist() == [1, 0.05, 100]
    assert rows["processor_minutes"].isna().tolist() == [True, False]


def test_it_meets_what_a_small_campaign_meets(results):
    """Otherwise the tests below would not see how it is dealt with."""
    tables = results / "tables"
    assert (read_table(tables / "horizon.csv")["events"] == 0).any()
    scores = read_table(tables / "classification.csv")
    assert scores["precision"].isna().any()
    assert scores["recall"].isna().any()
    assert read_table(tables / "control.csv")["reduction"].isna().any()


@pytest.mark.parametrize("name", TABLES)
def test_a_table_is_what_the_files_of_the_networks_say(anew, name):
    expected = getattr(anew, name)()
    assert len(expected) > 2
    assert_table(anew.results, name, expected)


def test_survival_curves_end_where_series_and_runs_do(results):
    curves, shares = (
        read_table(results / f"tables/{name}.csv") for name in ("survival_curve", "survival")
    )
    keys = ["case", "forecaster", "neurons", "validation", "seed"]
    last = curves.groupby(keys, dropna=False).tail(1).merge(shares, on=keys)
    assert len(last) == len(shares)
    assert last["time"].tolist() == [400 if name == "data" else 200 for name in last["forecaster"]]
    assert (last["survival"] == last["survived_fraction"]).all()


@pytest.mark.parametrize("name", METRICS)
def test_percentiles_are_quartiles_over_the_seeds(anew, name):
    table = read_table(anew.results / "tables" / f"{name}.csv")
    metrics, extra = METRICS[name]
    written = read_table(anew.results / "tables" / f"{name}_percentiles.csv")
    assert_same_rows(written[written["metric"].isin(metrics)], percentiles(table, metrics, extra))


def test_parameters_belong_to_their_cases(anew):
    rows = read_table(anew.results / "tables/data_generation_parameters.csv")
    rows, kept = rows.set_index("Explanation"), anew.dataset().set_index("case")["series_kept"]
    for case, record in anew.records.items():
        (column,) = (name for name in rows.columns if case in str(name))
        assert f"{record['parameters']['reynolds']}" in rows.loc["Reynolds number", column]
        assert f"{kept[case]}" in rows.loc["Number of time series", column]


def test_the_order_of_the_config_means_nothing(miniature, tmp_path):
    project = miniature.copy(tmp_path / "project")
    config = turned(miniature_with_other_names())
    (project.directory / "small.yaml").write_text(yaml.safe_dump(config, sort_keys=False))
    assert list(config["cases"]) == ["Zeta", "alpha", *list(config["cases"])[2:]]
    permuted = {
        "classification": {"prediction_times_lt": [3, 1, 2]},
        "control": {"prediction_times_lt": [2, 1]},
        "search": {"tikhonov": [1e-9, 1e-12, 1e-6]},
    }
    assert project.dry_run(overlay=permuted) == {}


ORDERED = ("range", "initial_state", "flow_points", "length_scale", "variance")
"""Ends of the names of lists in which the order means something."""


def turned(value, name=""):
    """Settings in another order."""
    if isinstance(value, dict):
        return {key: turned(value[key], key) for key in reversed(value)}
    if isinstance(value, list) and not name.endswith(ORDERED):
        return [turned(item) for item in reversed(value)]
    return value


@pytest.mark.long
def test_the_whole_miniature(job_server, tmp_path):
    project = Project.create(tmp_path / "project", job_server, PRESET)
    project.made()
    again = Recomputation(project.directory / "results/miniature", paper_with(read(ROOT / PRESET)))
    for name in TABLES:
        assert_table(again.results, name, getattr(again, name)())
    figures = {path.stem for path in (again.results / "figures").glob("*.png")}
    for name in ("observable_and_density", "classification_scores", "long_term_density"):
        assert {f"{name}{case}" for case in ("", "_Re600", "_Re800", "_Re1000")} <= figures
    assert "Nothing to be done" in project.snakemake().text


# -- the report ------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def page(results):
    return (results / "report.html").read_text()


def test_the_report_has_all_figures_with_their_captions(page, results):
    shown = re.findall(r'<img src="data:image/png;base64,([^"]+)" width="(\d+)"', page)
    pictures = [base64.b64decode(text) for text, _ in shown]
    made = {path.stem: path.read_bytes() for path in (results / "figures").glob("*.png")}
    assert len(made) > 30
    # the others have no content here
    assert sorted(pictures) == sorted(filter(None, made.values()))
    assert len(pictures) > 15
    for picture, (_, width) in zip(pictures, shown, strict=True):
        assert int(width) == Image.open(io.BytesIO(picture)).width // 2  # of twice the dots
    for name in made:
        assert f'<figure id="{name}">' in page
        assert f'href="figures/{name}.pdf"' in page
    assert page.count("<figcaption>") == len(made)
    assert escape(caption("classification_scores")) in page


def test_the_report_has_all_tables_with_their_first_rows(page, results):
    names = re.findall(r'<details id="table-(\w+)">', page)
    assert names == [
        name
        for section in SECTIONS
        for name in with_percentiles(DECLARED)
        if table_of(name).section == section and (results / "tables" / f"{name}.csv").exists()
    ]
    for name in names:
        part = page.partition(f'<details id="table-{name}">')[2].partition("</details>")[0]
        expected = len(read_table(results / "tables" / f"{name}.csv"))
        assert part.count("<tr>") == (min(expected, MOST_ROWS) + 1 if expected else 0), name
        assert (f"{expected - MOST_ROWS} more rows" in part) == (expected > MOST_ROWS)


def test_the_report_says_what_was_computed_and_what_differs_from_the_paper(page, results):
    assert "<title>burstcast: miniature</title>" in page
    config = json.loads((results / ".run.json").read_bytes())["config"]
    for word in ("alpha", "F-score", "What to look at twice", "Racca &amp; Magri"):
        assert word in page
    assert f"<td>{config['search']['grid']}</td>" in page.partition("search.grid")[2][:200]
    assert "<code>results</code>" not in page
    text = re.sub(r"base64,[^\"]*", "", page).replace("https://arxiv.org", "")
    assert "http" not in text  # it needs nothing but itself
