"""Forecasts reduced to windows: the first and largest observable of each.

The time after a starting point is cut into windows of one resolution (half a Lyapunov time). A
prediction window, which is several of them, is scored from their summaries, whatever the event
threshold is. Neighbouring windows share their common step.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Self

import numpy as np

from burstcast.base import durations
from burstcast.base.arrays import BoolArray, FloatArray
from burstcast.forecasters.base import Forecaster


@dataclass(frozen=True)
class WindowSummaries:
    """First and largest observable in each window after each starting point."""

    #: observable at the window's first step, ``(points, windows)``; NaN where the forecast is
    #: invalid (`burstcast.forecasters.base.Forecaster.invalid`)
    first: FloatArray
    #: largest observable in the window, both ends included, ``(points, windows)``; likewise
    largest: FloatArray

    @classmethod
    def always_crossing(cls, shape: tuple[int, ...]) -> Self:
        """Summaries that cross every threshold in every window: of a permanent alarm."""
        most = np.finfo(np.float64).max
        return cls(np.full(shape, -most), np.full(shape, most))


@dataclass(frozen=True)
class WindowForecasts(WindowSummaries):
    """Window summaries of the single forecast from each starting point, and of an ensemble."""

    diverged: BoolArray  #: whether the single forecast has diverged, ``(points,)``
    #: member_first, member_largest: ``first`` and ``largest`` of the forecast of each member,
    #: ``(points, members, windows)``. A forecaster that provides no ensemble has no members here.
    member_first: FloatArray
    member_largest: FloatArray

    @property
    def members(self) -> list[WindowSummaries]:
        """Window summaries of each member; without an ensemble, of the single forecast."""
        by_member = (self.member_first.swapaxes(0, 1), self.member_largest.swapaxes(0, 1))
        return [WindowSummaries(*pair) for pair in zip(*by_member, strict=True)] or [self]


def window_boundaries(
    resolution_lt: float, windows: int, steps_per_lyapunov_time: int
) -> tuple[int, ...]:
    """Steps after the starting point at which the windows begin and end, both included.

    The first boundary is one resolution after the starting point: no prediction time is shorter.
    """
    durations.positive_steps(resolution_lt, steps_per_lyapunov_time, "the resolution of windows")
    return tuple(
        durations.steps((index + 1) * resolution_lt, steps_per_lyapunov_time)
        for index in range(windows + 1)
    )


def summarise(observable: FloatArray, boundaries: tuple[int, ...]) -> WindowSummaries:
    """Window summaries of ``(steps, points)`` that begin one step after the starting points."""
    pairs = list(pairwise(boundaries))
    return WindowSummaries(
        first=np.stack([observable[start - 1] for start, _ in pairs], axis=1),
        largest=np.stack([observable[start - 1 : end].max(axis=0) for start, end in pairs], axis=1),
    )


def crosses(
    summaries: WindowSummaries, first_window: int, windows: int, threshold: float
) -> BoolArray:
    """Whether the observable crosses the threshold in a prediction window, ``(points,)``.

    It does if it is valid up to the end of the window, below the threshold at the window's first
    step and at or above it later on.
    """
    span = slice(first_window, first_window + windows)
    if first_window < 0 or first_window + windows > summaries.first.shape[1]:
        raise IndexError("the prediction window reaches beyond the forecast")
    below_at_first = summaries.first[:, first_window] < threshold
    largest = summaries.largest[:, span].max(axis=1)
    return np.asarray(below_at_first & (largest >= threshold) & np.isfinite(largest))


def is_valid(summaries: WindowSummaries, first_window: int, windows: int) -> BoolArray:
    """Whether a forecast is valid up to the end of a prediction window, ``(points,)``."""
    last = summaries.largest[:, first_window : first_window + windows]
    return np.asarray(np.isfinite(last).all(axis=1) & np.isfinite(summaries.first[:, first_window]))


def valid_votes(members: Sequence[WindowSummaries], first_window: int, windows: int) -> FloatArray:
    """Share of the members whose forecasts are valid (see `is_valid`), ``(points,)``."""
    valid = [is_valid(member, first_window, windows) for member in members]
    return np.asarray(np.mean(valid, axis=0))


def crosses_in_window(observable: FloatArray, start: int, end: int, threshold: float) -> BoolArray:
    """Whether observables ``(steps, batch)`` cross the threshold from step ``start`` to ``end``."""
    return crosses(summarise(observable, (start, end)), 0, 1, threshold)


def share_of_votes(
    members: Sequence[WindowSummaries], first_window: int, windows: int, threshold: float
) -> FloatArray:
    """Share of the members that forecast a crossing (see `crosses`), ``(points,)``, in [0, 1].

    A member whose forecast is invalid votes against.
    """
    if not members:
        raise ValueError("a committee needs members")
    votes = sum(
        crosses(member, first_window, windows, threshold).astype(np.int64) for member in members
    )
    return np.asarray(votes / len(members))


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

    Forecasts that overflow raise no warning; invalid ones predict no event.
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
    outputs = forecaster.valid(outputs)
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
        valid = forecaster.valid(outputs)
        summaries = summarise(observable(valid.transpose(1, 0, 2)), boundaries)
        first.append(summaries.first)
        largest.append(summaries.largest)
        diverged.append(np.isnan(valid[-1]).any(axis=0))
    together = WindowSummaries(np.concatenate(first), np.concatenate(largest))
    return together, np.concatenate(diverged)
