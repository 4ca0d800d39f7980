"""What `burstcast.EventForecaster` makes of a case's series is what the workflow makes of them."""

from pathlib import Path

import numpy as np
import pytest
import yaml
from numpy.testing import assert_array_equal

from burstcast.event_forecaster import forecaster
from burstcast.event_forecaster.forecaster import EventForecaster
from burstcast.files.netcdf import read_attributes, read_netcdf
from burstcast.forecasters import _options as forecaster_options
from burstcast.systems.mfe import MoehlisFaisstEckhardt
from burstcast_workflow.config.model import Forecasters
from burstcast_workflow.harness.canonical import canonical
from burstcast_workflow.harness.storage import read_json

ROOT = Path(__file__).parents[2]
CASE = "Re400"


def settings_of(config, neurons, validation):
    """The settings of a preset in the words of the estimator."""
    of_case = config["case_defaults"]
    reynolds = MoehlisFaisstEckhardt(reynolds=400.0)
    recycle = config["cases"][CASE]["recycle_validation"]
    return {
        "observable": reynolds,
        "event_threshold": of_case["event_threshold"],
        "prediction_times": config["classification"]["prediction_times_lt"],
        "window": config["classification"]["window_lt"],
        "lyapunov_time": 1 / config["cases"][CASE]["lyapunov"]["published_exponent"],
        "sampling_interval": 1.0,
        "sampling_stride": of_case["ensemble"]["sampling_stride"],
        "washout": config["washout_lt"],
        "members": 1,
        "neurons": neurons,
        "validation": validation,
        "validation_interval": config["search"]["interval_lt"],
        "validation_series": recycle["series"],
        "intervals_per_series": recycle["intervals_per_series"],
        "tikhonov": config["search"]["tikhonov"],
        "grid": config["search"]["grid"],
        "bayesian_points": config["search"]["bayesian_points"],
        "noise": of_case["training"]["noise"],
        "random_seed": config["random_seed"],
        "case": CASE,
        "options": {"backend": config["forecasters"]["esn"]["backend"]},
    }


@pytest.mark.parametrize(("neurons", "validation"), [(40, "RV"), (30, "SSV")])
def test_a_network_is_the_workflows_bit_for_bit(finished, neurons, validation):
    results = finished.project.results
    config = read_json(results / ".run.json")["config"]
    training = config["case_defaults"]["training"]["series"]
    states = read_netcdf(results / CASE / "ensemble.nc", "state")["state"]
    found = EventForecaster(**settings_of(config, neurons, validation)).fit(states[:training])

    identifier = f"esn-N{neurons}-{validation}-seed0"
    path = results / CASE / identifier / "forecaster.nc"
    (member,) = found.members_
    record = member.record()
    for name, array in read_netcdf(path).items():
        assert_array_equal(record.arrays[name], array)
    attributes = read_attributes(path)
    for name, value in record.attributes.items():
        assert attributes[name] == value
    hyperparameters = read_json(path.parent / "hyperparameters.json")
    assert found.hyperparameters_ == [
        {name: hyperparameters[name] for name in found.hyperparameters_[0]}
    ]
    # probabilities, from forecasts of each training series by a readout that has not seen it
    rules = read_json(results / CASE / "calibration.json")["alarms"][identifier]
    assert len(found.alarms_) > 1
    for time, alarm in found.alarms_.items():
        rule = rules[f"{time:g}"]["calibrated"]
        assert alarm.calibration.values.tolist() == rule["values"]
        assert alarm.calibration.probabilities.tolist() == rule["probabilities"]
        assert alarm.threshold == rule["threshold"]
    assert any(np.ptp(alarm.calibration.probabilities) > 0 for alarm in found.alarms_.values())


def test_a_forecaster_without_a_search_is_the_workflows(finished):
    results = finished.project.results
    config = read_json(results / ".run.json")["config"]
    states = read_netcdf(results / CASE / "ensemble.nc", "state")["state"]
    settings = settings_of(config, 40, "RV") | {
        "kind": "quadratic_filtered",
        "options": {"members": config["forecasters"]["filter"]["members"]},
    }
    found = EventForecaster(**settings).fit(states[: config["case_defaults"]["training"]["series"]])
    record = found.members_[0].record()
    stored = read_netcdf(results / CASE / "quadratic_filtered" / "forecaster.nc")
    assert set(stored) == set(record.arrays)
    for name, array in stored.items():
        assert_array_equal(record.arrays[name], array)
    # the members of the filter's ensemble vote
    alarms = read_json(results / CASE / "calibration.json")["alarms"]
    for time, alarm in found.alarms_.items():
        rule = alarms["quadratic_filtered-committee"][f"{time:g}"]["calibrated"]
        assert alarm.calibration.values.tolist() == rule["values"]
        assert alarm.calibration.probabilities.tolist() == rule["probabilities"]


def test_the_options_of_kinds_are_those_of_the_config():
    defaults = canonical(dict(forecaster_options.DEFAULTS))
    assert Forecasters().dump() == {**defaults, "variants": {}}


def test_defaults_are_those_of_the_config():
    """All parameters that the config has too, but for those that depend on the case."""
    config = yaml.safe_load((ROOT / "config.yaml").read_text(encoding="utf-8"))
    search, probability = config["search"], config["probability"]
    classification = config["classification"]
    networks = config["campaign"][0]["forecasters"]["esn"]
    expected = {
        "washout": config["washout_lt"],
        "window": classification["window_lt"],
        "start_spacing": classification["start_spacing_lt"],
        "members": networks["seeds"],
        "neurons": networks["neurons"][0],
        "spectral_radius": tuple(search["spectral_radius"]),
        "input_scaling": tuple(search["input_scaling"]),
        "tikhonov": tuple(search["tikhonov"]),
        "grid": search["grid"],
        "bayesian_points": search["bayesian_points"],
        "validation_interval": search["interval_lt"],
        "prior_forecasts": probability["prior_forecasts"],
        "calibration_spacing": probability["start_spacing_lt"],
    }
    defaults = EventForecaster().get_params()
    assert {name: defaults[name] for name in expected} == expected
    assert probability["bins"] == forecaster.BINS
