"""Semilinear systems, whose linear part may be stiff: an exponential Runge-Kutta scheme.

Source: S. M. Cox, P. C. Matthews, "Exponential time differencing for stiff systems", J. Comput.
Phys. 176 (2002) 430 (ETDRK4), with the coefficients as contour integrals of A.-K. Kassam, L. N.
Trefethen, SIAM J. Sci. Comput. 26 (2005) 1214.
"""

import abc
from collections.abc import Sequence
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from burstcast.base.arrays import FloatArray
from burstcast.systems.base import DynamicalSystem
from burstcast.systems.forced import ForcedSystem

_CONTOUR_POINTS = 32


class SemilinearSystem(DynamicalSystem):
    """du_i/dt = rate_i u_i + nonlinear_i(u): each component has a linear rate of its own.

    A partial differential equation is like this in the amplitudes of its modes, sines and cosines
    apart. A subclass says `linear_rates` and `nonlinear`.
    """

    @abc.abstractmethod
    def linear_rates(self) -> FloatArray:
        """Linear rates, ``(dimension,)``: negative ones damp."""

    @abc.abstractmethod
    def nonlinear(self, state: FloatArray) -> FloatArray:
        """All that is not linear, ``(dimension, ...)``."""

    def right_hand_side(self, state: FloatArray) -> FloatArray:
        """Time derivative of the state; both of shape ``(dimension, ...)``."""
        rates = self.linear_rates().reshape((-1,) + (1,) * (state.ndim - 1))
        return rates * state + self.nonlinear(state)

    def flow_map(self, state: FloatArray, time_step: float) -> FloatArray:
        """State one step of ETDRK4 later, both of shape ``(dimension, ...)``."""
        rates = tuple(map(float, self.linear_rates()))
        shape = (-1,) + (1,) * (state.ndim - 1)
        c = _Coefficients(*[part.reshape(shape) for part in _coefficients(rates, time_step)])
        now = self.nonlinear(state)
        half = c.half_decay * state
        a = half + c.half_step * now
        of_a = self.nonlinear(a)
        b = half + c.half_step * of_a
        of_b = self.nonlinear(b)
        last = c.half_decay * a + c.half_step * (2.0 * of_b - now)
        of_last = self.nonlinear(last)
        return c.decay * state + c.first * now + 2.0 * c.middle * (of_a + of_b) + c.last * of_last

    def forced(self, force: Sequence[float]) -> DynamicalSystem:
        """The system with a constant force, by the same scheme."""
        return _ForcedSemilinearSystem(self, force)


class _ForcedSemilinearSystem(ForcedSystem, SemilinearSystem):
    """A semilinear system with a force, which its scheme treats as a part of `nonlinear`."""

    _system: SemilinearSystem

    def linear_rates(self) -> FloatArray:
        """Linear rates of the system, which the force does not change."""
        return self._system.linear_rates()

    def nonlinear(self, state: FloatArray) -> FloatArray:
        """All that is not linear, the force included, ``(dimension, ...)``."""
        return self._with_force(self._system.nonlinear(state))


class _Coefficients(NamedTuple):
    decay: FloatArray
    half_decay: FloatArray
    half_step: FloatArray
    first: FloatArray
    middle: FloatArray
    last: FloatArray


@lru_cache(maxsize=16)
def _coefficients(rates: tuple[float, ...], time_step: float) -> _Coefficients:
    """Coefficients of a step; means over a circle around each rate, where nothing cancels."""
    scaled = time_step * np.array(rates)
    circle = np.exp(1j * np.pi * (np.arange(1, _CONTOUR_POINTS + 1) - 0.5) / _CONTOUR_POINTS)
    z = scaled[:, np.newaxis] + circle
    mean = [
        (np.exp(z / 2) - 1) / z,
        (-4 - z + np.exp(z) * (4 - 3 * z + z**2)) / z**3,
        (2 + z + np.exp(z) * (-2 + z)) / z**3,
        (-4 - 3 * z - z**2 + np.exp(z) * (4 - z)) / z**3,
    ]
    half_step, first, middle, last = (time_step * part.mean(axis=1).real for part in mean)
    return _Coefficients(np.exp(scaled), np.exp(scaled / 2), half_step, first, middle, last)
