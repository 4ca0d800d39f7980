"""Forecasts from many starting points, reduced to windows: single forecasts and ensembles."""

from collections.abc import Callable

import numpy as np

from burstcast.base.arrays import BoolArray, FloatArray
from burstcast.forecasters.base import Forecaster, for_members, schedules_of
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
    parameters: FloatArray | None = None,
) -> WindowForecasts:
    """Forecast from many starting points and keep the window summaries.

    Forecasts that overflow raise no warning; they predict no event. ``parameters``: Schedule over
    washout and forecast, ``(points, steps - 1 + boundaries[-1], parameters)``; None: the defaults.
    """
    batches = []
    for start in range(0, len(washouts), POINTS_PER_BATCH):
        batch = washouts[start : start + POINTS_PER_BATCH].transpose(1, 2, 0)
        in_force = None if parameters is None else parameters[start : start + POINTS_PER_BATCH]
        past, ahead = schedules_of(in_force, washouts.shape[1])
        ensemble = forecaster.ensemble_under(np.ascontiguousarray(batch), past)
        single, diverged = _summaries(
            forecaster, observable, forecaster.combined(ensemble), boundaries, ahead
        )
        members, points = ensemble.shape[-2:]
        by_member = np.empty((2, 0, points, len(boundaries) - 1))
        if members > 1:
            of_members = for_members(ahead, members)
            summaries, _ = _summaries(
                forecaster, observable, side_by_side(ensemble), boundaries, of_members
            )
            by_member = np.stack([summaries.first, summaries.largest]).reshape(
                2, members, points, -1
            )
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
def member_forecasts(
    forecaster: Forecaster, washout: FloatArray, steps: int, parameters: FloatArray | None = None
) -> FloatArray:
    """Forecast states by each member of an ensemble, ``(steps, dimension, members, batch)``.

    ``washout``: ``(steps, dimension, batch)``. ``parameters``: As of `window_forecasts`.
    """
    past, ahead = schedules_of(parameters, len(washout))
    ensemble = forecaster.ensemble_under(washout, past)
    of_members = for_members(ahead, ensemble.shape[-2])
    outputs, _ = forecaster.advance_under(side_by_side(ensemble), steps, of_members)
    return outputs.reshape(*outputs.shape[:2], *ensemble.shape[-2:])


def side_by_side(ensemble: FloatArray) -> FloatArray:
    """Memories ``(..., members, batch)`` as one batch, ``(..., members * batch)``."""
    return np.ascontiguousarray(ensemble.reshape(*ensemble.shape[:-2], -1))


def _summaries(
    forecaster: Forecaster,
    observable: Callable[[FloatArray], FloatArray],
    memory: FloatArray,
    boundaries: tuple[int, ...],
    parameters: FloatArray | None,
) -> tuple[WindowSummaries, BoolArray]:
    """Summaries of the forecasts from memories, and whether they have diverged."""
    first, largest, diverged = [], [], []
    for start in range(0, memory.shape[-1], TRAJECTORIES_PER_BATCH):
        batch = slice(start, start + TRAJECTORIES_PER_BATCH)
        in_force = None if parameters is None else parameters[..., batch]
        some = np.ascontiguousarray(memory[..., batch])
        outputs, _ = forecaster.advance_under(some, boundaries[-1], in_force)
        summaries = summarise(observable(outputs.transpose(1, 0, 2)), boundaries)
        first.append(summaries.first)
        largest.append(summaries.largest)
        diverged.append(forecaster.diverged(outputs))
    summaries = WindowSummaries(np.concatenate(first), np.concatenate(largest))
    return summaries, np.concatenate(diverged)
