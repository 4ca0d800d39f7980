"""Long-term runs: long closed loops of one forecaster, reduced to statistics while they run.

Trajectories run side by side, a chunk of steps at a time. Each is reduced to a histogram and
moments, which are merged for the trajectories that count. Source: section "Statistical prediction
of extreme events".
"""

import bisect
import enum
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from burstcast.base.arrays import BoolArray, FloatArray, IntArray
from burstcast.base.files.netcdf import Variable, variables_of
from burstcast.base.files.units import NUMBER
from burstcast.data.laminarisation import first_laminar_step
from burstcast.data.starting_points import SeriesPoints, starting_points
from burstcast.forecasters.base import Forecaster
from burstcast.statistics.reductions import LongTermStatistics, SeriesAccumulator, SeriesReductions
from burstcast.statistics.statistics_files import statistics_variables

STEPS_PER_CHUNK = 100
"""Steps between two looks at which trajectories have ended: costs time, changes no result."""

FIXED_POINT_RANGE = 1e-10
"""Range of each component at a fixed point, in units of its range over the washouts."""


class Fate(enum.IntEnum):
    """Fate of a trajectory."""

    KEPT = 0
    LAMINAR = 1
    """Its observable exceeds the laminarisation threshold."""
    FIXED_POINT = 2
    """It has come to a fixed point away from the laminar one."""
    DIVERGED = 3
    """It has left the attractor altogether (`Forecaster.diverged`)."""


@dataclass(frozen=True)
class FixedPointCriterion:
    """When a trajectory has come to a fixed point."""

    variation: float  #: its observable varies by less than this over its last steps
    above: float  #: and stays above this: the chaotic flow has quiet spells, too, but at low values
    interval: int  #: number of the last steps


@dataclass(frozen=True)
class LongTermSettings:
    """Settings of a long-term run."""

    steps: int  #: length of each closed loop
    edges: FloatArray  #: edges of the histogram's bins, ``(bins + 1,)``
    #: a trajectory whose observable exceeds it at any step is discarded; None: none is
    laminarisation_threshold: float | None
    #: when a trajectory is discarded because it is at a fixed point; None: none is
    fixed_point: FixedPointCriterion | None

    def __post_init__(self) -> None:
        if self.steps < 1:
            raise ValueError("a closed loop needs at least one step")
        if self.fixed_point is not None and not 1 <= self.fixed_point.interval <= self.steps:
            raise ValueError(
                f"a closed loop of {self.steps} steps cannot be judged by its last "
                f"{self.fixed_point.interval}"
            )


@dataclass(frozen=True)
class LongTermRun:
    """Long-term statistics of a forecaster."""

    #: what became of each trajectory (`Fate`), in the order of the starting points, ``(starting
    #: points,)``
    fates: IntArray
    #: steps until each trajectory leaves the chaotic phase: until it laminarises, diverges, or
    #: comes to rest at a fixed point; all steps of a kept one. ``(starting points,)``.
    lifetimes: IntArray
    statistics: LongTermStatistics  #: statistics of the kept trajectories
    #: what they are merged from: reductions of each trajectory, as far as it went
    runs: SeriesReductions

    def variables(self) -> dict[str, Variable]:
        """Variables of the file of the run."""
        fates = ", ".join(f"{fate.value} {fate.name.lower()}" for fate in Fate)
        lifetime = "steps until each loop left the chaotic phase"
        return {
            **statistics_variables(self.statistics),
            "fate": Variable(("start",), self.fates, NUMBER, f"fate of each closed loop: {fates}"),
            "lifetime": Variable(("start",), self.lifetimes, NUMBER, lifetime),
            **variables_of(self.runs),
        }


def long_term_starting_points(
    series: int,
    length: int,
    spacing: int,
    washout: int,
    count: int,
    lengths: IntArray | None = None,
) -> SeriesPoints:
    """Starting points of a long-term run: the earliest ones, shared out evenly among the series.

    The earliest points of every series are taken, one more in the first series where ``count`` is
    no multiple of their number. There are fewer than ``count`` where the series have no more room.
    ``lengths``: Samples of each series, where some are shorter than ``length``.
    """
    points = starting_points(series, length, spacing, washout, longest_forecast=0, lengths=lengths)
    taken = np.sort(np.lexsort((points.series, points.step))[:count])
    return SeriesPoints(series=points.series[taken], step=points.step[taken])


def run_long_term(
    forecaster: Forecaster,
    observable: Callable[[FloatArray], FloatArray],
    washouts: FloatArray,
    settings: LongTermSettings,
) -> LongTermRun:
    """Let a forecaster run freely from many starting points and keep its statistics.

    A trajectory that laminarises or diverges is dropped at once; what happens first counts, and at
    the same step divergence. One at a fixed point is dropped before its end only if it stays there
    for good: every component has varied by less than `FIXED_POINT_RANGE` for at least as long as
    remains. In all that time an instability cannot have made rounding errors (1e-17) grow more than
    the 1e7-fold, or they would show; in the time that remains it cannot take them further than to
    1e-3 of the range of the data.
    """
    points, _, dimension = washouts.shape
    if points == 0:
        raise ValueError("a long-term run needs a starting point")
    fates = np.full(points, Fate.KEPT, dtype=np.int64)
    lifetimes = np.full(points, settings.steps, dtype=np.int64)
    accumulator = SeriesAccumulator(points, dimension, settings.edges)
    detector = None
    if settings.fixed_point is not None:
        detector = _FixedPointDetector(settings.fixed_point, settings.steps, washouts)
    running = np.arange(points)
    memory = forecaster.start(np.ascontiguousarray(washouts.transpose(1, 2, 0)))
    for start in range(0, settings.steps, STEPS_PER_CHUNK):
        chunk = min(STEPS_PER_CHUNK, settings.steps - start)
        states, memory = forecaster.advance(memory, chunk)
        with np.errstate(over="ignore", invalid="ignore"):
            values = observable(states.transpose(1, 0, 2))
        ended, at = _ends(forecaster, states, values, settings.laminarisation_threshold)
        fine = ended == Fate.KEPT
        lifetimes[running[~fine]] = start + at[~fine] + 1
        if not fine.all():
            states, values = states[..., fine], values[:, fine]
        accumulator.add(running[fine], states, values)
        if detector is not None:
            ended[fine] = detector.look(running[fine], start, states, values)
            resting = running[ended == Fate.FIXED_POINT]
            lifetimes[resting] = detector.at_rest_since(resting) + 1
        fates[running] = ended
        going_on = ended == Fate.KEPT
        if not going_on.all():
            running = running[going_on]
            memory = np.ascontiguousarray(memory[..., going_on])
        if running.size == 0:
            break
    runs = accumulator.reductions()
    return LongTermRun(fates, lifetimes, runs.merged(fates == Fate.KEPT), runs)


def _ends(
    forecaster: Forecaster, states: FloatArray, values: FloatArray, threshold: float | None
) -> tuple[IntArray, IntArray]:
    """Fates of trajectories ``(batch,)`` after a chunk, and positions of the steps that decide."""
    diverged = forecaster.diverged(states)
    fates = np.where(diverged, Fate.DIVERGED, Fate.KEPT).astype(np.int64)
    at = np.zeros(len(fates), dtype=np.int64)
    for column in np.flatnonzero(diverged):
        at[column] = _first_diverged(forecaster, states[..., column])
    first = first_laminar_step(values, threshold, axis=0)
    laminar = (first >= 0) & ~(diverged & (at <= first))
    fates[laminar] = Fate.LAMINAR
    at[laminar] = first[laminar]
    return fates, at


def _first_diverged(forecaster: Forecaster, states: FloatArray) -> int:
    """First step at which a forecast ``(steps, dimension)``, known to diverge, has diverged."""
    steps = np.arange(1, len(states) + 1)
    return bisect.bisect_left(
        steps, True, key=lambda stop: bool(forecaster.diverged(states[:stop, :, np.newaxis])[0])
    )


class _FixedPointDetector:
    """Trajectories that are at a fixed point: at the end, or before where that is safe.

    The observable is treated as one more component, behind the components of the state.
    """

    def __init__(self, criterion: FixedPointCriterion, steps: int, washouts: FloatArray) -> None:
        points, _, dimension = washouts.shape
        self._criterion = criterion
        self._steps = steps
        # smallest and largest observable over the last interval of the closed loop
        self._low = np.full(points, np.inf)
        self._high = np.full(points, -np.inf)
        # the same since the observable has varied by less than the criterion's variation
        self._rest_since = np.zeros(points, dtype=np.int64)
        self._rest_low = np.full(points, np.inf)
        self._rest_high = np.full(points, -np.inf)
        # range of each component since the trajectory has been (nearly) at a fixed point
        self._quiet_range = np.append(
            FIXED_POINT_RANGE * np.ptp(washouts, axis=(0, 1)), criterion.variation
        )
        self._quiet_since = np.zeros(points, dtype=np.int64)
        self._quiet_low = np.full((dimension + 1, points), np.inf)
        self._quiet_high = np.full((dimension + 1, points), -np.inf)

    def look(self, rows: IntArray, start: int, states: FloatArray, values: FloatArray) -> IntArray:
        """Fates (kept, or at a fixed point) after the chunk that begins at ``start``."""
        now = start + len(states)
        self._follow_rest(rows, start, values)
        last = values[max(0, self._steps - self._criterion.interval - start) :]
        if len(last):
            self._low[rows] = np.minimum(self._low[rows], last.min(axis=0))
            self._high[rows] = np.maximum(self._high[rows], last.max(axis=0))
        if now == self._steps:
            at_fixed_point = (self._high[rows] - self._low[rows] < self._criterion.variation) & (
                self._low[rows] > self._criterion.above
            )
        else:
            at_fixed_point = self._for_good(rows, start, now, states, values)
        return np.where(at_fixed_point, Fate.FIXED_POINT, Fate.KEPT).astype(np.int64)

    def at_rest_since(self, rows: IntArray) -> IntArray:
        """First step since which the observable has hardly varied, for trajectories at rest."""
        return np.minimum(self._rest_since[rows], self._steps - self._criterion.interval)

    def _follow_rest(self, rows: IntArray, start: int, values: FloatArray) -> None:
        since, low, high = (
            quantity[rows] for quantity in (self._rest_since, self._rest_low, self._rest_high)
        )
        # step by step, so that the chunks change nothing
        for step, value in enumerate(values, start):
            low, high = np.minimum(low, value), np.maximum(high, value)
            moved = high - low >= self._criterion.variation
            since = np.where(moved, step, since)
            low, high = np.where(moved, value, low), np.where(moved, value, high)
        self._rest_since[rows], self._rest_low[rows], self._rest_high[rows] = since, low, high

    def _for_good(
        self,
        rows: IntArray,
        start: int,
        now: int,
        states: FloatArray,
        values: FloatArray,
    ) -> BoolArray:
        components = np.concatenate([states, values[:, np.newaxis]], axis=1)
        chunk_low, chunk_high = components.min(axis=0), components.max(axis=0)
        low = np.minimum(self._quiet_low[:, rows], chunk_low)
        high = np.maximum(self._quiet_high[:, rows], chunk_high)
        since = self._quiet_since[rows]
        limit = self._quiet_range[:, np.newaxis]
        moved = ~(high - low < limit).all(axis=0)
        # the quiet stretch begins anew: with this chunk, or behind it if it moves within
        moves = ~(chunk_high - chunk_low < limit).all(axis=0)
        since[moved] = np.where(moves, now, start)[moved]
        low[:, moved] = np.where(moves, np.inf, chunk_low)[:, moved]
        high[:, moved] = np.where(moves, -np.inf, chunk_high)[:, moved]
        self._quiet_since[rows], self._quiet_low[:, rows], self._quiet_high[:, rows] = (
            since,
            low,
            high,
        )
        long_enough = (now - since >= self._steps - now) & (
            since <= self._steps - self._criterion.interval
        )
        for_good: BoolArray = long_enough & (low[-1] > self._criterion.above)
        return for_good
