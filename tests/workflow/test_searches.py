"""The validation of a point as the scan and the search make it."""

import numpy as np
import pytest

from burstcast.esn.dynamics import Dynamics
from burstcast.forecasters.esn import ReservoirSeed
from burstcast.netcdf import Variable
from burstcast.systems.integration import integrate
from burstcast.systems.lorenz63 import Lorenz63
from burstcast.tuning.hyperparameters import HyperparameterPoint
from burstcast.tuning.strategies.base import ValidationPlan
from burstcast.tuning.strategies.recycle import RecycleValidation
from burstcast.tuning.strategies.single_shot import SingleShotValidation
from burstcast.tuning.validation import validate
from burstcast_workflow.harness.storage import write_netcdf
from burstcast_workflow.jobs.searches import (
    point_validator,
    read_log_errors,
    search_space,
    trace_rows,
    write_log_errors,
)
from burstcast_workflow.jobs.training import training_series

STEPS = 25  # in a Lyapunov time
IDENTIFIER = "esn-N40-seed0"  # the reservoir of a scan
SETTINGS = {
    "case": "lorenz",
    "case.system": "lorenz63",
    "case.parameters": {},
    "case.ensemble.time_step": 0.01,
    "case.ensemble.sampling_stride": 4,
    "case.lyapunov.time_unit": "published",
    "case.lyapunov.published_exponent": 1.0,  # a Lyapunov time of STEPS
    "case.training.series": 3,
    "case.training.noise": 0.01,
    "case.recycle_validation": {"series": 2, "intervals_per_series": 4},
    "random_seed": 2022,
    "forecasters.esn.connectivity": 6,
    "forecasters.esn.input_bias": 0.1,
    "forecasters.esn.backend": "scipy",
    "washout_lt": 0.5,
    "search.interval_lt": 2,
    "search.tikhonov": [1e-6, 1e-9],
    "search.spectral_radius": [0.1, 1],
    "search.input_scaling": [0.5, 5],
}
POINT = HyperparameterPoint(0.5, 2.0)


@pytest.fixture(scope="module")
def ensemble(tmp_path_factory):
    start = np.array([[1.0, 1.0, 20.0]] * 4).T + np.random.default_rng(2).random((3, 4))
    states = integrate(Lorenz63(), start, 0.01, 1600, stride=4)[101:].transpose(2, 0, 1)
    path = tmp_path_factory.mktemp("data") / "ensemble.nc"
    variables = {
        "series": Variable(("series",), np.arange(4), "1", "number"),
        "state": Variable(("series", "time", "component"), states, "1", "state"),
    }
    write_netcdf(path, variables, {})
    return str(path)


def validator(settings, ensemble):
    return point_validator(settings, IDENTIFIER, ensemble, [])


def test_durations_are_those_of_the_settings(ensemble):
    found = validator(SETTINGS, ensemble)(POINT, [SingleShotValidation(), RecycleValidation()])
    plan = ValidationPlan(washout=12, interval=50, series=2, intervals=4)
    expected = validate(
        Dynamics(ReservoirSeed(2022, 40, 0, 6, 0.1).reservoir(3), 0.5, 2.0, "scipy"),
        training_series(SETTINGS, ensemble),
        Lorenz63().observable,
        plan,
        [1e-6, 1e-9],
        [SingleShotValidation(), RecycleValidation()],
    )
    assert found == expected
    assert len(found) == 4


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (
            {"case.recycle_validation": {"series": 2, "intervals_per_series": 6}},
            r"recycle_validation\.intervals_per_series is 6, but only 5 intervals",
        ),
        ({"search.interval_lt": 11.6}, r"search\.interval_lt"),
        ({"washout_lt": 0.01}, r"washout_lt is 0\.01 Lyapunov times"),
        ({"case.training.series": 5}, r"training\.series is 5, but only 4 series"),
    ],
)
def test_what_does_not_fit_is_told_before_anything_is_computed(ensemble, change, message):
    with pytest.raises(ValueError, match=message):
        validator({**SETTINGS, **change}, ensemble)


def test_intervals_that_just_fit_are_accepted(ensemble):
    settings = {
        **SETTINGS,
        "case.recycle_validation": {"series": 3, "intervals_per_series": 5},
    }
    assert len(validator(settings, ensemble)(POINT, [RecycleValidation()])) == 2


def test_rows_of_the_trace(ensemble):
    validations = validator(SETTINGS, ensemble)(POINT, [RecycleValidation()])
    rows = trace_rows(7, "bayesian", POINT, validations)
    assert [row["tikhonov"] for row in rows] == [1e-6, 1e-9]
    for row, validation in zip(rows, validations, strict=True):
        assert (row["evaluation"], row["source"], row["validation"]) == (7, "bayesian", "RV")
        assert (row["spectral_radius"], row["input_scaling"]) == (0.5, 2.0)
        assert row["objective"] == validation.objective
        assert row["solver"] == validation.solver


def test_errors_in_intervals_are_kept_by_rows_whatever_their_number(ensemble, tmp_path):
    strategies = [SingleShotValidation(), RecycleValidation()]
    validations = validator(SETTINGS, ensemble)(POINT, strategies)
    path = str(tmp_path / "errors.nc")
    write_log_errors(path, validations, {"rule": "scan"})
    found = read_log_errors(path)
    assert len(found[0]) == len(found[1]) < len(found[2]) == len(found[3])
    assert found == [validation.log_errors for validation in validations]
    assert [np.mean(row) for row in found] == [validation.objective for validation in validations]


def test_the_search_space_is_that_of_the_settings():
    corners = {
        (point.spectral_radius, point.input_scaling) for point in search_space(SETTINGS).grid(2)
    }
    assert corners == {(0.1, 0.5), (0.1, 5), (1, 0.5), (1, 5)}
