"""Time integration of whole ensembles by the classical fourth-order Runge-Kutta scheme.

Trajectories do not depend on one another, bit for bit: they may be integrated in any grouping.
"""

import dataclasses
from dataclasses import dataclass

import numpy as np

from burstcast.arrays import FloatArray
from burstcast.systems.base import DynamicalSystem

# Trajectories that are integrated together. So many that the cost of a numpy call is spread over
# many numbers, so few that the states and slopes of a nine-dimensional system stay in the cache.
_TILE = 2048


@dataclass(frozen=True)
class ObservedTrajectories:
    """Trajectories that were watched at every step of the integration.

    Attributes
    ----------
    states
        Kept states, ``(steps // stride + 1, dimension, batch)``; the first is the state at the
        end of the transient.
    largest_observable
        Largest value of the observable over every step since the end of the transient (that
        state included), whether the step was kept or not; ``(batch,)``.
    """

    states: FloatArray
    largest_observable: FloatArray


def step(system: DynamicalSystem, state: FloatArray, time_step: float) -> FloatArray:
    """One step of the fourth-order Runge-Kutta scheme; states of shape ``(dimension, ...)``."""
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


def integrate(
    system: DynamicalSystem,
    state: FloatArray,
    time_step: float,
    steps: int,
    stride: int = 1,
) -> FloatArray:
    """Integrate a batch of trajectories and keep every ``stride``-th state.

    Parameters
    ----------
    system
        The equations. A parameter may be an array over the batch, where the system allows it:
        then each trajectory has its own value.
    state
        Initial states, ``(dimension, batch)``.
    time_step
        Step of the scheme, in time units; positive.
    steps
        Number of steps; may be 0.
    stride
        Distance of the kept states in steps. Steps after the last kept state are not taken.

    Returns
    -------
    FloatArray
        ``(steps // stride + 1, dimension, batch)``; the first entry is the initial state.

    Raises
    ------
    ValueError
        If an argument has the wrong shape or sign, or an initial state is not finite.
    FloatingPointError
        If a trajectory leaves the range of floating-point numbers.
    """
    check_batch(system, state, time_step)
    _check_steps(steps, stride)
    batch = state.shape[1]
    states = np.empty((steps // stride + 1, *state.shape))
    for tile in _tiles(batch):
        current = np.array(state[:, tile], dtype=np.float64)
        tile_system = _with_parameters_of(system, tile, batch)
        states[0, :, tile] = current
        with np.errstate(over="ignore", invalid="ignore"):
            for kept in range(1, len(states)):
                for _ in range(stride):
                    current = step(tile_system, current, time_step)
                states[kept, :, tile] = current
        _check_finite(current, tile, time_step)
    return states


def integrate_observed(
    system: DynamicalSystem,
    state: FloatArray,
    time_step: float,
    steps: int,
    stride: int = 1,
    transient_steps: int = 0,
) -> ObservedTrajectories:
    """Integrate like `integrate`, drop a transient, and watch the observable at every step.

    A burst that peaks between two kept states is seen: this is how laminarisation is detected.

    Parameters
    ----------
    system, state, time_step, stride
        See `integrate`.
    steps
        Number of steps after the transient.
    transient_steps
        Number of steps before anything is kept or watched.

    Raises
    ------
    ValueError, FloatingPointError
        See `integrate`.
    """
    check_batch(system, state, time_step)
    _check_steps(steps, stride)
    if transient_steps < 0:
        raise ValueError(f"the transient must not be negative, not {transient_steps} steps")
    batch = state.shape[1]
    states = np.empty((steps // stride + 1, *state.shape))
    largest = np.empty(batch)
    for tile in _tiles(batch):
        current = np.array(state[:, tile], dtype=np.float64)
        tile_system = _with_parameters_of(system, tile, batch)
        with np.errstate(over="ignore", invalid="ignore"):
            for _ in range(transient_steps):
                current = step(tile_system, current, time_step)
            states[0, :, tile] = current
            largest_in_tile = tile_system.observable(current)
            for kept in range(1, len(states)):
                for _ in range(stride):
                    current = step(tile_system, current, time_step)
                    largest_in_tile = np.maximum(largest_in_tile, tile_system.observable(current))
                states[kept, :, tile] = current
        _check_finite(current, tile, time_step)
        largest[tile] = largest_in_tile
    return ObservedTrajectories(states=states, largest_observable=largest)


def _tiles(batch: int) -> list[slice]:
    return [slice(start, min(start + _TILE, batch)) for start in range(0, batch, _TILE)]


def _with_parameters_of(system: DynamicalSystem, tile: slice, batch: int) -> DynamicalSystem:
    """Cut the parameters that are arrays over the batch down to the trajectories of one tile."""
    if not dataclasses.is_dataclass(system):
        return system
    arrays = {
        field.name: getattr(system, field.name)
        for field in dataclasses.fields(system)
        if field.init and np.ndim(getattr(system, field.name)) > 0
    }
    if not arrays:
        return system
    cut = {name: np.broadcast_to(value, (batch,))[tile] for name, value in arrays.items()}
    return dataclasses.replace(system, **cut)


def check_batch(system: DynamicalSystem, state: FloatArray, time_step: float) -> None:
    """Raise ValueError unless a batch of states and a time step can be integrated."""
    if state.ndim != 2 or state.shape[0] != system.dimension:
        raise ValueError(
            f"states must have the shape ({system.dimension}, batch), not {state.shape}"
        )
    if not (time_step > 0.0 and np.isfinite(time_step)):
        raise ValueError(f"the time step must be positive and finite, not {time_step}")
    if not np.isfinite(state).all():
        raise ValueError("an initial state is not finite")


def _check_steps(steps: int, stride: int) -> None:
    if steps < 0:
        raise ValueError(f"the number of steps must not be negative, not {steps}")
    if stride < 1:
        raise ValueError(f"the stride must be at least one step, not {stride}")


def _check_finite(state: FloatArray, tile: slice, time_step: float) -> None:
    # Looking at the last state is enough: each step adds to the state, so what is once infinite
    # or NaN stays so.
    finite = np.isfinite(state).all(axis=0)
    if not finite.all():
        first = tile.start + int(np.argmin(finite))
        raise FloatingPointError(
            f"trajectory {first} left the range of floating-point numbers: "
            f"the time step {time_step} is too long, or the system has no bounded solution there"
        )
