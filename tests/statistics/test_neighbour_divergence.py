"""The exponent from series against that from the equations, and against brute force."""

import re

import numpy as np
import pytest

from burstcast.data.dataset import generate_ensemble, initial_states
from burstcast.statistics import neighbour_divergence as module
from burstcast.statistics.neighbour_divergence import (
    NoExponentError,
    correlation_steps,
    neighbour_divergence,
)
from burstcast.systems.integration import integrate
from burstcast.systems.lorenz63 import Lorenz63
from burstcast.systems.mfe import MoehlisFaisstEckhardt


def lorenz(series=10, steps=4000):
    """Sampled every 0.02 time units; published exponent: 0.906."""
    generator = np.random.default_rng(1)
    start = generator.normal(size=(3, series)) + np.array([[0], [0], [25]])
    start = integrate(Lorenz63(), start, 0.01, 2000, stride=2000)[-1]
    return integrate(Lorenz63(), start, 0.01, 2 * steps, stride=2).transpose(2, 0, 1)


def estimate(series, interval, seed=0):
    how = {"resamples": 200, "confidence": 0.95}
    return neighbour_divergence(series, interval, np.random.default_rng(seed), **how)


def runge_kutta(rates, state, step, samples, stride):
    """Series ``(series, samples, component)`` by the classical method."""
    found = []
    for number in range(samples * stride):
        if number % stride == 0:
            found.append(state)
        one = rates(state)
        two = rates(state + step / 2 * one)
        three = rates(state + step / 2 * two)
        four = rates(state + step * three)
        state = state + step / 6 * (one + 2 * two + 2 * three + four)
    return np.stack(found).transpose(2, 0, 1)


def four_species():
    """Lotka-Volterra equations of Vano et al. (2006); their largest exponent is 0.0203."""
    growth = np.array([[1.0], [0.72], [1.53], [1.27]])
    competition = np.array(
        [[1, 1.09, 1.52, 0], [0, 1, 0.44, 1.36], [2.33, 0, 1, 0.47], [1.21, 0.51, 0.35, 1]]
    )
    start = np.array([[0.301], [0.459], [0.131], [0.356]])
    start = start * (1 + 0.01 * np.random.default_rng(1).normal(size=(4, 10)))

    def rates(state):
        return growth * state * (1 - competition @ state)

    return runge_kutta(rates, start, 0.1, 3000, 10)[:, 500:], 1.0


def bursting_neuron():
    """Hindmarsh-Rose equations: 0.0133 by brute force (two trajectories, 64 series)."""
    start = np.array([[-1.0], [0.0], [3.0]])
    start = start + 0.3 * np.random.default_rng(1).normal(size=(3, 10))

    def rates(state):
        x, y, z = state
        return np.stack(
            [y + 3 * x**2 - x**3 - z + 3.25, 1 - 5 * x**2 - y, 0.006 * (4 * (x + 1.6) - z)]
        )

    return runge_kutta(rates, start, 0.05, 4500, 10)[:, 500:], 0.5


def test_lorenz() -> None:
    found = estimate(lorenz(), 0.02)
    assert found.exponent == pytest.approx(0.906, rel=0.15)
    assert found.low < 0.906 < found.high
    assert found.high - found.low < 0.5 * found.exponent


def test_lorenz_with_noise_and_of_one_component() -> None:
    series = lorenz()
    noise = 0.01 * series.std(axis=(0, 1)) * np.random.default_rng(2).normal(size=series.shape)
    assert estimate(series + noise, 0.02).exponent == pytest.approx(0.906, rel=0.12)
    assert estimate(series[:, :, :1], 0.02).exponent == pytest.approx(0.906, rel=0.12)


@pytest.mark.parametrize(("series", "known"), [(four_species, 0.0203), (bursting_neuron, 0.0133)])
def test_weak_chaos_is_not_hidden_by_what_lies_along_the_flow(series, known) -> None:
    """By distances that are not taken across the flow, the first is 0.015 (0.0144 to 0.0157)."""
    found = estimate(*series())
    assert found.exponent == pytest.approx(known, rel=0.15)
    assert found.low < known < found.high


def test_growth_that_is_known() -> None:
    """A logistic curve above a floor, and how its rate follows from a curve that is bent."""
    steps, rate, first, saturated, floor = np.arange(121), 0.06, -4.0, 0.5, -4.5
    for power in module.POWERS:
        grown = np.exp(rate * power * steps)
        share = np.exp(power * (first - saturated))
        distance = np.exp(saturated) * (share * grown / (1 + share * (grown - 1))) ** (1 / power)
        curve = 0.5 * np.log(distance**2 + np.exp(2 * floor))
        fit = module._Growth.fitted(curve, saturated, power)
        assert fit.rate == pytest.approx(rate, rel=1e-4)
        bent = 1e-4 * np.sin(steps / 9)
        again = module._Growth.fitted(curve + bent, saturated, power)
        assert again.rate - fit.rate == pytest.approx(bent @ fit.sensitivity, rel=0.1)
        assert fit.sensitivity[0] == 0  # neighbours were chosen by the first distance


def test_one_long_series_keeps_out_of_its_own_neighbourhood() -> None:
    found = estimate(lorenz(series=1, steps=20000), 0.02)
    assert found.theiler_window > 3
    assert found.exponent == pytest.approx(0.906, rel=0.15)


def test_shear_flow() -> None:
    """Re = 400, whose published exponent is 0.0163."""
    start = [1, 0, 0.07066, -0.07076, 0, 0, 0, 0, 0]
    generator = np.random.default_rng(3)
    (flow,) = generate_ensemble(
        MoehlisFaisstEckhardt(400.0),
        initial_states(np.array(start, float), 3, 0.01, 16, generator),
        time_step=0.25,
        sampling_stride=4,
        transient_steps=800,
        kept_steps=10000,
        laminarisation_threshold=0.48,
    )
    assert len(flow.states) >= 10
    found = estimate(flow.states[:10], 1.0)
    assert found.exponent == pytest.approx(0.0163, rel=0.2)


def test_units_do_not_matter() -> None:
    series = lorenz(series=4, steps=1500)
    scaled = series * [1e-3, 50.0, 7.0] + [3.0, -100.0, 0.0]
    one, other = estimate(series, 0.02), estimate(scaled, 0.1)
    assert other.exponent == pytest.approx(one.exponent / 5, rel=1e-6)


@pytest.mark.parametrize(("number", "steps"), [(3, 240), (1, 400)])
def test_distances_by_brute_force(number, steps, monkeypatch) -> None:
    """In a short series alone, neighbours lie just beyond the Theiler window."""
    monkeypatch.setattr(module, "REFERENCES", 10**6)  # every state is followed
    series = lorenz(number, steps)
    found = estimate(series, 0.02)
    steps, window = len(found.log_distance) - 1, correlation_steps(series / series.std(axis=(0, 1)))
    states = series / series.std(axis=(0, 1))
    starts = states.shape[1] - steps
    expected = []
    for of in range(number):
        for at in range(starts):
            nearest = min(
                (np.linalg.norm(states[of, at] - states[other, step]), other, step)
                for other in range(number)
                for step in range(starts)
                if other != of or abs(step - at) > window
            )[1:]
            logs = []
            for ahead in range(steps + 1):
                before, after = max(at + ahead - 1, 0), min(at + ahead + 1, states.shape[1] - 1)
                apart = states[of, at + ahead] - states[nearest[0]][nearest[1] + ahead]
                along = states[of, after] - states[of, before]
                # by Pythagoras: the part along the flow is taken off
                projected = apart @ along / np.linalg.norm(along)
                logs.append(0.5 * np.log(apart @ apart - projected**2))
            expected.append(logs)
    np.testing.assert_allclose(found.log_distance, np.mean(expected, axis=0), rtol=1e-8)


def test_correlation_time_of_a_known_process() -> None:
    generator = np.random.default_rng(4)
    series = np.zeros((20, 4000, 1))
    for step in range(1, 4000):
        series[:, step] = 0.95 * series[:, step - 1] + generator.normal(size=(20, 1))
    assert correlation_steps(series) == pytest.approx(1 / -np.log(0.95), abs=2)
    assert correlation_steps(np.broadcast_to(np.arange(40.0)[:, None], (2, 40, 1))) <= 10


def test_what_does_not_part_has_no_exponent() -> None:
    time = 0.05 * np.arange(2000)
    phases = np.linspace(0, 1.013, 5)[:, None]
    circles = np.stack([np.cos(time + phases), np.sin(time + phases)], axis=2)
    with pytest.raises(NoExponentError, match="no exponent can be seen in these series"):
        estimate(circles, 0.05)
    with pytest.raises(NoExponentError, match="no state has a neighbour"):
        estimate(lorenz(series=1, steps=8), 0.02)


def test_coarse_readings_have_no_exponent() -> None:
    series = lorenz(series=8, steps=1600)
    with pytest.raises(NoExponentError, match=r"\d+ of \d+ pairs .* are at distance 0"):
        estimate(np.round(series / 4) * 4, 0.02)


def test_an_exponent_that_cannot_be_told_from_zero_is_none() -> None:
    walks = [np.random.default_rng(n).normal(size=(3, 90, 2)).cumsum(axis=1) for n in range(8)]
    refused = []
    for walk in walks:
        try:
            found = estimate(walk, 1.0)
            assert 0 < found.low < found.high
        except NoExponentError as error:
            refused.append(str(error))
    assert any(re.search(r"\(-.* to .*\), cannot be told from 0", one) for one in refused)
