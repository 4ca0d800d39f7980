"""A forecasting task: the washouts that all forecasts start from, and what is to be forecast."""

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from burstcast import random_streams
from burstcast.arrays import FloatArray, IntArray
from burstcast.data.dataset import component_scales
from burstcast.data.starting_points import SeriesPoints, segments
from burstcast.forecast.horizon import HorizonSearch
from burstcast.systems.state_space import StateSpace

_DIGEST_DECIMALS = 6
"""Decimals to which data are rounded before they are digested: rounding errors of a machine, such
as a logarithm in another library, then do not count, and chaos amplifies all larger differences."""


@dataclass(frozen=True, kw_only=True)
class ForecastTask:
    """Reference that files of forecasts are compared with."""

    #: case, version, seed: which data the forecasts are of, as files of forecasts say it; the
    #: version is a digest of the data
    case: str
    version: str
    seed: int
    space: StateSpace  #: what an observed state is
    points: int  #: starting points of the windows
    #: steps at which windows begin and end (`burstcast.forecast.windows.window_boundaries`)
    boundaries: tuple[int, ...]
    #: times from a starting point to each prediction window, in Lyapunov times
    prediction_times_lt: tuple[float, ...]
    #: window_lt, resolution_lt: length of the prediction windows, and of the windows between
    #: boundaries
    window_lt: float
    resolution_lt: float
    #: horizon_points, horizon_steps: starting points of the prediction horizon, and steps of their
    #: forecasts
    horizon_points: int
    horizon_steps: int

    @property
    def steps(self) -> int:
        """Steps of a forecast from a starting point of the windows."""
        return self.boundaries[-1]

    @property
    def windows(self) -> list[tuple[int, int]]:
        """First of the windows between boundaries that make up each prediction window; how many."""
        count = round(self.window_lt / self.resolution_lt)
        return [(round(time / self.resolution_lt) - 1, count) for time in self.prediction_times_lt]


@dataclass(frozen=True, kw_only=True)
class TaskData:
    """Observed data of a task, and what follows from them."""

    case: str
    seed: int
    space: StateSpace
    boundaries: tuple[int, ...]
    prediction_times_lt: Sequence[float]
    window_lt: float
    resolution_lt: float
    training: FloatArray  #: observed training series, ``(series, time, component)``
    #: points, washouts: starting points in the test series, and what is observed up to each of
    #: them, ``(points, steps, component)``
    points: SeriesPoints
    washouts: FloatArray
    #: events, before_events: events whose prediction horizon is measured, and what is observed up
    #: to each of them, ``(events, steps, component)``
    events: SeriesPoints
    before_events: FloatArray
    search: HorizonSearch  #: how prediction horizons are looked for
    #: columns that are known in advance, in the sample after each step of all kept series,
    #: ``(series, time - 1, columns)``; None where there are none
    known: FloatArray | None = None
    #: likewise over the washouts and forecasts of the points
    known_of_points: FloatArray | None = None
    #: standard deviation of the observation noise, in standard deviations of each component
    noise: float
    event_threshold: float  #: event threshold in units of the observable
    sampling_interval: float  #: time between two samples, in time units
    #: error that the search allows, in distances of the threshold from the mean observable
    tolerance: float

    @cached_property
    def starts(self) -> tuple[IntArray, IntArray]:
        """Starting points of prediction horizons (`horizon_starts`)."""
        order = random_streams.stream(self.seed, "benchmark horizon", self.case)
        return horizon_starts(self.events, self.search, order)

    @cached_property
    def horizon_washouts(self) -> FloatArray:
        """What is observed up to each of the `starts`, ``(points, steps, component)``."""
        return segments(self.before_events, SeriesPoints(*self.starts), self.search.washout - 1, 0)

    @cached_property
    def known_columns(self) -> dict[str, FloatArray]:
        """Columns that are known in advance, by the names of the file; empty if there are none.

        Those of the horizon go on beyond the event, so that they do not tell how far it is; NaN
        where the series has ended.
        """
        if self.known is None or self.known_of_points is None:
            return {}
        (event, step), steps = self.starts, self.search.longest_lead_time
        at = self.events.step[event] - self.search.steps_before_event + step
        padded = np.pad(self.known, ((0, 0), (0, steps), (0, 0)), constant_values=np.nan)
        points = SeriesPoints(self.events.series[event], at)
        return {
            "training_known": self.known[: len(self.training)],
            "known": self.known_of_points,
            "horizon_known": segments(padded, points, self.search.washout - 1, steps - 1),
        }

    @cached_property
    def task(self) -> ForecastTask:
        """Task of the forecasts."""
        scale = component_scales(self.training).standard_deviation  # whatever the units are
        parts = [part / scale for part in (self.training, self.washouts, self.horizon_washouts)]
        if columns := self.known_columns:
            spread = columns["training_known"].std(axis=(0, 1))
            parts += [one / np.where(spread > 0, spread, 1.0) for one in columns.values()]
        return ForecastTask(
            case=self.case,
            version=data_digest(parts),
            seed=self.seed,
            space=self.space,
            points=len(self.points),
            boundaries=self.boundaries,
            prediction_times_lt=tuple(map(float, self.prediction_times_lt)),
            window_lt=self.window_lt,
            resolution_lt=self.resolution_lt,
            horizon_points=len(self.horizon_washouts),
            horizon_steps=self.search.longest_lead_time,
        )

    @property
    def window_steps(self) -> list[tuple[int, int]]:
        """First and last step of each prediction window, counted from the starting point."""
        steps = self.search.steps
        return [(steps(time), steps(time + self.window_lt)) for time in self.prediction_times_lt]


def data_digest(arrays: Sequence[FloatArray]) -> str:
    """Sixteen hexadecimal digits that depend on all numbers of arrays, but for rounding errors."""
    found = hashlib.sha256()
    for array in arrays:
        # zero has one sign
        found.update((np.round(array, _DIGEST_DECIMALS) + 0.0).tobytes())
    return found.hexdigest()[:16]


def horizon_starts(
    events: SeriesPoints, search: HorizonSearch, generator: np.random.Generator
) -> tuple[IntArray, IntArray]:
    """Starting points of prediction horizons: row of the event, and step of its segment.

    In a random order, which does not tell how far the event is. Points that are the same step of
    the same series, before two events, are there once.
    """
    leads = np.array([search.steps(lead) for lead in search.lead_times_lt])
    event = np.repeat(np.arange(len(events)), len(leads))
    step = np.tile(search.steps_before_event - leads, len(events))
    where = np.stack([events.series[event], events.step[event] + step], axis=1)
    _, first = np.unique(where, axis=0, return_index=True)
    chosen = generator.permutation(np.sort(first))
    return event[chosen], step[chosen]
