"""A finished campaign: opened in a notebook, and what it says at the end of a run."""

import re
import shutil
from pathlib import Path

import matplotlib
import pandas as pd
import pytest
from numpy.testing import assert_array_equal

import burstcast_workflow
from burstcast.base.files.netcdf import read_netcdf
from burstcast.forecasts.windows import window_boundaries, window_forecasts
from burstcast.systems.mfe import MoehlisFaisstEckhardt
from burstcast_workflow.commands import choose
from burstcast_workflow.summary import (
    MOST_ROWS,
    MOST_WARNINGS,
    campaign_summary,
    warnings_summary,
    where_results_lie,
)
from helpers_library import code_cells

DOCS = Path(__file__).parents[2] / "docs"


@pytest.fixture(scope="module")
def opened(finished):
    return burstcast_workflow.open_campaign(finished.results)


def test_it_says_what_there_is(opened):
    text = repr(opened)
    for part in ("of Re400", "4 networks: Re400/esn-N30-RV-seed0", "7 forecasters"):
        assert part in text
    assert len(text.splitlines()) < 8
    assert "classification" in repr(opened.tables)
    assert opened.config["random_seed"] == 2022
    network = repr(opened.networks["Re400/esn-N40-RV-seed0"])
    assert network.startswith(
        "NetworkForecaster(seed 0: EchoStateNetwork(40 neurons, 9 components,"
    )
    assert len(network) < 160


@pytest.mark.parametrize("identifier", ["esn-N40-RV-seed0", "quadratic_filtered", "equations"])
def test_its_forecasters_forecast_what_the_workflow_has(opened, identifier):
    directory = opened.results / "Re400"
    points = read_netcdf(directory / "evaluation_set.nc", "washout", "true_washout")
    forecaster = opened.forecasters[f"Re400/{identifier}"]
    forecasts = window_forecasts(
        forecaster,
        MoehlisFaisstEckhardt(reynolds=400.0).observable,
        points["true_washout" if forecaster.sees_truth else "washout"],
        window_boundaries(0.5, 7, 61),
    )
    (path,) = directory.glob(f"*/{identifier}/forecast.nc")
    stored = read_netcdf(path)
    # members are in the file where there is an ensemble
    assert ("member_first" in stored) == (identifier == "quadratic_filtered")
    for name, values in stored.items():
        assert_array_equal(getattr(forecasts, name), values)


def test_its_series_are_those_of_the_workflow(opened):
    directory = opened.results / "Re400"
    points = read_netcdf(directory / "evaluation_set.nc", "series", "step", "washout")
    tested = opened.series("Re400", 3)
    point = len(points["step"]) // 2
    series, step = points["series"][point], points["step"][point]
    washout = points["washout"][point]
    assert_array_equal(tested[series, step - len(washout) + 1 : step + 1], washout)
    stored = read_netcdf(directory / "ensemble.nc", "state")["state"]
    assert_array_equal(opened.series("Re400", 1, 4, observed=False), stored[1:4])
    with pytest.raises(ValueError, match=r"no case 'Re40' \(did you mean 'Re400'\?\); the cases"):
        opened.series("Re40")


def test_its_tables_and_figures(opened, tmp_path):
    path = opened.results / "tables" / "classification.csv"
    stored, shown = pd.read_csv(path), opened.tables["classification"]
    pd.testing.assert_frame_equal(shown, stored, check_dtype=False)
    assert set(opened.tables) == {table.stem for table in path.parent.glob("*.csv")}
    with pytest.raises(KeyError, match="did you mean 'horizon'"):
        opened.tables["horizn"]
    assert "permanent alarm" in campaign_summary(path.parent)
    # figures, where there are any; a campaign that was moved; one without its forecasters
    shutil.copy(opened.results / ".run.json", tmp_path)
    (tmp_path / "figures").mkdir()
    (tmp_path / "figures" / "own_flow.png").touch()
    moved = burstcast_workflow.open_campaign(tmp_path)
    assert moved.figures["own_flow"] == tmp_path / "figures" / "own_flow.png"
    assert dict(moved.networks) == {}
    assert "0 networks (of 4)" in repr(moved)
    with pytest.raises(ValueError, match="not made yet"):
        moved.series("Re400")


def test_a_directory_without_results_is_refused(tmp_path):
    with pytest.raises(ValueError, match="holds no campaign"):
        burstcast_workflow.open_campaign(tmp_path)
    (tmp_path / ".run.json").write_text("[]")
    with pytest.raises(ValueError, match="the directory that the config calls `results`"):
        burstcast_workflow.open_campaign(tmp_path)


def test_the_notebook_reads_a_campaign(finished, tmp_path, monkeypatch, capsys):
    """docs/campaign.ipynb, with the tiny campaign in place of the demo."""
    matplotlib.use("agg")
    (tmp_path / "results").mkdir()
    (tmp_path / "results" / "quick").symlink_to(finished.results)
    monkeypatch.chdir(tmp_path)
    names: dict[str, object] = {}
    for cell in code_cells(DOCS / "campaign.ipynb"):
        exec("".join(cell["source"]), names)
    output = capsys.readouterr().out.partition("p25")[0]
    table = pd.read_csv(finished.results / "tables" / "classification.csv")
    rows = table[table["prediction_time_lt"] == table["prediction_time_lt"].min()]
    networks = rows[rows["validation"] == "RV"]
    assert len(re.findall(r"^ +esn .*RV", output, re.MULTILINE)) == len(networks)
    assert_array_equal(
        names["forecast"][:, :, 0],
        names["network"].advance(names["memory"][:, :1], names["steps"])[0][:, :, 0],
    )


# -- at the end of a run ---------------------------------------------------------------------------


NAMES = ["case", "forecaster", "neurons", "validation"]
ESN = ("Re400", "esn", 500, "RV")
EQUATIONS = ("Re400", "equations", None, None)


def percentiles(metric, medians, **more):
    """Rows of a percentile table: by case, kind, neurons, validation."""
    keys = pd.DataFrame(list(medians), columns=NAMES)
    return keys.assign(**more, metric=metric, p50=list(medians.values()))


def write(directory, name, *tables):
    """A table of a campaign; or one of no byte."""
    path = directory / f"{name}.csv"
    pd.concat(tables).to_csv(path, index=False) if tables else path.touch()


def test_campaign_summary_has_a_row_for_each_forecaster_best_first(tmp_path):
    assert campaign_summary(tmp_path) == ""
    scores = {0.5: (0.5, 0.8, 0.1), 2.5: (0.7, 1.0, 0.2)}  # the nearest to 2 LT is shown
    members = (ESN, EQUATIONS, ("Re1000", *ESN[1:]))
    of_times = [
        percentiles("f_score", dict(zip(members, values, strict=True)), prediction_time_lt=time)
        for time, values in scores.items()
    ]
    write(tmp_path, "classification_percentiles", *of_times)
    write(tmp_path, "horizon_percentiles", percentiles("mean_horizon_lt", {ESN: 3.25}))
    # exceedances of one prediction time, not the least of each, which pairs two experiments
    exceedances = [
        percentiles(f"exceedance_{flows}", {ESN: value}, prediction_time_lt=time)
        for flows, values in {"uncontrolled": (0.12, 0.11), "controlled": (0.02, 0.05)}.items()
        for time, value in zip((1, 2), values, strict=True)
    ]
    write(tmp_path, "control_percentiles", *exceedances)
    heads, *rows = campaign_summary(tmp_path).splitlines()
    assert "F-score 2.5 LT ahead" in heads
    assert heads.endswith("exceedance  under control  PT [LT]")
    # cases in the order of their numbers
    of_rows = [row.split()[:2] for row in rows]
    assert of_rows == [["Re400", "equations"], ["Re400", "esn,"], ["Re1000", "esn,"]]
    assert rows[0].split()[-1] == "1"
    assert rows[1].split()[-5:] == ["0.7", "3.25", "0.12", "0.02", "1"]


def test_a_large_campaign_is_cut_and_tables_of_no_byte_are_no_summary(tmp_path):
    sizes = {("Re400", "esn", size, "RV"): 0.5 for size in range(100, 120)}
    write(
        tmp_path, "classification_percentiles", percentiles("f_score", sizes, prediction_time_lt=2)
    )
    lines = campaign_summary(tmp_path).splitlines()
    assert len(lines) == MOST_ROWS + 2
    assert "and 4 more" in lines[-1]
    for name in ("classification_percentiles", "horizon_percentiles", "warnings"):
        (tmp_path / f"{name}.csv").unlink(missing_ok=True)
        write(tmp_path, name)
    assert campaign_summary(tmp_path) == warnings_summary(tmp_path) == ""


def warned(directory, *rows):
    """Lines that sum up warnings: case, forecaster, neurons, validation, and what is said."""
    names = [*NAMES, "warning", "finding", "advice"]
    write(directory, "warnings", pd.DataFrame(rows, columns=names).assign(reynolds=400))
    return warnings_summary(directory).splitlines()[1:]


FEW = [
    (f"c{n}", None, None, None, "few_events", f"{n} events", "x") for n in range(MOST_WARNINGS + 3)
]


def test_warnings_that_say_the_same_share_a_line(tmp_path):
    edge = ("optimum_on_edge", "beta at its lower bound", "widen the search")
    rows = [("Re400", "esn", 500, name, *edge) for name in ("RV", "SSV")]
    few = ("Re400", None, None, None, "few_events", "3 events", "lower the threshold")
    assert warned(tmp_path, *rows, few) == [
        "  Re400, esn, 500 neurons, RV; esn, 500 neurons, SSV: beta at its lower bound. "
        "Try: widen the search.",
        "  Re400: 3 events. Try: lower the threshold.",
    ]


def test_many_warnings_are_cut_and_the_first_of_each_kind_is_shown(tmp_path):
    assert warned(tmp_path) == []
    lines = warned(tmp_path, *FEW)
    assert len(lines) == MOST_WARNINGS + 1
    assert lines[-1].strip() == "... and 3 more"
    rare = ("c99", None, None, None, "nothing_to_calibrate_with", "no point counts", "y")
    assert warned(tmp_path, *FEW, rare)[:3] == [
        "  c0: 0 events. Try: x.",
        "  c99: no point counts. Try: y.",
        "  c1: 1 events. Try: x.",
    ]
    kinds = MOST_WARNINGS + 2
    every = [("c0", None, None, None, f"kind_{n}", f"sign {n}", "z") for n in range(kinds)]
    lines = warned(tmp_path, *FEW, *every)
    assert sum("sign" in line for line in lines) == kinds
    assert lines[-1].strip() == f"... and {len(FEW) - 1} more"


def test_the_end_names_only_what_there_is(tmp_path):
    assert where_results_lie(tmp_path) == f"Results: {tmp_path}"
    (tmp_path / "tables").mkdir()
    (tmp_path / "tables" / "dataset.csv").write_text("")
    assert where_results_lie(tmp_path) == f"Tables: {tmp_path}/tables/*.csv and *.tex."
    (tmp_path / "figures").mkdir()
    (tmp_path / "figures" / "own_flow.png").write_text("")
    assert "look first" not in where_results_lie(tmp_path)
    (tmp_path / "figures" / "forecast_skill.png").write_text("")
    assert where_results_lie(tmp_path).endswith("; look first at forecast_skill.")


def test_kinds_are_tried_on_the_series_of_a_case(opened, capsys):
    assert choose.main(opened.results, "Re400", "linear_inverse,quadratic") == 0
    head, *rows = capsys.readouterr().out.splitlines()
    assert head.split() == ["kind", "Brier", "skill", "95", "%", "interval", "seconds"]
    assert [row.split()[0] for row in rows] == ["linear_inverse", "quadratic"]
    (chosen,) = [row for row in rows if row.endswith("chosen")]
    skills = {row.split()[0]: float(row.split()[1]) for row in rows}
    assert skills[chosen.split()[0]] == max(skills.values())
    assert choose.main(opened.results, "Re400", "no_kind") == 1
    assert "no_kind" in capsys.readouterr().err
