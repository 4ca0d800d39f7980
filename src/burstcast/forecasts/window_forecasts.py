"""Forecasts from many starting points, reduced to windows: single forecasts and ensembles."""

from collections.abc import Callable

import numpy as np

from burstcast.base.arrays import BoolArray, FloatArray
from burstcast.forecasters.base import Forecaster
from burstcast.forecasts.windows import WindowForecasts, WindowSummaries, summarise

POINTS_PER_BATCH = 1024
"""Washouts that a forecaster takes in side by side: bounds the memory, changes no result."""
TRAJECTORIES_PER_BATCH = 2048
"""Forecasts that run side by side: bounds the memory, changes no result."""


@np.errstate(over="ignore", invalid="ignore")
def window_forecasts(
    forecaster: Forecaster,
    observable: Callable[[FloatArray], FloatArray],
    washouts: FloatArray,
    boundaries: tuple[int, ...],
) -> WindowForecasts:
    """Forecast from many starting points and keep the window summaries.

    Forecasts that overflow raise no warning; they predict no event.
    """
    batches = []
    for start in range(0, len(washouts), POINTS_PER_BATCH):
        batch = washouts[start : start + POINTS_PER_BATCH].transpose(1, 2, 0)
        ensemble = forecaster.ensemble(np.ascontiguousarray(batch))
        single, diverged = _summaries(
            forecaster, observable, forecaster.combined(ensemble), boundaries
        )
        members, points = ensemble.shape[-2:]
        by_member = np.empty((2, 0, points, len(boundaries) - 1))
        if members > 1:
            summaries, _ = _summaries(forecaster, observable, side_by_side(ensemble), boundaries)
            by_member = np.stack([summaries.first, summaries.largest])
            by_member = by_member.reshape(2, members, points, -1)
        batches.append(
            WindowForecasts(single.first, single.largest, diverged, *by_member.swapaxes(1, 2))
        )
    return joined(batches)


def joined(parts: list[WindowForecasts]) -> WindowForecasts:
    """Forecasts of all starting points of several parts."""
    names = vars(parts[0])
    return WindowForecasts(
        **{name: np.concatenate([getattr(part, name) for part in parts]) for name in names}
    )


@np.errstate(over="ignore", invalid="ignore")
def member_forecasts(forecaster: Forecaster, washout: FloatArray, steps: int) -> FloatArray:
    """Forecast states by every member of an ensemble, ``(steps, dimension, members, batch)``.

    Overflows are as in `window_forecasts`.

    ``washout``: Observed states up to the starting points, ``(steps, dimension, batch)``.
    """
    ensemble = forecaster.ensemble(washout)
    outputs, _ = forecaster.advance(side_by_side(ensemble), steps)
    return outputs.reshape(*outputs.shape[:2], *ensemble.shape[-2:])


def side_by_side(ensemble: FloatArray) -> FloatArray:
    """Memories ``(..., members, batch)`` as one batch, ``(..., members * batch)``."""
    return np.ascontiguousarray(ensemble.reshape(*ensemble.shape[:-2], -1))


def _summaries(
    forecaster: Forecaster,
    observable: Callable[[FloatArray], FloatArray],
    memory: FloatArray,
    boundaries: tuple[int, ...],
) -> tuple[WindowSummaries, BoolArray]:
    """Summaries of the forecasts from memories, and whether they have diverged."""
    first, largest, diverged = [], [], []
    for start in range(0, memory.shape[-1], TRAJECTORIES_PER_BATCH):
        batch = slice(start, start + TRAJECTORIES_PER_BATCH)
        some = np.ascontiguousarray(memory[..., batch])
        outputs, _ = forecaster.advance(some, boundaries[-1])
        summaries = summarise(observable(outputs.transpose(1, 0, 2)), boundaries)
        first.append(summaries.first)
        largest.append(summaries.largest)
        diverged.append(forecaster.diverged(outputs))
    together = WindowSummaries(np.concatenate(first), np.concatenate(largest))
    return together, np.concatenate(diverged)
