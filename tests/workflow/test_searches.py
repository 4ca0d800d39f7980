"""The validation of a point as the scan and the search make it."""

from types import SimpleNamespace

import numpy as np
import pytest

from burstcast.esn.dynamics import Dynamics
from burstcast.systems.integration import integrate
from burstcast.systems.lorenz63 import Lorenz63
from burstcast.tuning.hyperparameters import HyperparameterPoint
from burstcast.tuning.strategies.base import ValidationPlan
from burstcast.tuning.strategies.recycle import RecycleValidation
from burstcast.tuning.strategies.single_shot import SingleShotValidation
from burstcast.tuning.validation import validate
from burstcast_workflow.network_files import reservoir, training_series
from burstcast_workflow.searches import point_validator, trace_rows
from burstcast_workflow.storage import Variable, write_netcdf

STEPS = 25  # in a Lyapunov time
SETTINGS = {
    "case": "lorenz",
    "system": "lorenz63",
    "parameters": {},
    "random_seed": 2022,
    "training": {"series": 3, "noise": 0.01},
    "neurons": 40,
    "seed": 0,
    "connectivity": 6,
    "input_bias": 0.1,
    "kernel": "scipy",
    "washout_lt": 0.5,
    "interval_lt": 2,
    "steps_per_lyapunov_time": STEPS,
    "sampling_interval": 0.04,
    "recycle_validation": {"series": 2, "intervals_per_series": 4},
    "tikhonov": [1e-6, 1e-9],
}
POINT = HyperparameterPoint(0.5, 2.0)


@pytest.fixture(scope="module")
def inputs(tmp_path_factory):
    start = np.array([[1.0, 1.0, 20.0]] * 4).T + np.random.default_rng(2).random((3, 4))
    states = integrate(Lorenz63(), start, 0.01, 1600, stride=4)[101:].transpose(2, 0, 1)
    path = tmp_path_factory.mktemp("data") / "ensemble.nc"
    variables = {
        "series": Variable(("series",), np.arange(4), "1", "number"),
        "state": Variable(("series", "time", "component"), states, "1", "state"),
    }
    write_netcdf(path, variables, {})
    return SimpleNamespace(ensemble=str(path), lyapunov=[])


def test_durations_are_those_of_the_settings(inputs):
    found = point_validator(SETTINGS, inputs)(POINT, [SingleShotValidation(), RecycleValidation()])
    plan = ValidationPlan(washout=12, interval=50, series=2, intervals=4)
    expected = validate(
        Dynamics(reservoir(SETTINGS, 3), 0.5, 2.0, "scipy"),
        training_series(SETTINGS, inputs.ensemble),
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
            {"recycle_validation": {"series": 2, "intervals_per_series": 6}},
            r"recycle_validation\.intervals_per_series is 6, but only 5 intervals",
        ),
        ({"interval_lt": 11.6}, r"search\.interval_lt"),
        ({"washout_lt": 0.01}, r"network\.washout_lt is 0\.01 Lyapunov times"),
        ({"training": {"series": 5, "noise": 0}}, r"training\.series is 5, but only 4 series"),
    ],
)
def test_what_does_not_fit_is_told_before_anything_is_computed(inputs, change, message):
    with pytest.raises(ValueError, match=message):
        point_validator({**SETTINGS, **change}, inputs)


def test_intervals_that_just_fit_are_accepted(inputs):
    settings = {**SETTINGS, "recycle_validation": {"series": 3, "intervals_per_series": 5}}
    assert len(point_validator(settings, inputs)(POINT, [RecycleValidation()])) == 2


def test_rows_of_the_trace(inputs):
    validations = point_validator(SETTINGS, inputs)(POINT, [RecycleValidation()])
    rows = trace_rows(7, "bayesian", POINT, validations)
    assert [row["tikhonov"] for row in rows] == [1e-6, 1e-9]
    for row, validation in zip(rows, validations, strict=True):
        assert (row["evaluation"], row["source"], row["validation"]) == (7, "bayesian", "RV")
        assert (row["spectral_radius"], row["input_scaling"]) == (0.5, 2.0)
        assert row["objective"] == validation.objective
        assert row["solver"] == validation.solver
