"""A forecasting task: the washouts that all forecasts start from, and what is to be forecast."""

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass

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


@dataclass(frozen=True)
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


@dataclass(frozen=True)
class KnownColumns:
    """Values of a record's columns that are known in advance.

    The entry of a step holds the values in the sample after it. Steps of the forecast follow steps
    of the washout.
    """

    training: FloatArray  #: of the training series, ``(series, time - 1, columns)``
    #: of the starting points, ``(points, washout - 1 + forecast steps, columns)``
    points: FloatArray
    #: of the starting points of the prediction horizon, ``(points, washout - 1 + horizon steps,
    #: columns)``; NaN where the series has ended
    horizon: FloatArray

    def arrays(self) -> tuple[FloatArray, ...]:
        """All values, in units of each column's standard deviation in the training series."""
        scale = self.training.std(axis=(0, 1))
        scale = np.where(scale > 0, scale, 1.0)
        return self.training / scale, self.points / scale, self.horizon / scale


@dataclass(frozen=True)
class TaskData:
    """Observed data of a task: all that a forecaster may know."""

    task: ForecastTask  #: task of the forecasts
    training: FloatArray  #: observed training series, ``(series, time, component)``
    #: points, washouts: starting points in the test series, and what is observed up to each of
    #: them, ``(points, steps, component)``
    points: SeriesPoints
    washouts: FloatArray
    horizon_washouts: FloatArray  #: likewise for the starting points of the prediction horizon
    search: HorizonSearch  #: how prediction horizons are looked for
    #: standard deviation of the observation noise, in standard deviations of each component
    noise: float
    event_threshold: float  #: event threshold in units of the observable
    sampling_interval: float  #: time between two samples, in time units
    #: error that the search allows, in distances of the threshold from the mean observable
    tolerance: float
    #: columns that are known in advance; None where there are none
    known: KnownColumns | None = None

    @property
    def window_steps(self) -> list[tuple[int, int]]:
        """First and last step of each prediction window, counted from the starting point."""
        times, steps = self.task.prediction_times_lt, self.search.steps
        return [(steps(time), steps(time + self.task.window_lt)) for time in times]


def campaign_task(
    *,
    case: str,
    seed: int,
    space: StateSpace,
    boundaries: tuple[int, ...],
    prediction_times_lt: Sequence[float],
    window_lt: float,
    resolution_lt: float,
    training: FloatArray,
    points: SeriesPoints,
    washouts: FloatArray,
    events: SeriesPoints,
    before_events: FloatArray,
    search: HorizonSearch,
    known: FloatArray | None = None,
    known_of_points: FloatArray | None = None,
    **facts: float,
) -> TaskData:
    """Task of a case of a campaign, whose version is a digest of its data.

    ``case``, ``seed``, ``space``, ``boundaries``, ``prediction_times_lt``, ``window_lt``,
    ``resolution_lt``: Attributes of the `ForecastTask`; the random numbers of the order of horizon
    points follow from the seed. ``events``, ``before_events``: Events whose prediction horizon is
    measured, and what is observed up to each of them, ``(events, steps, component)``. ``known``:
    Columns that are known in advance, in the sample after each step of all kept series, ``(series,
    time - 1, columns)``; None where there are none. ``known_of_points``: Likewise over the washouts
    and forecasts of the points (`KnownColumns.points`).
    """
    order = random_streams.stream(seed, "benchmark horizon", case)
    starts = horizon_starts(events, search, order)
    horizon = segments(before_events, SeriesPoints(*starts), search.washout - 1, 0)
    columns = None
    if known is not None and known_of_points is not None:
        columns = KnownColumns(
            training=known[: len(training)],
            points=known_of_points,
            horizon=_known_of_horizon(known, events, starts, search),
        )
    # whatever the units are
    scale = component_scales(training).standard_deviation
    task = ForecastTask(
        case=case,
        version=data_digest(
            [
                *(part / scale for part in (training, washouts, horizon)),
                *(columns.arrays() if columns is not None else ()),
            ]
        ),
        seed=seed,
        space=space,
        points=len(points),
        boundaries=boundaries,
        prediction_times_lt=tuple(map(float, prediction_times_lt)),
        window_lt=window_lt,
        resolution_lt=resolution_lt,
        horizon_points=len(horizon),
        horizon_steps=search.longest_lead_time,
    )
    return TaskData(task, training, points, washouts, horizon, search, known=columns, **facts)


def _known_of_horizon(
    known: FloatArray,
    events: SeriesPoints,
    starts: tuple[IntArray, IntArray],
    search: HorizonSearch,
) -> FloatArray:
    """Known columns over the washouts and the longest forecasts of `horizon_starts`.

    They go on beyond the event, so that they do not tell how far it is.
    """
    event, step = starts
    steps = search.longest_lead_time
    points = SeriesPoints(
        events.series[event], events.step[event] - search.steps_before_event + step
    )
    padded = np.pad(known, ((0, 0), (0, steps), (0, 0)), constant_values=np.nan)
    return segments(padded, points, search.washout - 1, steps - 1)


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

    ``search``: How prediction horizons are looked for; segments have its steps before an event.
    """
    leads = np.array([search.steps(lead) for lead in search.lead_times_lt])
    event = np.repeat(np.arange(len(events)), len(leads))
    step = np.tile(search.steps_before_event - leads, len(events))
    where = np.stack([events.series[event], events.step[event] + step], axis=1)
    _, first = np.unique(where, axis=0, return_index=True)
    chosen = generator.permutation(np.sort(first))
    return event[chosen], step[chosen]
