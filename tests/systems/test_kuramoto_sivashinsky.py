"""The Kuramoto-Sivashinsky equation against the equation in space, and its published exponent."""

import re

import numpy as np
import pytest

from burstcast.systems.integration import integrate
from burstcast.systems.kuramoto_sivashinsky import KuramotoSivashinsky
from burstcast.systems.lyapunov import lyapunov_spectrum
from burstcast.systems.registry import make_system

POINTS = 128


def in_space(system, state):
    """u at points of the interval, from cosines and sines one by one."""
    x = 2 * np.pi * np.arange(POINTS) / POINTS
    k = np.arange(1, system.wavenumbers + 1)[:, np.newaxis]
    waves = np.concatenate([np.cos(k * x), np.sin(k * x)])
    return state @ waves


def derivative(u, length, order):
    k = 2 * np.pi / length * np.arange(POINTS // 2 + 1)
    return np.fft.irfft((1j * k) ** order * np.fft.rfft(u), POINTS)


@pytest.mark.parametrize("system", [KuramotoSivashinsky(), KuramotoSivashinsky(35.0, 24)])
def test_amplitudes_follow_the_equation_in_space(system):
    state = np.random.default_rng(0).normal(size=system.dimension)
    u = in_space(system, state)
    first, second, fourth = (derivative(u, system.length, order) for order in (1, 2, 4))
    rate = np.fft.rfft(-u * first - second - fourth)[1 : system.wavenumbers + 1] * 2 / POINTS
    expected = np.concatenate([rate.real, -rate.imag])
    scale = np.abs(expected).max()
    np.testing.assert_allclose(system.right_hand_side(state), expected, atol=1e-12 * scale)
    assert system.observable(state) == pytest.approx((u**2).mean() / 2)


def test_steps_are_of_fourth_order():
    system = KuramotoSivashinsky()
    start = integrate(system, system.sample_initial_states(2, np.random.default_rng(1)), 0.1, 500)
    errors = []
    exact = integrate(system, start[-1], 2.0 / 640, 640, 640)[-1]
    for steps in (20, 40):
        errors.append(np.abs(integrate(system, start[-1], 2.0 / steps, steps, steps)[-1] - exact))
    assert errors[0].max() < 1e-4
    assert errors[0].max() / errors[1].max() == pytest.approx(16, rel=0.5)


def test_the_leading_exponent_is_the_published_one():
    """0.048 on a length of 22 (Cvitanovic, Davidchack & Siminos 2010)."""
    system = make_system("kuramoto_sivashinsky", {})
    states = system.sample_initial_states(32, np.random.default_rng(0))
    states = integrate(system, states, 0.25, 800, 800)[-1]
    spectrum = lyapunov_spectrum(system, states, 0.25, 1200, 20, 200, exponents=1)
    leading = spectrum.exponents[:, 0]
    error = leading.std(ddof=1) / np.sqrt(len(leading))
    assert error < 0.004
    assert leading.mean() == pytest.approx(0.048, abs=2.5 * error + 0.001)


@pytest.mark.parametrize(("time_step", "number"), [(0.25, 24), (0.05, 24), (0.05, 20)])
def test_an_interval_that_is_too_long_is_told_at_once_with_one_that_is_not(time_step, number):
    system = KuramotoSivashinsky()
    states = system.sample_initial_states(4, np.random.default_rng(0))
    states = integrate(system, states, 0.25, 400, 400)[-1]
    every, told = 40, 0
    for _ in range(5):
        try:
            lyapunov_spectrum(system, states, time_step, 3 * every, every, exponents=number)
            break
        except ValueError as error:
            told += "is too long: the weakest direction is lost to rounding" in str(error)
            kept = int(re.search(r"compute (\d+) exponents", str(error))[1])
            shorter = re.search(r"orthonormalisation_interval\) to ([\d.]+)", str(error))
            if shorter and round(float(shorter[1]) / time_step) < every:
                every = round(float(shorter[1]) / time_step)
            else:
                number = kept
    else:
        pytest.fail("the advice does not end")
    assert told
