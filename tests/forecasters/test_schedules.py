"""Schedules of parameters: what forecasters that use them, and all others, make of one."""

import numpy as np
import pytest

from burstcast.control.actuation import ActuatorShare
from burstcast.forecasters._options import DEFAULTS
from burstcast.forecasters.analogues import Analogues
from burstcast.forecasters.base import ForecastingCase, for_members
from burstcast.forecasters.equations import EquationsFromTruth
from burstcast.forecasters.equations_filtered import FilteredEquations
from burstcast.forecasters.equations_noisy import EquationsFromObservation
from burstcast.forecasters.linear_inverse import LinearInverseModel
from burstcast.forecasters.persistence import Persistence
from burstcast.forecasters.quadratic import QuadraticModel
from burstcast.forecasters.quadratic_filtered import FilteredQuadraticModel
from burstcast.systems.integration import integrate
from burstcast.systems.mfe import MoehlisFaisstEckhardt
from burstcast.systems.parameters import SystemParameters, integrate_scheduled

FREE, WASHOUT, AHEAD = MoehlisFaisstEckhardt(400.0), 30, 150
REYNOLDS = SystemParameters.of(FREE, ["reynolds"])
OPTIONS = {name: value for section in DEFAULTS.values() for name, value in section.items()}
CASE = ForecastingCase(FREE, 0.25, 4, 61, OPTIONS, REYNOLDS)
PLAIN = ForecastingCase(FREE, 0.25, 4, 61, OPTIONS)


def switching(steps, batch, on=2000.0, seed=7):
    changes = np.random.default_rng(seed).random((steps, batch)) < 0.1
    acting = np.cumsum(changes, axis=0) % 2 == 1
    return np.where(acting, on, 400.0)[:, np.newaxis]


@pytest.fixture(scope="module")
def flow():
    """Flows under switching actuation: their schedule, true and observed states."""
    start = np.array([1, 0, 0.07066, -0.07076, 0, 0, 0, 0, 0])[:, np.newaxis]
    perturbed = start + 0.01 * np.random.default_rng(2).random((9, 12))
    developed = integrate(FREE, perturbed, 0.25, 4 * 400, stride=1600)[-1]
    schedule = switching(WASHOUT - 1 + AHEAD, 12)
    true = integrate_scheduled(REYNOLDS, schedule, developed, 0.25, 4)
    noise = 0.01 * true.std(axis=(0, 2))[:, np.newaxis]
    return schedule, true, true + noise * np.random.default_rng(3).standard_normal(true.shape)


def forecast(model, washout, past=None, ahead=None):
    return model.advance(model.start(washout, past), AHEAD, ahead)[0]


def test_the_equations_told_of_the_schedule_forecast_perfectly(flow):
    schedule, true, _ = flow
    model = EquationsFromTruth.fit(np.empty((0, 2, 9)), CASE)
    told = forecast(model, true[:WASHOUT], schedule[: WASHOUT - 1], schedule[WASHOUT - 1 :])
    assert np.array_equal(told, true[WASHOUT:])
    assert not np.allclose(forecast(model, true[:WASHOUT]), true[WASHOUT:], atol=0.05)


def test_a_forecast_goes_on_where_it_was_left_under_a_schedule(flow):
    schedule, true, _ = flow
    model = EquationsFromTruth.fit(np.empty((0, 2, 9)), CASE)
    memory = model.start(true[:WASHOUT])
    ahead = schedule[WASHOUT - 1 :]
    first, memory = model.advance(memory, 40, ahead[:40])
    second, _ = model.advance(memory, AHEAD - 40, ahead[40:])
    assert np.array_equal(np.concatenate([first, second]), true[WASHOUT:])


def test_a_filter_told_of_the_schedule_estimates_better(flow):
    """The filter's error at the end of a washout under actuation; not told it trusts a free flow.

    Told, it is as good as it is in the free flow.
    """
    schedule, true, observed = flow
    model = FilteredEquations.fit(observed[: 2 * WASHOUT].transpose(2, 0, 1), CASE)
    told = model.start(observed[:WASHOUT], schedule[: WASHOUT - 1]) - true[WASHOUT - 1]
    ignorant = model.start(observed[:WASHOUT]) - true[WASHOUT - 1]
    noise = model.noise[:, np.newaxis]
    assert np.sqrt(np.mean((told / noise) ** 2)) < 0.6
    assert np.sqrt(np.mean((ignorant / noise) ** 2)) > 2 * np.sqrt(np.mean((told / noise) ** 2))


@pytest.mark.parametrize("kind", [EquationsFromObservation, FilteredEquations])
def test_the_case_s_own_values_are_in_force_without_a_schedule(kind, flow):
    _, _, observed = flow
    training = observed.transpose(2, 0, 1)
    own = REYNOLDS.constant(WASHOUT - 1, 12), REYNOLDS.constant(AHEAD, 12)
    washout = observed[:WASHOUT]
    told = forecast(kind.fit(training, CASE), washout, *own)
    assert np.array_equal(told, forecast(kind.fit(training, CASE), washout))
    assert np.array_equal(told, forecast(kind.fit(training, PLAIN), washout))


@pytest.mark.parametrize(
    "kind",
    [Analogues, LinearInverseModel, Persistence, QuadraticModel, FilteredQuadraticModel],
)
def test_kinds_that_are_not_aware_ignore_a_schedule(kind, flow):
    schedule, _, observed = flow
    model = kind.fit(observed.transpose(2, 0, 1), CASE, schedule.transpose(2, 0, 1))
    assert not model.aware
    washout = observed[:WASHOUT]
    told = forecast(model, washout, schedule[: WASHOUT - 1], schedule[WASHOUT - 1 :])
    plain = kind.fit(observed.transpose(2, 0, 1), PLAIN)
    assert np.array_equal(told, forecast(plain, washout), equal_nan=True)


def test_members_have_the_schedule_of_their_own_trajectory(flow):
    """Of a whole ensemble side by side, or of each trajectory by itself."""
    schedule, _, observed = flow
    model = FilteredEquations.fit(observed.transpose(2, 0, 1), CASE)
    past, ahead = schedule[: WASHOUT - 1], schedule[WASHOUT - 1 :]
    ensemble = model.ensemble(observed[:WASHOUT], past)
    together, _ = model.advance(
        ensemble.reshape(9, -1), AHEAD, for_members(ahead, ensemble.shape[1])
    )
    together = together.reshape(AHEAD, 9, -1, 12)
    for one in range(3):
        only = slice(one, one + 1)
        members = model.ensemble(observed[:WASHOUT, :, only], past[..., only])
        assert np.array_equal(members[:, :, 0], ensemble[:, :, one])
        alone, _ = model.advance(
            np.ascontiguousarray(members[..., 0]), AHEAD, ahead[..., [one] * members.shape[1]]
        )
        assert np.array_equal(alone, together[..., one])


def test_the_share_of_a_force_is_a_parameter_like_any_other():
    share = ActuatorShare.of(FREE, {}, [0, 0, 0.01, 0, 0, 0, 0, 0, 0])
    case = ForecastingCase(FREE, 0.25, 4, 61, OPTIONS, share)
    model = EquationsFromTruth.fit(np.empty((0, 2, 9)), case)
    start = 0.1 * np.ones((9, 2))
    on = np.concatenate([share.constant(20, 1), share.constant(20, 1, [1.0])], axis=2)
    outputs, _ = model.advance(start, 20, on)
    free, _ = model.advance(start, 20)
    assert np.array_equal(outputs[..., 0], free[..., 0])
    assert not np.allclose(outputs[..., 1], free[..., 1], atol=0.01)


def test_a_schedule_that_does_not_fit_is_refused(flow):
    schedule, true, _ = flow
    told = EquationsFromTruth.fit(np.empty((0, 2, 9)), CASE)
    with pytest.raises(ValueError, match=r"must have the shape \(20, 1, 12\)"):
        told.advance(true[0], 20, schedule[:19])
    plain = EquationsFromTruth.fit(np.empty((0, 2, 9)), PLAIN)
    with pytest.raises(ValueError, match="the case has no parameters"):
        plain.advance(true[0], 20, schedule[:20])
