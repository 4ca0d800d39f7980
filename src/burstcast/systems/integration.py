"""Time integration of whole ensembles by the classical fourth-order Runge-Kutta scheme.

In machine code where that can be made of the system's expressions (`burstcast.systems.compiled`),
by numpy otherwise, with identical bits. Trajectories do not depend on one another, bit for bit:
they may be integrated in any grouping.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from burstcast.base.arrays import ByteArray, FloatArray, IntArray
from burstcast.systems.base import DynamicalSystem
from burstcast.systems.compiled import CompiledSteps, compiled_steps
from burstcast.systems.runge_kutta import step

# Trajectories that numpy integrates together. So many that the cost of a numpy call is spread over
# many numbers, so few that the states and slopes of a nine-dimensional system stay in the cache.
_TILE = 2048
# Systems that are compiled into one program; more would take seconds to compile.
_MOST_COMPILED = 16


@dataclass(frozen=True)
class ObservedTrajectories:
    """Trajectories, and their largest observable over every step of the integration."""

    #: kept states, ``(steps // stride + 1, dimension, batch)``; the first is the state at the end
    #: of the transient
    states: FloatArray
    #: largest value of the observable over every step since the end of the transient (that state
    #: included), whether the step was kept or not; ``(batch,)``
    largest_observable: FloatArray


class LostTrajectoryError(FloatingPointError):
    """A trajectory left the range of floating-point numbers."""

    def __init__(self, trajectory: int, time_step: float) -> None:
        super().__init__(
            f"trajectory {trajectory} left the range of floating-point numbers: the time step "
            f"{time_step} (ensemble.time_step) is too long, or the system has no bounded solution "
            "there"
        )
        self.trajectory = trajectory


def integrate(
    system: DynamicalSystem,
    state: FloatArray,
    time_step: float,
    steps: int,
    stride: int = 1,
    *,
    may_diverge: bool = False,
) -> FloatArray:
    """Integrate a batch of trajectories and keep every ``stride``-th state.

    Parameters
    ----------
    system
        The equations.
    state
        Initial states, ``(dimension, batch)``.
    time_step
        Step of the scheme, in time units; positive.
    steps
        Number of steps; may be 0.
    stride
        Steps from one kept state to the next. Steps after the last kept state are not taken.
    may_diverge
        Whether trajectories may leave the range of floating-point numbers, as in a learnt system:
        they go on, infinite or not a number, and disturb no other trajectory.

    Returns
    -------
    FloatArray
        ``(steps // stride + 1, dimension, batch)``; the first entry is the initial state.

    Raises
    ------
    FloatingPointError
        If a trajectory leaves the range of floating-point numbers, unless it may.

    Examples
    --------
    >>> import numpy as np
    >>> from burstcast.systems.integration import integrate
    >>> from burstcast.systems.lorenz63 import Lorenz63
    >>> start = np.array([[1.0, 2.0], [1.0, 2.0], [20.0, 20.0]])
    >>> states = integrate(Lorenz63(), start, 0.01, 100, stride=10)
    >>> states.shape
    (11, 3, 2)
    """
    check_batch(system, state, time_step, may_diverge=may_diverge)
    _check_steps(steps, stride)
    states = _room(state, steps, stride)
    compiled = _compiled([system], time_step)
    if compiled is not None:
        compiled.run(states, stride)
    else:
        for tile in _tiles(state.shape[1]):
            _fill(system, states[..., tile], time_step, stride)
    if not may_diverge:
        _check_finite(states[-1], time_step)
    return states


def integrate_switched(
    systems: Sequence[DynamicalSystem],
    choice: ByteArray | IntArray,
    state: FloatArray,
    time_step: float,
    stride: int = 1,
    *,
    may_diverge: bool = False,
) -> FloatArray:
    """Integrate like `integrate`, each step of a trajectory under one of several systems.

    ``systems``: Equations of one dimension; up to 16 are compiled. ``choice``: Number of the system
    that each step obeys, ``(steps, batch)``.
    """
    for system in systems:
        check_batch(system, state, time_step, may_diverge=may_diverge)
    if choice.ndim != 2 or choice.shape[1] != state.shape[1]:
        raise ValueError(
            f"the choice must have the shape (steps, {state.shape[1]}), not {choice.shape}"
        )
    if not np.issubdtype(choice.dtype, np.integer):
        raise ValueError(f"the choice must be numbers of systems, not of type {choice.dtype}")
    if choice.size and not 0 <= choice.min() <= choice.max() < len(systems):
        raise ValueError(f"the choice must be between systems 0 to {len(systems) - 1}")
    _check_steps(len(choice), stride)
    states = _room(state, len(choice), stride)
    compiled = _compiled(systems, time_step) if len(systems) <= _MOST_COMPILED else None
    if compiled is not None:
        compiled.run(states, stride, choice=np.ascontiguousarray(choice, dtype=np.uint8))
    else:
        _fill_switched(systems, choice, states, time_step, stride)
    if not may_diverge:
        _check_finite(states[-1], time_step)
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
    """
    check_batch(system, state, time_step)
    _check_steps(steps, stride)
    if transient_steps < 0:
        raise ValueError(f"the transient must not be negative, not {transient_steps} steps")
    developed = integrate(system, state, time_step, transient_steps, stride=max(transient_steps, 1))
    states = _room(developed[-1], steps, stride)
    largest = np.array(system.observable(states[0]), order="C")
    compiled = _compiled([system], time_step, observed=True)
    if compiled is not None:
        compiled.run(states, stride, largest=largest)
    else:
        for tile in _tiles(state.shape[1]):
            _fill(system, states[..., tile], time_step, stride, largest[tile])
    _check_finite(states[-1], time_step)
    return ObservedTrajectories(states=states, largest_observable=largest)


def _room(state: FloatArray, steps: int, stride: int) -> FloatArray:
    """Array of the states to be kept, whose first entry is the initial state."""
    states = np.empty((steps // stride + 1, *state.shape))
    states[0] = state
    return states


def _compiled(
    systems: Sequence[DynamicalSystem], time_step: float, *, observed: bool = False
) -> CompiledSteps | None:
    try:
        return compiled_steps(tuple(systems), time_step, observed)
    except TypeError:  # a system without a hash
        return None


def _fill(
    system: DynamicalSystem,
    states: FloatArray,
    time_step: float,
    stride: int,
    largest_observable: FloatArray | None = None,
) -> None:
    """Integrate by numpy from the first entry on, and keep the largest observable up to date."""
    current = states[0].copy()
    with np.errstate(over="ignore", invalid="ignore"):
        for kept in range(1, len(states)):
            for _ in range(stride):
                current = step(system, current, time_step)
                if largest_observable is not None:
                    np.maximum(
                        largest_observable, system.observable(current), out=largest_observable
                    )
            states[kept] = current


def _fill_switched(
    systems: Sequence[DynamicalSystem],
    choice: ByteArray | IntArray,
    states: FloatArray,
    time_step: float,
    stride: int,
) -> None:
    """Integrate by numpy, each step under the system of its number."""
    current = states[0].copy()
    with np.errstate(over="ignore", invalid="ignore"):
        for index in range((len(states) - 1) * stride):
            following = np.empty_like(current)
            for number in np.unique(choice[index]):
                members = choice[index] == number
                following[:, members] = step(systems[number], current[:, members], time_step)
            current = following
            if (index + 1) % stride == 0:
                states[(index + 1) // stride] = current


def _tiles(batch: int) -> Iterator[slice]:
    for start in range(0, batch, _TILE):
        yield slice(start, min(start + _TILE, batch))


def check_batch(
    system: DynamicalSystem, state: FloatArray, time_step: float, *, may_diverge: bool = False
) -> None:
    """Raise ValueError unless a batch of states and a time step can be integrated."""
    if not isinstance(state, np.ndarray):
        raise TypeError(f"states must be an array, not {type(state).__name__}")
    if state.ndim != 2 or state.shape[0] != system.dimension:
        raise ValueError(
            f"states must have the shape ({system.dimension}, batch), not {state.shape}"
        )
    if not (time_step > 0.0 and np.isfinite(time_step)):
        raise ValueError(f"the time step must be positive and finite, not {time_step}")
    if not (may_diverge or np.isfinite(state).all()):
        raise ValueError("an initial state is not finite")


def _check_steps(steps: int, stride: int) -> None:
    if steps < 0:
        raise ValueError(f"the number of steps must not be negative, not {steps}")
    if stride < 1:
        raise ValueError(f"the stride must be at least one step, not {stride}")


def _check_finite(state: FloatArray, time_step: float) -> None:
    # The last state is enough: each step adds to the state, so that an infinity or NaN remains.
    finite = np.isfinite(state).all(axis=0)
    if not finite.all():
        raise LostTrajectoryError(int(np.argmin(finite)), time_step)
