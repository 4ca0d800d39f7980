"""The search of a reservoir as the scan and the search make it."""

import numpy as np
import pytest

from burstcast.esn.dynamics import Dynamics
from burstcast.files.netcdf import Variable
from burstcast.forecasters.esn import ReservoirSeed
from burstcast.systems.integration import integrate
from burstcast.systems.lorenz63 import Lorenz63
from burstcast.tuning.hyperparameters import HyperparameterPoint
from burstcast.tuning.scan import scan
from burstcast.tuning.scan_files import log_error_variables, read_evaluations
from burstcast.tuning.strategies.base import ValidationPlan
from burstcast.tuning.strategies.recycle import RecycleValidation
from burstcast.tuning.strategies.single_shot import SingleShotValidation
from burstcast.tuning.validation import validate
from burstcast_workflow.harness.storage import write_netcdf
from burstcast_workflow.jobs.networks import (
    point_validator,
    search_space,
    training_series,
)

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
    "forecasters.esn.input_range": "all",
    "forecasters.esn.readout": "linear",
    "forecasters.esn.leak_rate": [1],
    "forecasters.esn.backend": "scipy",
    "washout_lt": 0.5,
    "search.interval_lt": 2,
    "search.single_shot_lead_steps": 0,
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
            r"6 validation intervals per series are requested, but only 5 intervals",
        ),
        ({"search.interval_lt": 11.6}, "leave nothing to train on before the last"),
        ({"search.interval_lt": 0.01}, r"search\.interval_lt is 0\.01 Lyapunov times"),
        ({"washout_lt": 0.01}, r"washout_lt is 0\.01 Lyapunov times"),
        ({"case.training.series": 5}, r"training\.series is 5, but only 4 series"),
    ],
)
def test_what_does_not_fit_is_told_before_anything_is_computed(ensemble, change, message):
    strategies = [SingleShotValidation(), RecycleValidation()]
    with pytest.raises(ValueError, match=message):
        validator({**SETTINGS, **change}, ensemble)(POINT, strategies)


def test_intervals_that_just_fit_are_accepted(ensemble):
    settings = {
        **SETTINGS,
        "case.recycle_validation": {"series": 3, "intervals_per_series": 5},
    }
    assert len(validator(settings, ensemble)(POINT, [RecycleValidation()])) == 2


def test_evaluations_are_read_as_they_were_written(ensemble, tmp_path):
    """Also where strategies have different numbers of intervals."""
    strategies = [SingleShotValidation(), RecycleValidation()]
    found = scan(validator(SETTINGS, ensemble), search_space(SETTINGS), strategies, 2)
    assert [one.number for one in found[::4]] == [0, 1, 2, 3]
    path = str(tmp_path / "errors.nc")
    write_netcdf(path, log_error_variables(found), {"rule": "scan"})
    records = [one.record() for one in found]
    assert read_evaluations(records, path) == found
    intervals = [len(one.validation.log_errors) for one in found[:4]]
    assert intervals[0] == intervals[1] < intervals[2] == intervals[3]
    for one, record in zip(found, records, strict=True):
        assert record["objective"] == np.mean(one.validation.log_errors)
        assert (record["source"], record["solver"]) == ("grid", one.validation.solver)


def test_the_search_space_is_that_of_the_settings():
    corners = {
        (point.spectral_radius, point.input_scaling) for point in search_space(SETTINGS).grid(2)
    }
    assert corners == {(0.1, 0.5), (0.1, 5), (1, 0.5), (1, 5)}
