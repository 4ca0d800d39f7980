"""`burstcast_workflow.open_campaign`: results to look at in a notebook."""

import json
import re
import shutil
from pathlib import Path

import matplotlib
import pandas as pd
import pytest
from numpy.testing import assert_array_equal

import burstcast_workflow
from burstcast.files.netcdf import read_netcdf
from burstcast.forecast.window_forecasts import window_forecasts
from burstcast.forecast.windows import window_boundaries
from burstcast.systems.mfe import MoehlisFaisstEckhardt

DOCS = Path(__file__).parents[2] / "docs"


@pytest.fixture(scope="module")
def opened(finished):
    return burstcast_workflow.open_campaign(finished.project.results)


def test_it_says_what_there_is(opened):
    text = repr(opened)
    assert "of Re400" in text
    assert "4 networks: Re400/esn-N30-RV-seed0" in text
    assert "7 forecasters" in text
    assert len(text.splitlines()) < 8
    assert "classification" in repr(opened.tables)
    assert opened.config["random_seed"] == 2022
    network = opened.networks["Re400/esn-N40-RV-seed0"]
    assert repr(network).startswith(
        "NetworkForecaster(seed 0: EchoStateNetwork(40 neurons, 9 components, spectral radius 0."
    )
    assert len(repr(network)) < 160


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
    stored = read_netcdf(directory / identifier / "forecast.nc")
    # members are in the file where there is an ensemble
    assert ("member_first" in stored) == (identifier == "quadratic_filtered")
    for name, values in stored.items():
        assert_array_equal(getattr(forecasts, name), values)


def test_its_series_are_those_of_the_workflow(opened):
    points = read_netcdf(
        opened.results / "Re400" / "evaluation_set.nc", "series", "step", "washout"
    )
    tested = opened.series("Re400", 3)
    point = len(points["step"]) // 2
    series, step = points["series"][point], points["step"][point]
    washout = points["washout"][point]
    assert_array_equal(tested[series, step - len(washout) + 1 : step + 1], washout)
    stored = read_netcdf(opened.results / "Re400" / "ensemble.nc", "state")["state"]
    assert_array_equal(opened.series("Re400", 1, 4, observed=False), stored[1:4])
    with pytest.raises(ValueError, match=r"no case 'Re40' \(did you mean 'Re400'\?\); the cases"):
        opened.series("Re40")


def test_its_tables_and_figures(opened, tmp_path):
    path = opened.results / "tables" / "classification.csv"
    pd.testing.assert_frame_equal(
        opened.tables["classification"], pd.read_csv(path), check_dtype=False
    )
    assert set(opened.tables) == {one.stem for one in path.parent.glob("*.csv")}
    with pytest.raises(KeyError, match="did you mean 'horizon'"):
        opened.tables["horizn"]
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
    (tmp_path / "results" / "quick").symlink_to(finished.project.results)
    monkeypatch.chdir(tmp_path)
    notebook = json.loads((DOCS / "campaign.ipynb").read_text(encoding="utf-8"))
    names: dict[str, object] = {}
    for cell in notebook["cells"]:
        if cell["cell_type"] == "code":
            exec("".join(cell["source"]), names)
    said = capsys.readouterr().out
    table = pd.read_csv(finished.project.results / "tables" / "classification.csv")
    rows = table[table["prediction_time_lt"] == table["prediction_time_lt"].min()]
    assert len(re.findall(r"^ +esn .*RV", said.partition("p25")[0], re.MULTILINE)) == len(
        rows[rows["validation"] == "RV"]
    )
    assert_array_equal(
        names["forecast"][:, :, 0],
        names["network"].advance(names["memory"][:, :1], names["steps"])[0][:, :, 0],
    )
