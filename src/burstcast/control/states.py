"""What all strategies do with flows: the flow without control, and what is read from states."""

import numpy as np

from burstcast.arrays import BoolArray, FloatArray, IntArray
from burstcast.control.timing import Clock
from burstcast.systems.base import DynamicalSystem
from burstcast.systems.integration import integrate


def stretches_ending_at(
    series: FloatArray, rows: IntArray, ends: IntArray, length: int
) -> FloatArray:
    """Stretches of series that end at each row's own step, ``(rows, length, dimension)``."""
    steps = ends[:, np.newaxis] + np.arange(1 - length, 1)
    return np.asarray(series[rows[:, np.newaxis], steps])


def observable_of(system: DynamicalSystem, states: FloatArray) -> FloatArray:
    """Observable of states with the components last, ``(flows, steps)``."""
    return system.observable(np.ascontiguousarray(states.transpose(2, 0, 1)))


def uncontrolled_flows(system: DynamicalSystem, washouts: FloatArray, timing: Clock) -> FloatArray:
    """Flows without control, ``(flows, timing.length, dimension)``, washouts included.

    Parameters
    ----------
    system
        The equations.
    washouts
        True states of the first washout, ``(flows, timing.washout, dimension)``.
    timing
        How long they go on.
    """
    steps = timing.counted_until - timing.first_forecast
    samples = integrate(
        system,
        np.ascontiguousarray(washouts[:, -1].T),
        timing.time_step,
        steps * timing.sampling_stride,
        stride=timing.sampling_stride,
    )
    return np.concatenate([washouts[:, :-1], samples.transpose(2, 0, 1)], axis=1)


def quiet_flows(uncontrolled: FloatArray, timing: Clock, threshold: float) -> BoolArray:
    """Tell which flows ``(flows, steps)`` stay below the threshold until their steps count."""
    return np.asarray((uncontrolled[:, : timing.counted_from + 1] < threshold).all(axis=1))


FLOWS_PER_BATCH = 1024
"""Flows that advance side by side: bounds the memory, changes no result."""


def flow_batches(flows: int) -> list[IntArray]:
    """Rows of the batches that flows are followed in; no flows at all are one empty batch."""
    most = FLOWS_PER_BATCH
    return [np.arange(start, min(start + most, flows)) for start in range(0, max(flows, 1), most)]


def check_given(
    system: DynamicalSystem,
    actuated_system: DynamicalSystem,
    washouts: FloatArray,
    timing: Clock,
    noise: FloatArray | None,
) -> None:
    """Check what flows are followed with.

    Raises
    ------
    ValueError
        If washouts or noise have the wrong shape, or the two systems different dimensions.
    """
    flows = len(washouts)
    if washouts.shape != (flows, timing.washout, system.dimension):
        raise ValueError(
            f"the washouts must have the shape (flows, {timing.washout}, {system.dimension}), "
            f"not {washouts.shape}"
        )
    if noise is not None and (
        noise.ndim != 3
        or (noise.shape[0], noise.shape[2]) != (flows, system.dimension)
        or noise.shape[1] < timing.length
    ):
        raise ValueError(
            f"the noise must have the shape ({flows}, {timing.length} or more, "
            f"{system.dimension}), not {noise.shape}"
        )
    if actuated_system.dimension != system.dimension:
        raise ValueError("the equations under actuation have another dimension")
