"""The benchmark's data and scores are those of a campaign with the same settings, bit for bit."""

import dataclasses
import re
import runpy
import subprocess
import sys
from pathlib import Path

import netCDF4
import numpy as np
import pandas as pd
import pytest
import yaml
from helpers_rebuilds import Project
from numpy.testing import assert_array_equal

from burstcast.benchmark.cases import CASES, SEED
from burstcast.benchmark.data import make_case
from burstcast.benchmark.export import export
from burstcast.event_forecaster.forecaster import EventForecaster
from burstcast.files.netcdf import read_attributes, read_netcdf
from burstcast.forecasters._options import options_of_kind
from burstcast.forecasters.base import ForecasterRecord, ForecastingCase
from burstcast.forecasters.registry import forecaster_class
from burstcast_workflow.campaign.campaign import Campaign
from burstcast_workflow.commands.command_line import main
from burstcast_workflow.config.loading import load
from burstcast_workflow.harness.storage import read_json

ROOT = Path(__file__).parents[2]
PRESET = "workflow/presets/benchmark.yaml"
CASE_NAMES = ["Re400", "Re400_seven_modes"]
TABLES = ("classification", "classification_intervals", "horizon", "horizon_intervals")
OVERLAY = {
    "campaign": [
        {
            "reynolds": [400],
            "cases": ["Re400_seven_modes"],
            "forecasters": {"persistence": {}, "quadratic": {}},
        }
    ],
    "statistics": {"forecasters": {"esn": None}},
}


@pytest.fixture(scope="module")
def results(tmp_path_factory, job_server):
    """Results of the preset, by two forecasters that take no time."""
    directory = tmp_path_factory.mktemp("benchmark") / "project"
    project = Project.create(directory, job_server, PRESET)
    found = directory / "results" / "benchmark"
    names = (*TABLES, "probability_scores")
    targets = [f"results/benchmark/{case}/tables/{t}.csv" for case in CASE_NAMES for t in names]
    outcome = project.snakemake(*targets, overlay=OVERLAY)
    assert outcome.status == 0, outcome.text[-3000:]
    return found


@pytest.fixture(scope="module")
def exported(tmp_path_factory):
    directory = tmp_path_factory.mktemp("exported")
    data = {name: make_case(CASES[name]) for name in CASE_NAMES}
    export(directory, [one.exported for one in data.values()])
    return directory, data


def test_the_preset_has_the_cases_of_the_benchmark():
    config = load(yaml.safe_load((ROOT / PRESET).read_text()), defaults=ROOT / "config.yaml")
    campaign = Campaign(config)
    assert config["random_seed"] == SEED
    shear_flows = {name: case for name, case in CASES.items() if name.startswith("Re")}
    assert set(campaign.cases) == set(shear_flows)
    for name, case in shear_flows.items():
        has = campaign.cases[name]
        assert has.event_threshold == case.event_threshold
        assert has.training.series == case.training_series
        assert has.test_series == case.test_series
        assert has.training.noise == case.noise
        assert campaign.cases[name].steps_per_lyapunov_time == case.steps_per_lyapunov_time
        assert campaign.cases[case.ensemble_name].ensemble.series == case.series
    horizon, classification = config["horizon"], config["classification"]
    case = CASES["Re400"]
    assert horizon["events"] == case.horizon_events
    assert horizon["tolerance"] == case.tolerance
    assert tuple(classification["prediction_times_lt"]) == case.prediction_times_lt


@pytest.mark.parametrize("name", CASE_NAMES)
def test_the_data_are_those_of_the_campaign(results, exported, name):
    _, found = exported
    data = found[name]
    points = read_netcdf(results / name / "evaluation_set.nc")
    assert_array_equal(points["washout"], data.test.washouts)
    assert_array_equal(points["series"], data.test.points.series)
    assert_array_equal(points["step"], data.test.points.step)
    assert_array_equal(points["first"], data.test.truth.first)
    assert_array_equal(points["largest"], data.test.truth.largest)
    assert_array_equal(points["washout_maximum"], data.test.seen.max(axis=1))
    events = read_netcdf(results / name / "events.nc")
    assert_array_equal(events["observed"], data.before_events)
    assert_array_equal(events["truth"], data.truth_before_events)


def scored(path, capsys):
    """Scores that the command writes for a file of forecasts, by metric and prediction time."""
    assert main(["benchmark", "score", str(path)]) == 0
    capsys.readouterr()
    table = pd.read_csv(path.with_suffix(".scores.csv"))
    return table.set_index(["metric", "prediction_time_lt"]).sort_index()


def check_against_the_tables(scores, directory, forecaster):
    """Compare all that the tables of the case have on a forecaster."""

    def rows(table):
        found = pd.read_csv(directory / "tables" / f"{table}.csv")
        return found[found["forecaster"] == forecaster]

    for _, row in rows("classification").iterrows():
        for metric in ("precision", "recall", "f_score"):
            assert_array_equal(scores["value"][metric, row["prediction_time_lt"]], row[metric])
    ends = rows("classification_intervals")
    assert len(ends) == 15
    for _, row in ends.iterrows():
        found = scores.loc[(row["metric"], row["prediction_time_lt"])]
        assert_array_equal([found["low"], found["high"]], [row["low"], row["high"]])
    votes = rows("probability_scores").query("probability == 'votes' and metric in @OF_VOTES")
    assert len(votes) == 5 * len(OF_VOTES)
    for _, row in votes.iterrows():
        found = scores.loc[(row["metric"], row["prediction_time_lt"])]
        assert_array_equal(found[["value", "low", "high"]], row[["value", "low", "high"]])
    for _, row in rows("horizon_intervals").iterrows():
        found = scores.xs(row["metric"], level="metric").iloc[0]
        assert_array_equal([found["low"], found["high"]], [row["low"], row["high"]])
        assert found["value"] == rows("horizon")[row["metric"]].item()


OF_VOTES = (
    *("base_rate", "brier_score", "brier_skill", "reliability", "resolution"),
    *("calibration_error", "roc_area", "average_precision"),
)
"""Scores of probabilities that do not depend on the alarm threshold."""


@pytest.mark.parametrize("name", CASE_NAMES)
def test_persistence_of_the_page_has_the_rows_of_the_campaign(results, exported, name, capsys):
    directory, _ = exported
    page = (directory / "README.md").read_text(encoding="utf-8")
    (script,) = re.findall(r"```python\n(.*?)```", page, re.DOTALL)
    script = script.replace("Re400.nc", f"{name}.nc").replace("persistence.nc", f"{name}_p.nc")
    subprocess.run([sys.executable, "-c", script], cwd=directory, check=True)
    scores = scored(directory / f"{name}_p.nc", capsys)
    check_against_the_tables(scores, results / name, "persistence")


def test_learnt_equations_have_the_rows_of_the_campaign(results, exported, capsys):
    """With other scores than 0: forecasts of all components, by what the campaign has learnt."""
    name = "Re400"
    directory, found = exported
    data = found[name]
    options = options_of_kind("quadratic")
    case = ForecastingCase(data.case.space, 0.25, 4, data.case.steps_per_lyapunov_time, options)
    path = results / name / "quadratic" / "forecaster.nc"
    record = ForecasterRecord(read_netcdf(path), read_attributes(path))
    forecaster = forecaster_class("quadratic").restore(record, case)

    def states(washouts, steps):
        memory = forecaster.start(np.ascontiguousarray(washouts.transpose(1, 2, 0)))
        outputs, _ = forecaster.advance(memory, steps)
        return outputs.transpose(2, 0, 1)

    before = data.before_horizon(data.before_events)
    forecasts = {
        "state": states(data.test.washouts, data.task.steps),
        "horizon_state": states(before, data.search.longest_lead_time),
    }
    target = directory / f"{name}_quadratic.nc"
    with netCDF4.Dataset(target, "w") as file:
        file.setncatts({"case": name, "case_version": data.case.version, "seed": SEED})
        for variable, values in forecasts.items():
            axes = [f"{variable.removesuffix('state')}{axis}" for axis in ("point", "step")]
            axes.append("component")
            for axis, length in zip(axes, values.shape, strict=True):
                if axis not in file.dimensions:
                    file.createDimension(axis, length)
            file.createVariable(variable, "f8", axes)[...] = values
    scores = scored(target, capsys)
    assert scores["value"]["f_score", 1.0] > 0.5
    check_against_the_tables(scores, results / name, "quadratic")


@pytest.mark.long
def test_the_turbulent_flow_is_a_case_of_a_campaign(tmp_path, job_server):
    """Sensors, noise, washouts and events; products of matrices round as they like."""
    path = ROOT / "examples" / "benchmark" / "turbulence.yaml"
    project = Project.create(tmp_path / "project", job_server, str(path))
    results = "results/benchmark_turbulence/Kolmogorov"
    names = ("evaluation_set", "events", "forecast_task")
    outcome = project.snakemake(*(f"{results}/{name}.nc" for name in names))
    assert outcome.status == 0, outcome.text[-3000:]
    data = make_case(CASES["Kolmogorov"])
    directory = tmp_path / "project" / results
    points, events, task = (read_netcdf(directory / f"{name}.nc") for name in names)
    assert read_attributes(directory / "forecast_task.nc")["digest"] == data.case.digest
    np.testing.assert_allclose(points["washout"], data.test.washouts, rtol=1e-12, atol=1e-13)
    np.testing.assert_allclose(task["training"], data.training, rtol=1e-12, atol=1e-13)
    assert_array_equal(points["step"], data.test.points.step)
    assert_array_equal(points["largest"], data.test.truth.largest)
    np.testing.assert_allclose(events["observed"], data.before_events, rtol=1e-12, atol=1e-13)
    assert_array_equal(events["truth"], data.truth_before_events)


def test_the_record_is_a_case_of_a_campaign(tmp_path, job_server):
    """Duplicates, gaps and blocks by the reader of files; an EventForecaster's classifiers, too."""
    pytest.importorskip("bokeh_sampledata", reason="the record is not installed")
    extract = runpy.run_path(str(ROOT / "examples" / "real_records" / "extract.py"))["glucose"]
    path = ROOT / "examples" / "benchmark" / "glucose.yaml"
    project = Project.create(tmp_path / "project", job_server, str(path))
    form = "%Y-%m-%dT%H:%M:%S"
    extract().to_csv(project.directory / "glucose.csv", index=False, date_format=form)
    results = project.directory / "results" / "benchmark_glucose" / "Glucose"
    small = {"forecasters": {"esn_direct": {"neurons": 60}}}
    names = ("forecast_task.nc", "calibration.json")
    outcome = project.snakemake(
        *(f"results/benchmark_glucose/Glucose/{name}" for name in names), overlay=small
    )
    assert outcome.status == 0, outcome.text[-3000:]
    data = make_case(CASES["Glucose"])
    exported, found = data.exported, read_netcdf(results / "forecast_task.nc")
    assert read_attributes(results / "forecast_task.nc")["digest"] == data.case.digest
    assert_array_equal(found["training"], exported.training)
    assert_array_equal(found["washout"], exported.washouts)
    assert_array_equal(found["horizon_washout"], exported.horizon_washouts)
    rules = read_json(results / "calibration.json")["alarms"]
    for kind, options in (
        ("precursor", {"classifier": "logistic", "lags_lt": [1, 2, 3]}),
        ("esn_direct", {"neurons": 60}),
    ):
        fitted = EventForecaster(
            lambda states: -states[..., 0],
            data.case.event_threshold,
            prediction_times=data.case.prediction_times_lt,
            lyapunov_time=1 / data.case.lyapunov_exponent,
            sampling_interval=5.0,
            washout=6,
            kind=kind,
            calibration_spacing=1,
            random_seed=SEED,
            options={**options, "start_spacing_lt": 1},
        ).fit(data.training)
        for time, alarm in fitted.alarms_.items():
            rule = rules[kind][f"{time:g}"]["calibrated"]
            assert alarm.calibration.probabilities.tolist() == rule["probabilities"]
            assert alarm.threshold == rule["threshold"]


def test_cases_have_no_field_that_nothing_compares():
    """Whoever adds a field to a case compares it above, or says here that data compare it."""
    compared_by_data = {
        *("name", "version", "about", "digest", "ensemble_name", "system", "observed"),
        *("laminarisation_threshold", "initial_state", "perturbed_component", "perturbation"),
        *("time_step", "sampling_stride", "transient", "duration", "lyapunov_exponent"),
        *("washout_lt", "start_spacing_lt", "window_lt", "resolution_lt"),
        *("longest_lead_time_lt", "lead_time_step_lt", "sensors", "record"),
    }
    compared_above = {
        *("event_threshold", "training_series", "test_series", "noise", "series"),
        *("horizon_events", "tolerance", "prediction_times_lt"),
    }
    fields = {field.name for field in dataclasses.fields(CASES["Re400"])}
    assert fields == compared_by_data | compared_above
