"""Exogenous inputs of forecasters: parameters in force, or columns of a record known in advance.

Inputs are further components of the arrays that forecasters are given, for kinds that use them:

* of series, ``(series, time, dimension + inputs)``. The inputs of a sample are those in force on
  the way to it; of the first sample they have no meaning.
* of washouts, ``(steps, dimension + inputs, batch)``. After the present sample, rows with states of
  NaN may follow: their inputs are in force over the forecast.
* of memories, whose last rows are then the inputs of the steps to come (`carry`).

A *schedule* is an array of the inputs alone, in force from each state to the next; like states, it
has its time first, the inputs in the middle and the batch last.
"""

import numpy as np

from burstcast.base.arrays import FloatArray


def with_inputs(states: FloatArray, inputs: FloatArray) -> FloatArray:
    """Series with their inputs, ``(series, 1 + steps, dimension + inputs)``.

    ``states``: ``(series, time, dimension)``. ``inputs``: In force from each state to the next,
    and, after the last state, over a forecast, ``(series, steps, inputs)``.

    Examples
    --------
    >>> with_inputs(np.zeros((1, 2, 1)), np.array([[[5.0], [6.0]]]))[0].tolist()
    [[0.0, 5.0], [0.0, 5.0], [nan, 6.0]]
    """
    series, time, dimension = states.shape
    if len(inputs) != series or inputs.shape[1] < time - 1:
        raise ValueError(
            f"{series} series of {time} samples need inputs of the shape ({series}, {time - 1} or "
            f"more, inputs), not {inputs.shape}"
        )
    together = np.full((series, 1 + inputs.shape[1], dimension + inputs.shape[2]), np.nan)
    together[:, :time, :dimension] = states
    together[:, 1:, dimension:] = inputs
    together[:, 0, dimension:] = inputs[:, 0]
    return together


def of_series(series: FloatArray, dimension: int) -> tuple[FloatArray, FloatArray]:
    """States of series, and their inputs from each sample to the next (see `with_inputs`)."""
    if series.shape[2] == dimension:
        return series, np.empty((len(series), series.shape[1] - 1, 0))
    states, inputs = series[..., :dimension], series[:, 1:, dimension:]
    return np.ascontiguousarray(states), np.ascontiguousarray(inputs)


def of_washout(washout: FloatArray, dimension: int) -> tuple[FloatArray, FloatArray, FloatArray]:
    """States of a washout, its schedule, and the one of the forecast, without inputs empty."""
    steps = len(washout)
    if washout.shape[1] > dimension:
        unknown = np.isnan(washout[:, :dimension]).all(axis=1)  # (steps, batch)
        steps -= int(np.count_nonzero(np.any(unknown, axis=1)))
    states = np.ascontiguousarray(washout[:steps, :dimension])
    return states, washout[1:steps, dimension:], washout[steps:, dimension:]


def up_to_sample(series: FloatArray, samples: int, inputs: int) -> FloatArray:
    """First samples of series; of the others, the inputs alone.

    ``series``: ``(series, time, dimension + inputs)``. ``inputs``: Number of inputs; without any,
    nothing is left of the other samples.
    """
    if not inputs:
        return series[:, :samples]
    washouts = series.copy()
    washouts[:, samples:, :-inputs] = np.nan
    return washouts


def carry(memory: FloatArray, schedule: FloatArray) -> FloatArray:
    """Memory that goes on under a schedule, which `of_memory` takes from it.

    ``memory``: ``(size, batch)``. ``schedule``: ``(steps, inputs, batch)``. Both may have the
    members of an ensemble before the batch.
    """
    if not schedule.size:
        return memory
    return np.concatenate([memory, schedule.reshape(-1, *schedule.shape[2:])])


def of_memory(
    memory: FloatArray, size: int, inputs: int, steps: int
) -> tuple[FloatArray, FloatArray | None, FloatArray]:
    """Memory without inputs, its schedule of the next steps, and the one after them.

    ``size``: Rows of the memory without inputs. A memory that carries no inputs has no schedule.
    """
    ahead = (len(memory) - size) // inputs
    schedule = memory[size:].reshape(ahead, inputs, memory.shape[-1])
    if not ahead:
        return memory, None, schedule
    if ahead < steps:
        raise ValueError(f"inputs over {ahead} steps are given, but {steps} are forecast")
    return memory[:size], schedule[:steps], schedule[steps:]
