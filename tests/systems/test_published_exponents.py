"""Lyapunov exponents of classical systems against those of others, from right-hand sides alone.

Published by J. C. Sprott, who computed them by another method and program. The sum of the exponents
is the mean divergence, which of all but one of these systems is a number that one reads off the
equations.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
import pytest

from burstcast.arrays import FloatArray
from burstcast.systems.base import DynamicalSystem
from burstcast.systems.integration import integrate
from burstcast.systems.lyapunov import lyapunov_spectrum, mean_with_interval, perturbation_growth

TRAJECTORIES = 24

BOOK = "J. C. Sprott, Chaos and Time-Series Analysis, Oxford University Press (2003), appendix A"
SIMPLE_FLOWS = "J. C. Sprott, Some simple chaotic flows, Phys. Rev. E 50, R647 (1994), table I"


@dataclass(frozen=True)
class Equations(DynamicalSystem):
    """Three equations, given as a function; no Jacobian."""

    rates: Callable[[FloatArray, FloatArray, FloatArray], tuple]

    dimension: ClassVar[int] = 3
    observable_name: ClassVar[str] = "x"
    observable_symbol: ClassVar[str] = "x"

    def right_hand_side(self, state: FloatArray) -> FloatArray:
        derivative = np.empty_like(state)
        for row, rate in enumerate(self.rates(*state)):
            derivative[row] = rate
        return derivative

    def observable(self, state: FloatArray) -> FloatArray:
        return np.array(state[0])


@dataclass(frozen=True)
class Published:
    """A classical system: its equations, where it starts, a time step, and published exponents.

    Of the simple flows, three digits of the leading exponent are published; the last is what is
    missing to the divergence.
    """

    rates: Callable
    start: tuple[float, float, float]
    time_step: float
    leading: float
    divergence: float | None
    last: float
    source: str = BOOK


SYSTEMS = {
    "Lorenz": Published(
        lambda x, y, z: (10 * (y - x), x * (28 - z) - y, x * y - 8 / 3 * z),
        (1.0, 1.0, 20.0),
        0.01,
        0.9056,
        -41 / 3,
        -14.5723,
    ),
    "Roessler": Published(
        lambda x, y, z: (-y - z, x + 0.2 * y, 0.2 + z * (x - 5.7)),
        (-9.0, 0.0, 0.0),
        0.03,
        0.0714,
        None,
        -5.3943,
    ),
    "Thomas": Published(
        lambda x, y, z: (np.sin(y) - 0.18 * x, np.sin(z) - 0.18 * y, np.sin(x) - 0.18 * z),
        (0.1, 0.0, 0.0),
        0.1,
        0.0349,
        -0.54,
        -0.5749,
    ),
    "Halvorsen": Published(
        lambda x, y, z: (
            -1.27 * x - 4 * y - 4 * z - y * y,
            -1.27 * y - 4 * z - 4 * x - z * z,
            -1.27 * z - 4 * x - 4 * y - x * x,
        ),
        (-5.0, 0.0, 0.0),
        0.01,
        0.7899,
        -3.81,
        -4.5999,
    ),
    "Sprott B": Published(
        lambda x, y, z: (y * z, x - y, 1 - x * y),
        (0.05, 0.05, 0.05),
        0.05,
        0.210,
        -1.0,
        -1.210,
        SIMPLE_FLOWS,
    ),
    "Sprott C": Published(
        lambda x, y, z: (y * z, x - y, 1 - x * x),
        (0.05, 0.05, 0.05),
        0.05,
        0.163,
        -1.0,
        -1.163,
        SIMPLE_FLOWS,
    ),
    "Chen": Published(
        lambda x, y, z: (35 * (y - x), -7 * x - x * z + 28 * y, x * y - 3 * z),
        (-10.0, 0.0, 37.0),
        0.004,
        2.0272,
        -10.0,
        -12.0272,
    ),
}


@pytest.mark.long
@pytest.mark.parametrize("name", SYSTEMS)
def test_exponents_are_the_published_ones(name: str) -> None:
    published = SYSTEMS[name]
    system = Equations(published.rates)
    generator = np.random.default_rng(11)
    start = np.repeat(np.array(published.start)[:, np.newaxis], TRAJECTORIES, axis=1)
    start += 1e-2 * generator.standard_normal(start.shape)
    # until neighbours have forgotten one another, and for some thousand Lyapunov times in all
    settle = round(25 / published.leading / published.time_step)
    steps = round(120 / published.leading / published.time_step)
    states = integrate(system, start, published.time_step, settle, settle)[-1]
    interval = max(1, round(0.2 / abs(published.last) / published.time_step))
    spectrum = lyapunov_spectrum(
        system, states, published.time_step, steps, interval, alignment_steps=steps // 4
    ).exponents
    found = mean_with_interval(spectrum, 0.999)
    margin = (found.high - found.low)[0] / 2
    assert margin < 0.1 * published.leading
    assert abs(found.mean[0] - published.leading) < margin + 0.005 * published.leading
    assert abs(found.mean[1]) < 0.05 * published.leading
    assert abs(found.mean[2] - published.last) < margin + 0.005 * abs(published.last)
    if published.divergence is not None:
        np.testing.assert_allclose(spectrum.sum(axis=1), published.divergence, rtol=1e-3)
    growth = perturbation_growth(
        system, states, published.time_step, steps, 1e-8, 1e-4, generator, steps // 4
    )
    assert growth.exponents.mean() == pytest.approx(found.mean[0], abs=margin)
