"""Lyapunov exponents of forecasters, and of series by the divergence of neighbours."""

import re
from itertools import product

import numpy as np
import pytest

from burstcast.forecasters.equations import EquationsFromTruth
from burstcast.forecasters.linear_inverse import LinearInverseModel
from burstcast.forecasters.persistence import Persistence
from burstcast.forecasters.registry import kind_class, trajectory_kinds
from burstcast.statistics import lyapunov_spectrum as module
from burstcast.statistics import neighbour_divergence as neighbours
from burstcast.statistics.lyapunov_spectrum import forecaster_spectrum, summarise
from burstcast.statistics.neighbour_divergence import (
    NoExponentError,
    correlation_steps,
    neighbour_divergence,
    surrogate,
)
from burstcast.systems.integration import integrate
from burstcast.systems.lorenz63 import Lorenz63
from burstcast.systems.lyapunov import kaplan_yorke_dimension, lyapunov_spectrum

ROTATION = np.linalg.qr(np.random.default_rng(5).normal(size=(3, 3))).Q
STEP = 0.02


def spectrum(forecaster, washouts, steps, exponents=3, interval=5, seed=1):
    generator = np.random.default_rng(seed)
    return forecaster_spectrum(forecaster, washouts, steps, interval, exponents, STEP, generator)


def lorenz_series(count=10, steps=4000):
    """States of the Lorenz equations, ``(series, time, 3)``; published exponent: 0.906."""
    start = np.random.default_rng(2).normal(0, 8, (3, count)) + np.array([[0.0], [0.0], [25.0]])
    start = integrate(Lorenz63(), start, 0.01, 2000, 2000)[-1]
    return integrate(Lorenz63(), start, 0.01, 2 * steps, 2).transpose(2, 0, 1)


def linear(rates, rotation=ROTATION, mean=0.0):
    propagator = rotation @ np.diag(rates) @ rotation.T
    return LinearInverseModel(propagator=propagator, constant=np.full(3, mean))


@pytest.mark.parametrize(
    ("model", "exponents", "rates"),
    [
        (linear([1.05, 0.9, 0.4], mean=0.1), 3, [1.05, 0.9, 0.4]),
        (linear([1.05, 0.9, 0.4]), 2, [1.05, 0.9]),
        (linear([1.05, 0.9, 0.4]), 5, [1.05, 0.9, 0.4, np.nan, np.nan]),
        (linear([1.05, 0.9, 1e-4], np.eye(3)), 3, [1.05, 0.9, np.nan]),  # lost in rounding errors
    ],
)
def test_linear_models_have_the_logarithms_of_their_eigenvalues(model, exponents, rates):
    result = spectrum(model, np.zeros((2, 4, 3)), 600, exponents)
    expected = np.log([rates, rates]) / STEP
    np.testing.assert_allclose(result.exponents, expected, rtol=0, atol=1e-9)
    assert result.duration == pytest.approx(450 * STEP)


def test_equations_have_the_exponents_of_the_system_however_many_run_side_by_side(monkeypatch):
    washouts, system = lorenz_series(6, 10), Lorenz63()
    equations = EquationsFromTruth(system=system, time_step=0.01, sampling_stride=2)
    result = spectrum(equations, washouts, 4000)
    start = np.ascontiguousarray(washouts[:, -1].T)
    exponents_of_system = lyapunov_spectrum(Lorenz63(), start, 0.01, 6000, 10, alignment_steps=2000)
    assert result.duration == pytest.approx(exponents_of_system.duration)
    # the perturbations begin otherwise, and are lined up after the alignment
    np.testing.assert_allclose(result.exponents, exponents_of_system.exponents, rtol=0, atol=1e-6)
    together = spectrum(equations, washouts, 60).exponents
    monkeypatch.setattr(module, "RUNS_PER_BATCH", 4)
    np.testing.assert_array_equal(spectrum(equations, washouts, 60).exponents, together)
    assert spectrum(equations, washouts[:0], 60).exponents.shape == (0, 3)
    with pytest.raises(ValueError, match="too few"):
        spectrum(equations, washouts, 4)


def test_kinds_say_whether_they_linearise():
    kinds = {kind for kind in trajectory_kinds() if kind_class(kind).linearises()}
    assert {"esn", "equations", "equations_noisy", "quadratic"} <= kinds
    assert not {"analogues", "nvar", "persistence"} & kinds
    with pytest.raises(NotImplementedError, match="Persistence does not linearise"):
        spectrum(Persistence(), np.ones((1, 4, 3)), 60)


# -- summaries -------------------------------------------------------------------------------------
@pytest.mark.parametrize(
    ("exponents", "dimension"),
    [
        ([0.906, 0.0, -14.572], 2 + 0.906 / 14.572),
        ([1.0, 0.5, -0.7, -0.6, -5.0], 4 + 0.2 / 5.0),  # those of Hyperchaos: sum of four is 0.2
        ([0.0, 1.0, -4.0], 2.25),  # in any order
        ([-0.1, -0.2], 0.0),
        ([0.0, -1.0], 1.0),
        ([1.0, -0.5], np.nan),  # more than is known
        ([1.0, -0.5, np.nan], np.nan),
        ([1.0, -2.0, np.nan], 1.5),
        ([np.nan], np.nan),
    ],
)
def test_kaplan_yorke_dimension(exponents, dimension):
    result = kaplan_yorke_dimension(np.array(exponents))
    assert result == pytest.approx(dimension, nan_ok=True)


def test_summary_has_the_dimension_of_the_mean_and_its_spread():
    generator = np.random.default_rng(3)
    known = np.array([0.9, 0.0, -14.5])
    exponents = known + generator.normal(size=(200, 3)) * [0.3, 0.05, 0.3]
    result, (dimension, low, high) = summarise(exponents, 0.9, 2000, np.random.default_rng(1))
    np.testing.assert_allclose(result.mean, exponents.mean(axis=0))
    assert (result.low < result.mean).all()
    assert dimension == kaplan_yorke_dimension(exponents.mean(axis=0))
    # to first order the dimension is linear in the mean exponents
    samples = 2 + (exponents[:, 0] + exponents[:, 1]) / 14.5
    margin = 1.645 * samples.std() / np.sqrt(200)
    assert high - low == pytest.approx(2 * margin, rel=0.1)
    (first, of_first), (none, of_none) = (
        summarise(some, 0.95, 10, np.random.default_rng(1))
        for some in (known[np.newaxis], np.empty((0, 3)))
    )
    assert first.mean.tolist() == known.tolist()
    unknown = [*first.low, *first.high, *of_first[1:], *none.mean, *of_none]
    assert np.isnan(unknown).all()


# -- from series -----------------------------------------------------------------------------------


def estimate(series, interval):
    how = {"resamples": 200, "confidence": 0.95}
    return neighbour_divergence(series, interval, np.random.default_rng(0), **how)


class FourSpecies(Lorenz63):
    """Lotka-Volterra equations of Vano et al. (2006); their largest exponent is 0.0203."""

    dimension = 4
    growth = np.array([[1.0], [0.72], [1.53], [1.27]])
    competition = np.array(
        [[1, 1.09, 1.52, 0], [0, 1, 0.44, 1.36], [2.33, 0, 1, 0.47], [1.21, 0.51, 0.35, 1]]
    )

    def right_hand_side(self, state):
        return self.growth * state * (1 - self.competition @ state)


def test_lorenz_is_found_in_series_also_with_noise_and_of_one_component():
    series = lorenz_series(8, 2500)
    result = estimate(series, STEP)
    assert result.exponent == pytest.approx(0.906, rel=0.15)
    assert result.low < 0.906 < result.high
    assert result.high - result.low < 0.5 * result.exponent
    noise = 0.01 * series.std(axis=(0, 1)) * np.random.default_rng(2).normal(size=series.shape)
    assert estimate(series + noise, STEP).exponent == pytest.approx(0.906, rel=0.12)
    assert estimate(series[:, :, :1], STEP).exponent == pytest.approx(0.906, rel=0.12)


def test_weak_chaos_is_not_hidden_by_what_lies_along_the_flow():
    """By distances that are not taken across the flow, it is 0.015 (0.0144 to 0.0157)."""
    state = np.array([[0.301], [0.459], [0.131], [0.356]])
    start = state + 0.003 * 0.459 * np.random.default_rng(1).normal(size=(4, 10))
    series = integrate(FourSpecies(), start, 0.1, 10 * 2999, 10)[500:].transpose(2, 0, 1)
    result = estimate(series, 1.0)
    assert result.exponent == pytest.approx(0.0203, rel=0.15)
    assert result.low < 0.0203 < result.high


def test_growth_that_is_known():
    """A logistic curve above a floor, and how its rate follows from a curve that is bent."""
    steps, rate, first, saturated, floor = np.arange(121), 0.06, -4.0, 0.5, -4.5
    for power in neighbours.POWERS:
        grown = np.exp(rate * power * steps)
        share = np.exp(power * (first - saturated))
        distance = np.exp(saturated) * (share * grown / (1 + share * (grown - 1))) ** (1 / power)
        curve = 0.5 * np.log(distance**2 + np.exp(2 * floor))
        fit, sensitivity = neighbours._growth(curve, saturated, power)
        assert fit == pytest.approx(rate, rel=1e-4)
        bent = 1e-4 * np.sin(steps / 9)
        again, _ = neighbours._growth(curve + bent, saturated, power)
        assert again - fit == pytest.approx(bent @ sensitivity, rel=0.1)
        assert sensitivity[0] == 0  # neighbours were chosen by the first distance


def test_units_do_not_matter():
    series = lorenz_series(4, 1500)
    scaled = series * [1e-3, 50.0, 7.0] + [3.0, -100.0, 0.0]
    first, other = estimate(series, 0.02), estimate(scaled, 0.1)
    assert other.exponent == pytest.approx(first.exponent / 5, rel=1e-6)


@pytest.mark.parametrize(("number", "steps"), [(3, 150), (1, 300)])
def test_distances_by_brute_force(number, steps, monkeypatch):
    """In a short series alone, neighbours lie just beyond the Theiler window."""
    monkeypatch.setattr(neighbours, "REFERENCES", 10**6)  # every state is followed
    series = lorenz_series(number, steps)
    result = estimate(series, 0.02)
    states = series / series.std(axis=(0, 1))
    steps, window = len(result.log_distance) - 1, correlation_steps(states)
    starts, last = states.shape[1] - steps, states.shape[1] - 1
    assert result.theiler_window == window > 3
    places, expected = [*product(range(number), range(starts))], []
    for of, at in places:
        _, other, there = min(
            (np.linalg.norm(states[of, at] - states[other, step]), other, step)
            for other, step in places
            if other != of or abs(step - at) > window
        )
        logs = []
        for ahead in range(steps + 1):
            apart = states[of, at + ahead] - states[other, there + ahead]
            along = states[of, min(at + ahead + 1, last)] - states[of, max(at + ahead - 1, 0)]
            # by Pythagoras: the part along the flow is taken off
            projected = apart @ along / np.linalg.norm(along)
            logs.append(0.5 * np.log(apart @ apart - projected**2))
        expected.append(logs)
    np.testing.assert_allclose(result.log_distance, np.mean(expected, axis=0), rtol=1e-8)


def test_correlation_time_of_a_known_process():
    generator = np.random.default_rng(4)
    series = np.zeros((20, 4000, 1))
    for step in range(1, 4000):
        series[:, step] = 0.95 * series[:, step - 1] + generator.normal(size=(20, 1))
    assert correlation_steps(series) == pytest.approx(1 / -np.log(0.95), abs=2)
    assert correlation_steps(np.broadcast_to(np.arange(40.0)[:, None], (2, 40, 1))) <= 10


TIME = 0.05 * np.arange(1000) + np.linspace(0, 1.013, 5)[:, np.newaxis]
CIRCLES = np.stack([np.cos(TIME), np.sin(TIME)], axis=2)
TRENDS = np.linspace(0, 1, 241)[np.newaxis, :, np.newaxis] * np.arange(1.0, 25.0)[:, None, None]


@pytest.mark.parametrize(
    ("series", "message"),
    [
        (CIRCLES, "no exponent can be seen in these series"),
        (lorenz_series(1, 8), "no state has a neighbour"),
        # delays of a quarter of the series leave no sample, or one
        (TRENDS[:, :240], "too short beside their own correlation time"),
        (TRENDS, "too short beside their own correlation time"),
        (np.round(lorenz_series(8, 1600) / 4) * 4, r"\d+ of \d+ pairs .* are at distance 0"),
    ],
)
def test_what_does_not_part_or_is_too_coarse_has_no_exponent(series, message):
    with pytest.raises(NoExponentError, match=message):
        estimate(series, STEP)


def test_an_exponent_that_cannot_be_told_from_zero_is_none():
    messages = []
    for seed in range(5):
        walk = np.random.default_rng(seed).normal(size=(3, 90, 2)).cumsum(axis=1)
        with pytest.raises(NoExponentError) as refused:
            estimate(walk, 1.0)
        messages.append(str(refused.value))
    assert any(re.search(r"\(-.* to .*\), cannot be told from 0", first) for first in messages)


def autoregressive(factor, shape):
    noise = np.random.default_rng(8).normal(size=shape)
    for step in range(1, shape[1]):
        noise[:, step] += factor * noise[:, step - 1]
    return noise


@pytest.mark.parametrize(
    "series",
    [
        autoregressive(0.0, (4, 1000, 1)),
        autoregressive(0.99, (4, 1000, 3)),
        autoregressive(1.0, (4, 500, 2)),
        np.exp(0.5 * autoregressive(0.9, (8, 1500, 1))),
    ],
    ids=["white noise", "autoregressive", "random walk", "exponentials"],
)
def test_noise_has_no_exponent(series, monkeypatch):
    with pytest.raises(NoExponentError, match="as fast as those of noise"):
        estimate(series, 1.0)
    monkeypatch.setattr(neighbours, "LEAST_DEPARTURE", -np.inf)
    assert estimate(series, 1.0).low > 0  # the growth alone does not tell


@pytest.mark.parametrize("normal", [False, True])
def test_a_surrogate_is_noise_with_the_spectra_and_values_of_the_series(normal):
    first = autoregressive(0.9, (12, 4000, 1))
    series = np.concatenate([first, np.roll(first, 5, axis=1)], axis=2)  # five steps later
    result = surrogate(series, np.random.default_rng(1), normal=normal)
    np.testing.assert_array_equal(*(np.sort(a.reshape(-1, 2), axis=0) for a in (result, series)))
    for lag in (0, 1, 5, 20):
        before, after = slice(0, 4000 - lag), slice(lag, 4000)
        products = [np.einsum("nti,ntj->ij", a[:, after], a[:, before]) for a in (result, series)]
        np.testing.assert_allclose(*(first / 48000 for first in products), atol=0.5)
    assert abs(np.corrcoef(result[..., 0].ravel(), series[..., 0].ravel())[0, 1]) < 0.1
    # the odd moments in time of a deterministic series are gone
    lorenz = lorenz_series(4, 2000)
    noise = surrogate(lorenz, np.random.default_rng(1), normal=normal)
    rise = [np.diff(series[..., 2], axis=1) for series in (lorenz, noise)]
    skewness = [(first**3).mean() / first.std() ** 3 for first in rise]
    assert abs(skewness[0]) > 5 * abs(skewness[1])
