"""The classical fourth-order Runge-Kutta scheme, one step of it."""

from burstcast.arrays import FloatArray
from burstcast.systems.base import DynamicalSystem, has_own


def step(system: DynamicalSystem, state: FloatArray, time_step: float) -> FloatArray:
    """One integration step; states of shape ``(dimension, ...)``.

    Of the fourth-order Runge-Kutta scheme, unless the system has an integrator of its own.
    """
    if has_own(system, "flow_map"):
        return system.flow_map(state, time_step)
    slope_1 = system.right_hand_side(state)
    slope_2 = system.right_hand_side(state + (0.5 * time_step) * slope_1)
    slope_3 = system.right_hand_side(state + (0.5 * time_step) * slope_2)
    slope_4 = system.right_hand_side(state + time_step * slope_3)
    return combine(state, slope_1, slope_2, slope_3, slope_4, time_step)


def combine(
    state: FloatArray,
    slope_1: FloatArray,
    slope_2: FloatArray,
    slope_3: FloatArray,
    slope_4: FloatArray,
    time_step: float,
) -> FloatArray:
    """Last stage of the scheme: state + time_step / 6 (slope_1 + 2 slope_2 + 2 slope_3 + slope_4).

    Public because the tangent dynamics (`burstcast.systems.lyapunov`) is the same scheme applied
    to the linearised equations, and has to follow the very trajectory that `integrate` yields.
    """
    increment = slope_2 + slope_3
    increment *= 2.0
    increment += slope_1
    increment += slope_4
    increment *= time_step / 6.0
    increment += state
    return increment
