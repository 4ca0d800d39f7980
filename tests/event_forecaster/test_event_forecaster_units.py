"""The same record in other units, or in another layout of memory, gives the same forecasts."""

import functools

import numpy as np
import pytest
from test_event_forecaster import LYAPUNOV_TIME

from burstcast import EventForecaster
from burstcast.forecasters.registry import all_kinds, kind_class
from burstcast.systems.integration import integrate
from burstcast.systems.lorenz63 import Lorenz63

THRESHOLD = 12.0
RHO = np.repeat([26.0, 30.0], 4)
AWARE = {"parameters": ("rho",), "transform": "identity"}
OPTIONS = {
    "esn_direct": {"neurons": 100, "folds": 2, "input_scaling": (1.0,)},
    "precursor": {"folds": 2},
    **dict.fromkeys(("esn_aware", "quadratic_aware", "quadratic_aware_filtered"), AWARE),
}
# equations are equations in their own units
KINDS = [kind for kind in all_kinds() if not kind_class(kind).needs_equations]


@functools.cache
def record():
    """Series of float32 numbers, under two values of rho, and test series."""
    start = np.array([[1.0, 1.0, 20.0]] * 12).T
    start += np.random.default_rng(4).uniform(-5, 5, start.shape)
    halves = [
        integrate(Lorenz63(rho=rho), start[:, rows], 0.01, 2000, stride=2)[300:].transpose(2, 0, 1)
        for rho, rows in ((26.0, slice(6)), (30.0, slice(6, 12)))
    ]
    series = np.concatenate([half[:4] for half in halves] + [half[4:] for half in halves])
    series += np.random.default_rng(5).normal(scale=0.05, size=series.shape)
    return np.split(series.astype(np.float32).astype(float), [8])


def unfitted(kind, scale=1.0, offset=0.0, observable=0, **more):
    """A small forecaster of the record in a unit."""
    return EventForecaster(
        observable=observable,
        event_threshold=THRESHOLD * scale + offset,
        kind=kind,
        prediction_times=(0.5,),
        lyapunov_time=LYAPUNOV_TIME,
        sampling_interval=0.02,
        **{"members": 2, "neurons": 80, "grid": 2, "bayesian_points": 1, "input_scaling": (1, 5)},
        tikhonov=1e-4,  # well-conditioned: rounding stays rounding
        options={**OPTIONS.get(kind, {}), **more} or None,
    )


def after(forecaster, test):
    """Probabilities after several lengths of test series."""
    ends = range(60, 700, 20)
    return np.stack([forecaster.predict_proba(test[:, :end])[:, 1] for end in ends])


def probabilities(kind, change, scale=1.0, offset=0.0, **more):
    """Probabilities of test series by a small forecaster of changed series."""
    training, test = (change(series * scale + offset) for series in record())
    learns = kind_class(kind).learns_parameters
    forecaster = unfitted(kind, scale, offset, **more)
    return after(forecaster.fit(training, parameters=RHO if learns else None), test)


@functools.cache
def expected(kind):
    return probabilities(kind, np.asarray)


def assert_equal_forecasts(kind, found):
    # what forecasts no event at all would be equal in vain; persistence never does
    assert np.ptp(expected(kind)) > (-1 if kind == "persistence" else 0.3)
    # votes are counted; rounding reaches what is not
    tolerance = 1e-9 if kind == "esn_direct" else 0
    np.testing.assert_allclose(found, expected(kind), rtol=0, atol=tolerance)


@pytest.mark.parametrize("scale", [1e7, 1e-6])
@pytest.mark.parametrize("kind", KINDS)
def test_another_unit_changes_no_forecast(kind, scale):
    assert_equal_forecasts(kind, probabilities(kind, np.asarray, scale))


@pytest.mark.parametrize("kind", [kind for kind in KINDS if not kind.startswith("quadratic")])
def test_another_zero_changes_no_forecast(kind):
    assert_equal_forecasts(kind, probabilities(kind, np.asarray, offset=1e4))


@pytest.mark.parametrize("change", [np.asfortranarray, lambda one: one.astype(np.float32)])
@pytest.mark.parametrize("kind", KINDS)
def test_the_layout_of_numbers_changes_no_forecast(kind, change):
    np.testing.assert_array_equal(probabilities(kind, change), expected(kind))


@pytest.mark.parametrize("kind", KINDS)
def test_nothing_of_the_caller_is_kept_or_changed(kind):
    def in_place(states):
        np.negative(states, out=states)
        return -states[..., 0]

    (training, test), rho = (one.copy() for one in record()), RHO.copy()
    forecaster = unfitted(kind, observable=in_place)
    learns = kind_class(kind).learns_parameters
    forecaster.fit(training, parameters=rho if learns else None)
    np.testing.assert_array_equal(training, record()[0])
    training[:] = rho[:] = np.nan
    np.testing.assert_array_equal(after(forecaster, test), expected(kind))
    np.testing.assert_array_equal(test, record()[1])


@pytest.mark.parametrize("kind", ["esn", "esn_direct"])
def test_networks_without_an_offset_depend_on_the_zero(kind):
    plain = probabilities(kind, np.asarray, input_offset="none")
    moved = probabilities(kind, np.asarray, offset=1e4, input_offset="none")
    assert np.abs(moved - plain).max() > 0.1
