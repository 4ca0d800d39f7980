"""Forecasts by all members of an ensemble: equally likely states, or pasts like the present one.

An ensemble filter tells not only an estimate of the present state but, by the scatter of its
members, what else may be true (`burstcast.filters.filtered`); analogues differ in what followed
them. The share of the members whose forecast has an event is a probability, as the share of a
committee of networks is (`burstcast.probability.votes`).
"""

from collections.abc import Callable
from typing import Protocol

import numpy as np

from burstcast.arrays import FloatArray, IntArray
from burstcast.forecast.windows import WindowSummaries, summarise
from burstcast.forecasters.base import ForecastingCase
from burstcast.probability.out_of_sample import Learner, without_series

TRAJECTORIES_PER_BATCH = 2048
"""Forecasts of members that run side by side: bounds the memory, changes no result."""


class EnsembleForecaster(Learner, Protocol):
    """A forecaster that tells an ensemble of memories, not one of them only."""

    def ensemble(self, washout: FloatArray) -> FloatArray:
        """Memories of all members, ``(..., members, batch)``, after an observed washout."""

    def advance(self, memory: FloatArray, steps: int) -> tuple[FloatArray, FloatArray]:
        """Forecast the next steps (`burstcast.forecasters.base.Forecaster.advance`)."""


def has_members(kind: type) -> bool:
    """Whether forecasters of a class tell an ensemble."""
    return hasattr(kind, "ensemble")


def member_forecasts(forecaster: EnsembleForecaster, washout: FloatArray, steps: int) -> FloatArray:
    """Forecast with every member.

    Parameters
    ----------
    forecaster
        Who forecasts.
    washout
        Observed states up to the starting points, ``(steps, dimension, batch)``.
    steps
        Steps of the forecast.

    Returns
    -------
    States, ``(steps, dimension, members, batch)``.
    """
    memory = forecaster.ensemble(washout)
    *rest, members, batch = memory.shape
    # analogues have one number for each member, and a member of one analogue
    flat = np.ascontiguousarray(memory.reshape(*rest, members * batch))
    outputs, _ = forecaster.advance(flat, steps)
    return outputs.reshape(*outputs.shape[:2], members, batch)


def member_summaries(
    forecaster: EnsembleForecaster,
    observable: Callable[[FloatArray], FloatArray],
    washouts: FloatArray,
    boundaries: tuple[int, ...],
) -> list[WindowSummaries]:
    """Window summaries of the forecasts of each member.

    Parameters
    ----------
    forecaster
        Who forecasts.
    observable
        From states ``(dimension, ...)`` to the observable ``(...)``.
    washouts
        Observed states up to each starting point, ``(points, steps, dimension)``.
    boundaries
        Of the windows (`burstcast.forecast.windows.window_boundaries`).

    Returns
    -------
    Of each member, ``(points, windows)``. A forecast that is no longer finite crosses nothing.
    """
    members = forecaster.ensemble(washouts[:1].transpose(1, 2, 0)).shape[-2]
    points = max(1, TRAJECTORIES_PER_BATCH // members)
    batches: list[WindowSummaries] = []
    for start in range(0, len(washouts), points):
        washout = np.ascontiguousarray(washouts[start : start + points].transpose(1, 2, 0))
        states = member_forecasts(forecaster, washout, boundaries[-1])
        with np.errstate(over="ignore", invalid="ignore"):
            values = observable(states.transpose(1, 0, 2, 3))
        batches.append(summarise(values.reshape(len(values), -1), boundaries))
    shape = members, -1, len(boundaries) - 1
    first, largest = (
        np.concatenate([getattr(batch, name).reshape(shape) for batch in batches], axis=1)
        for name in ("first", "largest")
    )
    return [WindowSummaries(*pair) for pair in zip(first, largest, strict=True)]


def leave_one_out_member_summaries(
    forecaster: EnsembleForecaster,
    training: FloatArray,
    case: ForecastingCase,
    washout: int,
    observable: Callable[[FloatArray], FloatArray],
    washouts: FloatArray,
    series: IntArray,
    boundaries: tuple[int, ...],
) -> list[WindowSummaries]:
    """Forecast from points in the training series, without what their series have taught.

    Parameters are those of `burstcast.probability.out_of_sample.leave_one_out_summaries`, which
    this is for each member.
    """
    rows, parts = [], []
    for here, without in without_series(forecaster, training, case, washout, series):
        rows.append(here)
        parts.append(member_summaries(without, observable, washouts[here], boundaries))
    order = np.argsort(np.concatenate(rows))
    return [
        WindowSummaries(
            np.concatenate([one.first for one in of_member])[order],
            np.concatenate([one.largest for one in of_member])[order],
        )
        for of_member in zip(*parts, strict=True)
    ]
