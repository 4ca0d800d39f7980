"""The Kuramoto-Sivashinsky equation against the equation in space, and its published exponents."""

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


PUBLISHED = [0.048, 0.0, 0.0, -0.003, -0.189, -0.256, -0.290, -0.310, -1.963, -1.967]
"""Largest exponents on a length of 22 (Cvitanovic, Davidchack & Siminos 2010, section 2)."""


@pytest.mark.parametrize(
    ("number", "members", "steps", "allowed"),
    [
        (1, 32, 1200, 0.001),
        (10, 6, 400, 0.03),
        # neutral directions settle slowly
        pytest.param(10, 32, 2000, 0.005, marks=pytest.mark.long),
    ],
)
def test_exponents_are_the_published_ones(number, members, steps, allowed):
    system = make_system("kuramoto_sivashinsky", {})
    states = system.sample_initial_states(members, np.random.default_rng(0))
    states = integrate(system, states, 0.25, 800, 800)[-1]
    found = lyapunov_spectrum(system, states, 0.25, steps, 10, 200, exponents=number).exponents
    error = found.std(axis=0, ddof=1) / np.sqrt(members)
    assert error.max() < 0.02
    assert np.all(np.abs(found.mean(axis=0) - PUBLISHED[:number]) < 3 * error + allowed)


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
