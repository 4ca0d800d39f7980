"""Numerical derivatives of a system's functions.

By complex steps, exact to rounding (Squire & Trapp, SIAM Rev. 40 (1998) 110), if the function does
with complex numbers what it does with real ones, and by central differences otherwise.
"""

import warnings
from collections.abc import Callable
from typing import Literal

import numpy as np

from burstcast.base.arrays import FloatArray

Method = Literal["complex step", "finite differences"]
Function = Callable[[FloatArray], FloatArray]

_COMPLEX_STEP = 1e-30
_DIFFERENCE = float(np.cbrt(np.finfo(np.float64).eps))
_PROBES = 8


def derivative_method(function: Function, dimension: int) -> Method:
    """Method by which a function of states ``(dimension, batch)`` is differentiated.

    Complex steps are taken if they agree with differences at some states: they go wrong where the
    function takes an absolute value, say, or puts its results into real arrays.
    """
    # both signs, and sizes from a tenth to three
    states = np.sin(np.arange(1.0, dimension * _PROBES + 1.0)).reshape(dimension, _PROBES)
    states *= np.linspace(0.1, 3.0, _PROBES)
    direction = np.cos(np.arange(1.0, dimension * _PROBES + 1.0)).reshape(dimension, _PROBES)
    try:
        with warnings.catch_warnings(), np.errstate(all="ignore"):
            warnings.simplefilter("ignore")
            by_step = derivative(function, states, direction, "complex step")
            by_difference = derivative(function, states, direction, "finite differences")
    except Exception:  # whatever the function does not do with complex numbers
        return "finite differences"
    finite = np.isfinite(by_difference)
    scale = np.abs(by_difference[finite]).max(initial=0.0)
    agree = np.abs(by_step - by_difference)[finite] <= 1e-6 * scale
    return "complex step" if finite.any() and agree.all() else "finite differences"


def derivative(
    function: Function, states: FloatArray, direction: FloatArray, method: Method
) -> FloatArray:
    """Directional derivative of a function of states, ``(dimension, ...)`` each."""
    if method == "complex step":
        moved = function(states + (1j * _COMPLEX_STEP) * direction)
        return np.asarray(np.imag(moved) / _COMPLEX_STEP)
    # differences along a vector as long as the state itself, however long the direction is
    length, size = (np.sqrt(np.sum(np.square(vectors), axis=0)) for vectors in (direction, states))
    step = _DIFFERENCE * np.maximum(size, 1e-3) / np.where(length > 0.0, length, 1.0)
    change = function(states + step * direction) - function(states - step * direction)
    return np.asarray(change / (2.0 * step))


def jacobian(function: Function, states: FloatArray, method: Method) -> FloatArray:
    """Jacobian of a function of states ``(dimension, ...)``: ``(outputs, dimension, ...)``."""
    columns = []
    for component in range(len(states)):
        direction = np.zeros_like(states)
        direction[component] = 1.0
        columns.append(derivative(function, states, direction, method))
    return np.stack(columns, axis=1)
