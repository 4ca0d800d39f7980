"""One step of the classical fourth-order Runge-Kutta scheme.

Right-hand sides are given states whose small whole powers, ``x**3``, are products. Numpy computes a
power by a function, whose last digit depends on the processor; a product has the same bits
everywhere, and can be compiled (`burstcast.systems.compiled`).
"""

from functools import lru_cache
from typing import Any

import numpy as np

from burstcast.base.arrays import FloatArray
from burstcast.systems.base import DynamicalSystem, has_own

LARGEST_POWER = 16
"""Largest whole power that is computed by products."""


def whole_power(base: Any, exponent: object) -> Any:
    """Power by products; ``NotImplemented`` unless the exponent is whole and small."""
    if not isinstance(exponent, int | float) or exponent not in range(2, LARGEST_POWER + 1):
        return NotImplemented
    product = base * base
    for _ in range(int(exponent) - 2):
        product = product * base
    return product


class _States(np.ndarray[Any, Any]):
    """Array whose small whole powers are products, and which counts them; slower than others."""

    powers_taken = 0

    def __pow__(self, exponent: Any, modulus: None = None) -> Any:
        power = whole_power(self, exponent)
        _States.powers_taken += exponent != 2  # numpy itself squares by a product
        return super().__pow__(exponent) if power is NotImplemented else power


@lru_cache(maxsize=64)
def _takes_powers(system: DynamicalSystem) -> bool:
    """Whether a right-hand side takes other powers than squares."""
    before = _States.powers_taken
    with np.errstate(all="ignore"):
        system.right_hand_side(np.ones((system.dimension, 1)).view(_States))
    return _States.powers_taken > before


def step(system: DynamicalSystem, state: FloatArray, time_step: float) -> FloatArray:
    """One step of the Runge-Kutta scheme, or of the system's integrator, ``(dimension, ...)``."""
    if has_own(system, "flow_map"):
        return system.flow_map(state, time_step)
    if state.dtype != object:  # symbols have powers of their own
        try:
            takes_powers = _takes_powers(system)
        except TypeError:  # a system without a hash
            takes_powers = True
        state = state.view(_States) if takes_powers else state
    slope_1 = system.right_hand_side(state)
    slope_2 = system.right_hand_side(state + (0.5 * time_step) * slope_1)
    slope_3 = system.right_hand_side(state + (0.5 * time_step) * slope_2)
    slope_4 = system.right_hand_side(state + time_step * slope_3)
    return np.asarray(combine(state, slope_1, slope_2, slope_3, slope_4, time_step))


def combine(
    state: FloatArray,
    slope_1: FloatArray,
    slope_2: FloatArray,
    slope_3: FloatArray,
    slope_4: FloatArray,
    time_step: float,
) -> FloatArray:
    """Last stage: state + time_step / 6 (slope_1 + 2 slope_2 + 2 slope_3 + slope_4)."""
    increment = slope_2 + slope_3
    increment *= 2.0
    increment += slope_1
    increment += slope_4
    increment *= time_step / 6.0
    increment += state
    return increment
