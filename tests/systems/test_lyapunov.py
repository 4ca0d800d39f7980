"""Lyapunov exponents against exact and published ones, and the two methods against each other."""

from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np
import pytest
import scipy.stats

from burstcast.base.arrays import FloatArray
from burstcast.base.resampling import mean_with_interval
from burstcast.systems.base import DynamicalSystem
from burstcast.systems.compiled import compiled_steps
from burstcast.systems.integration import integrate, integrate_observed
from burstcast.systems.lorenz63 import Lorenz63
from burstcast.systems.lyapunov import (
    alignment_of,
    attractor_size,
    lyapunov_spectrum,
    perturbation_growth,
    tangent_flow,
    tangent_growth,
)
from burstcast.systems.mfe import MoehlisFaisstEckhardt
from burstcast.systems.runge_kutta import step
from helpers_library import FirstObserved

ROTATION = np.linalg.qr(np.random.default_rng(5).normal(size=(3, 3)))[0]


@dataclass(frozen=True)
class Linear(FirstObserved, DynamicalSystem):
    """dx/dt = A x with A symmetric, of known eigenvalues: the exponents."""

    rates: tuple[float, float, float]
    matrix: FloatArray = field(init=False, compare=False)

    dimension: ClassVar[int] = 3

    def __post_init__(self):
        object.__setattr__(self, "matrix", ROTATION @ np.diag(self.rates) @ ROTATION.T)

    def right_hand_side(self, state):
        return np.asarray(np.tensordot(self.matrix, state, 1))

    def jacobian(self, state):
        trailing = (1,) * (state.ndim - 1)
        return np.broadcast_to(self.matrix.reshape(3, 3, *trailing), (3, *state.shape))


def lorenz_states(count):
    start = np.random.default_rng(2).normal(0, 5, (3, count)) + np.array([[0.0], [0.0], [25.0]])
    return integrate(Lorenz63(), start, 0.01, 2000, 2000)[-1]


def turbulent_states(reynolds, count, steps):
    """States after the transient, of series that do not laminarise in the next steps."""
    system, state = MoehlisFaisstEckhardt(reynolds), np.zeros((9, 2 * count))
    state[[0, 2, 3]] = [[1.0], [0.07066], [-0.07076]]
    state[3] += 0.01 * np.random.default_rng(3).random(2 * count)
    series = integrate_observed(system, state, 0.25, steps, max(steps, 1), transient_steps=800)
    return series.states[0][:, series.largest_observable <= 0.48][:, :count]


def growth_along(system, state, step, steps, distances, alignment=0):
    generator = np.random.default_rng(1)
    return perturbation_growth(system, state, step, steps, *distances, generator, alignment)


def test_linear_system_has_the_eigenvalues_as_exponents():
    rates = (0.3, -0.1, -0.8)
    state = np.zeros((3, 2))
    spectrum = lyapunov_spectrum(Linear(rates), state, 0.02, 1000, 25, alignment_steps=1500)
    assert spectrum.duration == pytest.approx(20.0)
    np.testing.assert_allclose(spectrum.exponents, [rates, rates], rtol=0, atol=1e-6)


@pytest.mark.parametrize("leading", [0.3, -0.2])
def test_perturbations_of_a_linear_system_grow_at_the_leading_rate(leading):
    system, state = Linear((leading, -1.1, -1.8)), np.zeros((3, 4))
    growth = growth_along(system, state, 0.02, 5000, (1e-6, 1e-3), 2000)
    np.testing.assert_allclose(growth, leading, rtol=0, atol=1e-7)


def test_tangent_step_is_the_derivative_of_the_step():
    system = MoehlisFaisstEckhardt(400.0)
    state = turbulent_states(400.0, 4, 0)
    tangent = np.random.default_rng(4).normal(size=(9, 4))
    flow = tangent_flow(system)
    assert compiled_steps((flow,), 0.25, False) is not None
    both = np.concatenate([state, tangent])
    propagated = integrate(flow, both, 0.25, 1)[-1]
    assert np.array_equal(propagated, step(flow, both, 0.25))
    assert np.array_equal(propagated[:9], step(system, state, 0.25))
    expected = step(system, state + 1e-30j * tangent, 0.25).imag / 1e-30
    np.testing.assert_allclose(propagated[9:], expected, rtol=0, atol=1e-13)


def test_lorenz_has_the_published_exponents_by_both_methods():
    state = lorenz_states(100)
    size = attractor_size(state)
    spectrum = lyapunov_spectrum(Lorenz63(), state, 0.01, 4000, 20, alignment_steps=500).exponents
    estimate = mean_with_interval(spectrum)
    np.testing.assert_allclose(estimate.mean, [0.9056, 0.0, -14.572], rtol=0, atol=0.02)
    # volumes shrink at a constant rate
    np.testing.assert_allclose(spectrum.sum(axis=1), -(10.0 + 1.0 + 8.0 / 3.0), rtol=0, atol=2e-3)
    growth = growth_along(Lorenz63(), state, 0.01, 4000, (1e-8 * size, 1e-3 * size), 500)
    # what is left is the angle between perturbations at the two ends of the time
    np.testing.assert_allclose(growth, spectrum[:, 0], rtol=0, atol=0.1)
    assert abs(growth.mean() - spectrum[:, 0].mean()) < 0.01


@pytest.mark.parametrize(("of_state", "of_tangent"), [(np.inf, 2.0), (2.0, np.inf)])
def test_growth_beyond_the_finite_numbers_is_an_error(of_state, of_tangent):
    def advance(state, tangent):
        return state * of_state, tangent * of_tangent

    tangent = np.broadcast_to(np.eye(3), (2, 3, 3))
    with pytest.raises(FloatingPointError, match="left the range of floating-point numbers"):
        tangent_growth(advance, np.ones((3, 2)), tangent, 5)


def test_trajectories_do_not_depend_on_the_batch_and_incomplete_intervals_are_left_out():
    state = lorenz_states(5)
    together = lyapunov_spectrum(Lorenz63(), state, 0.01, 60, 20)
    for index in range(5):
        alone = lyapunov_spectrum(Lorenz63(), state[:, [index]], 0.01, 79, 20)
        assert alone.duration == together.duration == pytest.approx(0.6)
        assert np.array_equal(together.exponents[[index]], alone.exponents)


def test_interval_is_students():
    values = np.random.default_rng(1).normal(size=(12, 3))
    estimate = mean_with_interval(values, 0.9)
    interval = scipy.stats.ttest_1samp(values, 0.0).confidence_interval(0.9)
    np.testing.assert_allclose(estimate.mean, values.mean(axis=0))
    np.testing.assert_allclose([estimate.low, estimate.high], interval)
    estimate = mean_with_interval(np.array([1.0, 3.0]))
    assert (float(estimate.mean), estimate.low.shape) == (2.0, ())


def test_attractor_size_and_alignment():
    states = np.array([[3.0, -3.0, 3.0, -3.0], [4.0, -4.0, 4.0, -4.0]]) + 7.0
    assert attractor_size(states) == pytest.approx(5.0)
    assert alignment_of(4000, 10) == 1000
    assert alignment_of(4039, 30) == 990
    assert alignment_of(30, 10) == 0


def spectrum_of(state=1.0, time_step=0.01, steps=20, every=10, **others):
    state = np.full((3, 2), state) if np.ndim(state) == 0 else state
    return lyapunov_spectrum(Lorenz63(), state, time_step, steps, every, **others)


def growth_of(state=1.0, step=0.01, steps=20, initial=1e-8, saturation=1e-3, alignment_steps=0):
    state = np.full((3, 1), state)
    return growth_along(Lorenz63(), state, step, steps, (initial, saturation), alignment_steps)


CERTAIN = {"per_series": np.ones(4), "confidence": 1.0}
LONG_INTERVAL = {"state": lorenz_states(2), "steps": 1000, "every": 500}


@pytest.mark.parametrize(
    ("function", "arguments", "error", "message"),
    [
        (spectrum_of, {"state": np.zeros((2, 3))}, ValueError, "shape"),
        (spectrum_of, {"time_step": -1.0}, ValueError, "time step"),
        (spectrum_of, {"every": 0}, ValueError, "at least one step"),
        (spectrum_of, {"alignment_steps": -1}, ValueError, "alignment"),
        (spectrum_of, {"steps": 9}, ValueError, "no complete interval"),
        (spectrum_of, {"state": 1e200}, FloatingPointError, "left the range"),
        (growth_of, {"initial": 0.0}, ValueError, "0 < initial < saturation"),
        (growth_of, {"saturation": 1e-9}, ValueError, "0 < initial < saturation"),
        (growth_of, {"saturation": np.inf}, ValueError, "0 < initial < saturation"),
        (growth_of, {"steps": 0}, ValueError, "at least one step"),
        (growth_of, {"alignment_steps": -1}, ValueError, "alignment"),
        (growth_of, {"state": 1e200}, FloatingPointError, "coincide"),  # 1e-8 beside 1e200
        (
            growth_of,
            {"state": 1e80, "step": 1.0, "initial": 1e70, "saturation": 1e75},
            *(FloatingPointError, "left the range"),
        ),
        (mean_with_interval, {"per_series": np.ones(1)}, ValueError, "confidence"),
        (mean_with_interval, CERTAIN | {"confidence": 0.0}, ValueError, "confidence"),
        (mean_with_interval, CERTAIN, ValueError, "confidence"),
        (spectrum_of, LONG_INTERVAL, ValueError, "lost to rounding"),
    ],
)
def test_mistakes_are_told(function, arguments, error, message):
    with pytest.raises(error, match=message):
        function(**arguments)


@pytest.mark.long
@pytest.mark.parametrize(
    ("reynolds", "published", "expected"),
    [
        (400.0, 0.0163, 0.0155),
        (600.0, 0.0135, 0.0137),
        (800.0, 0.0126, 0.0127),
        (1000.0, 0.0121, 0.0121),
    ],
)
def test_shear_flow_has_the_published_exponents(reynolds, published, expected):
    system = MoehlisFaisstEckhardt(reynolds)
    # The exponents of single series scatter by 0.003: a thousand give a standard error of 1e-4.
    state = turbulent_states(reynolds, 1000, 16000)
    assert state.shape[1] == 1000
    size = attractor_size(state)
    growth = growth_along(system, state, 0.25, 12000, (1e-8 * size, 1e-2 * size), 4000)
    leading = growth.mean()
    assert leading == pytest.approx(published, rel=0.07)
    assert leading == pytest.approx(expected, abs=3e-4)
    spectrum = lyapunov_spectrum(system, state[:, :100], 0.25, 12000, 20, alignment_steps=4000)
    by_qr = spectrum.exponents.mean(axis=0)
    assert by_qr[0] == pytest.approx(growth[:100].mean(), abs=5e-5)
    assert abs(by_qr[2]) < 5e-4  # the direction of the flow itself
