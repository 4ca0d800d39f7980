"""The job that compares all that a case asks of its series, once the Lyapunov time is known."""

import json

import numpy as np
import pytest
from helpers_rebuilds import loaded_script

from burstcast.files.netcdf import Variable, write_netcdf
from burstcast_workflow.harness.settings import Settings

FITTING = {
    "case": "A",
    "case.ensemble.time_step": 0.1,
    "case.ensemble.sampling_stride": 1,
    "case.lyapunov.time_unit": "computed",
    "case.lyapunov.published_exponent": None,
    "case.training.series": 3,
    "case.recycle_validation.series": 2,
    "case.recycle_validation.intervals_per_series": 2,
    "washout_lt": 1,
    "search.interval_lt": 3,
    "search.single_shot_lead_steps": 5,
    "classification.start_spacing_lt": 1,
    "classification.resolution_lt": 0.1,
    "classification.longest_prediction_time_lt": 4,
    "classification.window_lt": 1,
    "probability.start_spacing_lt": 1,
    "horizon.longest_lead_time_lt": 5,
    "horizon.lead_time_step_lt": 0.5,
    "statistics.fixed_point_interval_lt": 2,
    "statistics.duration": None,
    "forecasters.quadratic.window_lt": 2,
    "asked.kinds": ["esn", "quadratic"],
    "asked.validations": ["RV"],
    "asked.long_runs": True,
}


def problems(tmp_path, steps=20, samples=400, **changed):
    """Message of the job over a series of so many samples, and so many steps of a Lyapunov time."""
    script = loaded_script("data/lengths.py")
    ensemble, lengths = tmp_path / "ensemble.nc", tmp_path / "lengths.json"
    write_netcdf(ensemble, {"time": Variable(("time",), np.arange(samples) * 0.1, "1", "t")}, {})
    settings = Settings({**FITTING, **changed}, {}, computed_exponent=10 / steps)
    try:
        script.lengths_of_case(ensemble=str(ensemble), lengths=str(lengths), settings=settings)
    except ValueError as error:
        assert not lengths.exists()
        return str(error)
    found = json.loads(lengths.read_text())
    assert (found["steps_per_lyapunov_time"], found["samples"]) == (steps, samples)
    return ""


def test_what_fits_passes(tmp_path):
    assert not problems(tmp_path)


def test_all_that_does_not_fit_is_one_list(tmp_path):
    message = problems(tmp_path, steps=100)
    assert "a series of 400 samples has 4 Lyapunov times of 100 steps" in message
    for named in ("search.interval_lt", "classification.longest_prediction_time_lt", "horizon."):
        assert named in message
    assert "quadratic" not in message
    assert "statistics" not in message


@pytest.mark.parametrize(
    ("changed", "named"),
    [
        ({"classification.longest_prediction_time_lt": 30}, "classification.longest_"),
        ({"horizon.longest_lead_time_lt": 25}, "horizon.longest_lead_time_lt"),
        ({"statistics.duration": 0.1}, "statistics.duration"),
        ({"forecasters.quadratic.window_lt": 30}, "forecasters.quadratic.window_lt"),
        ({"classification.resolution_lt": 0.001}, "classification.resolution_lt"),
    ],
)
def test_each_is_named_and_no_other(tmp_path, changed, named):
    message = problems(tmp_path, **changed)
    assert named in message
    assert "; " not in message.partition("; ")[2]


def test_only_what_the_case_has_is_asked_for(tmp_path):
    window = {"forecasters.quadratic.window_lt": 30, "asked.kinds": ["esn"]}
    assert not problems(tmp_path, **window)
    assert not problems(tmp_path, **{"statistics.duration": 0.1, "asked.long_runs": False})
    searched = {"search.interval_lt": 25, "asked.validations": []}
    assert not problems(tmp_path, **searched)
