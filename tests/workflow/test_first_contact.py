"""What a new user does first: own data with five lines of config, a campaign without networks."""

import numpy as np
import pytest
import yaml
from helpers_rebuilds import Project

from burstcast.files.netcdf import read_netcdf
from burstcast.files.tables import read_table
from burstcast.systems.integration import integrate
from burstcast.systems.lorenz63 import Lorenz63
from burstcast_workflow.harness.storage import read_json

FIVE_LINES = """\
results: results/own
campaign: [{cases: [own], forecasters: {FORECASTERS}}]
cases:
  own: {event_threshold: {quantile: 0.95},
        data: {files: [own.csv], observable: z, time_step: 0.02, blocks: {duration: 16}}}
"""


@pytest.fixture
def project(tmp_path, job_server):
    """A working copy with a table of three columns, times and a header, and nothing else."""
    project = Project.create(tmp_path / "project", job_server, "own.yaml")
    states = integrate(Lorenz63(), np.array([[1.0], [1.0], [20.0]]), 0.01, 2 * 14000, stride=2)
    series = np.column_stack([0.02 * np.arange(len(states) - 1000), states[1000:, :, 0]])
    header = {"delimiter": ",", "header": "time,x,y,z", "comments": ""}
    np.savetxt(project.directory / "own.csv", series, **header)
    return project


def configure(project, forecasters):
    text = FIVE_LINES.replace("FORECASTERS", forecasters)
    assert len(text.splitlines()) == 5
    (project.directory / "own.yaml").write_text(text)


def test_own_data_with_five_lines_of_config(project):
    configure(project, "esn: {neurons: [30], validation: [RV], seeds: 1}")
    own = "results/own/own"
    network = f"{own}/esn-N30-RV-seed0"
    outcome = project.snakemake(
        f"{network}/forecast.nc",
        f"{network}/search.csv",
        "results/own/tables/survival.csv",
        "results/own/tables/statistics.csv",
        "results/own/figures/validation_strategies.png",
        "results/own/figures/observable_and_density.png",
    )
    assert outcome.status == 0, outcome.text[-3000:]
    ensemble = read_netcdf(project.directory / own / "ensemble.nc")
    assert ensemble["state"].shape == (16, 801, 3)
    points = read_netcdf(project.directory / own / "evaluation_set.nc")
    assert set(points["series"]) == set(range(6))  # all after those of the training
    statistics = read_netcdf(project.directory / own / "statistics_data.nc")
    assert statistics["edge"][0] == ensemble["observable"].min()
    assert statistics["edge"][-1] == ensemble["observable"].max()
    survival = read_table(project.directory / "results/own/tables/survival.csv")
    assert set(survival["forecaster"]) >= {"esn", "data"}


@pytest.mark.long
def test_a_campaign_without_networks_is_a_campaign(project):
    configure(project, "analogues: {}, quadratic: {}, persistence: {}")
    outcome = project.snakemake()
    assert outcome.status == 0, outcome.text[-3000:]
    assert "no networks in the campaign; off: " in outcome.text
    tables = project.directory / "results/own/tables"
    assert set(read_table(tables / "horizon.csv")["forecaster"]) == {
        "analogues",
        "persistence",
        "quadratic",
    }
    assert not (tables / "hyperparameters.csv").exists()
    figures = {path.stem for path in (project.directory / "results/own/figures").glob("*.png")}
    assert "forecast_skill" in figures
    assert "classification_scores" not in outcome.text.partition("look first at")[2]


@pytest.mark.long
def test_a_campaign_that_is_too_small_for_its_stages_ends(tmp_path, job_server):
    """Series in whose washouts events are always under way: nothing to calibrate with."""
    project = Project.create(tmp_path / "project", job_server, "small.yaml")
    config = yaml.safe_load((project.directory / "workflow/presets/tiny.yaml").read_text())
    networks = {"neurons": [40], "validation": ["RV"], "seeds": 2}
    forecasters = {"esn": networks, "equations": {}, "quadratic_filtered": {}}
    config["results"] = "results/small"
    config["campaign"] = [{"reynolds": [1000, 400, 800], "forecasters": forecasters}]
    config["case_defaults"]["test_series"] = 12
    config["case_defaults"]["recycle_validation"] = {"series": 2, "intervals_per_series": None}
    (project.directory / "small.yaml").write_text(yaml.safe_dump(config))
    outcome = project.snakemake()
    assert outcome.status == 0, outcome.text[-3000:]
    results = project.directory / "results/small"
    calibration = read_json(results / "Re1000/calibration.json")
    (rule,) = calibration["alarms"]["climatology"]["1"].values()
    assert rule["values"] == []
    scores = read_table(results / "tables/probability_scores.csv")
    scores = scores[scores["probability"] == "calibrated"]
    undefined = scores[(scores["case"] == "Re1000") & (scores["metric"] == "brier_score")]
    assert len(undefined) > 3
    assert undefined["value"].isna().all()
    warnings = read_table(results / "tables/warnings.csv")
    told = {"few_events", "few_positives", "nothing_to_calibrate_with"}
    assert told <= set(warnings[warnings["case"] == "Re1000"]["warning"])
    assert "nothing_to_calibrate_with" not in set(warnings[warnings["case"] == "Re400"]["warning"])
    assert "no calibration of probabilities" in outcome.text
    assert (results / "figures/forecast_skill_Re1000.png").stat().st_size > 5000


@pytest.mark.long
def test_a_campaign_without_any_event_ends(tmp_path, job_server):
    """Scores, horizons, probabilities and control have nothing to count."""
    project = Project.create(tmp_path / "project", job_server, "quiet.yaml")
    config = yaml.safe_load((project.directory / "workflow/presets/tiny.yaml").read_text())
    config["results"] = "results/quiet"
    config["case_defaults"]["event_threshold"] = 0.47
    config["figures"] = {"flow_event": {"peak": 0.475}}
    (project.directory / "quiet.yaml").write_text(yaml.safe_dump(config))
    outcome = project.snakemake()
    assert outcome.status == 0, outcome.text[-3000:]
    results = project.directory / "results/quiet"
    assert read_table(results / "tables/classification.csv")["recall"].isna().all()
    assert set(read_table(results / "tables/dataset.csv")["events_per_series"]) == {0}
    strategies = read_table(results / "tables/control_strategies.csv")
    left = strategies[strategies["metric"] == "relative_exceedance"]
    assert left["value"].isna().all()
    assert "few_events" in set(read_table(results / "tables/warnings.csv")["warning"])
    drawn = {path.stem for path in (results / "figures").glob("*.png")}
    assert {"forecast_skill", "control_tradeoff", "reliability", "horizon_by_size"} <= drawn
