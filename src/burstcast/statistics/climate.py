"""Climate runs: long closed loops of one forecaster, reduced to statistics while they run.

All trajectories run side by side, a chunk of steps at a time. None is stored: each is reduced to a
histogram and moments of its own, and those of the trajectories that turn out to count are merged.

Source: section "Statistical prediction of extreme events" of the paper.
"""

import enum
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from burstcast.arrays import BoolArray, FloatArray, IntArray
from burstcast.forecast.test_set import SeriesPoints, starting_points
from burstcast.forecasters.base import Forecaster
from burstcast.statistics.reductions import LongTermStatistics, SeriesAccumulator

STEPS_PER_CHUNK = 100
"""Steps between two looks at which trajectories have ended: costs time, changes no result."""

SETTLED_RANGE = 1e-10
"""Range of each component, in that of the washouts, below which a trajectory may have settled."""


class Fate(enum.IntEnum):
    """What becomes of a trajectory."""

    KEPT = 0
    LAMINAR = 1
    """Its observable exceeds the laminarisation threshold."""
    STUCK = 2
    """It has settled on a fixed point away from the laminar one."""
    DIVERGED = 3
    """It has left the attractor altogether (`Forecaster.diverged`)."""


@dataclass(frozen=True)
class StuckCriterion:
    """When a trajectory has settled on a fixed point.

    Attributes
    ----------
    variation
        Its observable varies by less than this over its last steps.
    above
        And stays above this: the chaotic flow has quiet spells, too, but at low values.
    interval
        Number of the last steps.
    """

    variation: float
    above: float
    interval: int


@dataclass(frozen=True)
class ClimateSettings:
    """How a climate run is made.

    Attributes
    ----------
    steps
        Length of each closed loop.
    edges
        Edges of the histogram's bins, ``(bins + 1,)``.
    laminarisation_threshold
        A trajectory whose observable exceeds it at any step is discarded; None: none is.
    stuck
        When a trajectory is discarded because it has settled; None: none is.

    Raises
    ------
    ValueError
        If there are no steps, or fewer than the stuck criterion looks at.
    """

    steps: int
    edges: FloatArray
    laminarisation_threshold: float | None
    stuck: StuckCriterion | None

    def __post_init__(self) -> None:
        if self.steps < 1:
            raise ValueError("statistics.duration is shorter than one step of the network")
        if self.stuck is not None and not 1 <= self.stuck.interval <= self.steps:
            raise ValueError(
                f"a closed loop of {self.steps} steps cannot be judged by its last "
                f"{self.stuck.interval}: lengthen statistics.duration or shorten "
                f"statistics.stuck_interval_lt"
            )


@dataclass(frozen=True)
class Climate:
    """Long-term statistics of a forecaster.

    Attributes
    ----------
    fates
        What became of each trajectory (`Fate`), in the order of the starting points,
        ``(starting points,)``.
    statistics
        Of the kept trajectories.
    """

    fates: IntArray
    statistics: LongTermStatistics

    @property
    def starting_points(self) -> int:
        """Number of trajectories."""
        return len(self.fates)

    @property
    def discarded_laminar(self) -> int:
        """Trajectories that laminarised."""
        return self._number(Fate.LAMINAR)

    @property
    def discarded_stuck(self) -> int:
        """Trajectories that settled on a fixed point."""
        return self._number(Fate.STUCK)

    @property
    def discarded_diverged(self) -> int:
        """Trajectories that diverged."""
        return self._number(Fate.DIVERGED)

    @property
    def discarded_fraction(self) -> float:
        """Share of all trajectories that were discarded."""
        return 1 - self._number(Fate.KEPT) / len(self.fates)

    def _number(self, fate: Fate) -> int:
        return int((self.fates == fate).sum())


def climate_starting_points(
    series: int, length: int, spacing: int, washout: int, count: int
) -> SeriesPoints:
    """Choose the starting points of a climate run, shared out evenly among the training series.

    The earliest points of every series are taken, one more in the first series where ``count`` is
    no multiple of their number. There are fewer than ``count`` where the series have no more room.

    Parameters
    ----------
    series
        Number of training series.
    length
        Samples in each.
    spacing
        Steps between two starting points of a series.
    washout
        Inputs of the washout; the last one is the starting point itself.
    count
        Wanted number of points.

    Returns
    -------
    Points in the order of series, then time.

    Raises
    ------
    ValueError
        If the series are shorter than a washout.
    """
    points = starting_points(series, length, spacing, washout, longest_forecast=0)
    taken = np.sort(np.lexsort((points.series, points.step))[:count])
    return SeriesPoints(series=points.series[taken], step=points.step[taken])


def run_climate(
    forecaster: Forecaster,
    observable: Callable[[FloatArray], FloatArray],
    washouts: FloatArray,
    settings: ClimateSettings,
) -> Climate:
    """Let a forecaster run freely from many starting points and keep its statistics.

    A trajectory that laminarises or diverges is dropped at once, and costs no more time. Where both
    happen, what happens first counts; at the same step, divergence.

    Whether a trajectory is stuck is known for certain at its end only, since the criterion is about
    its last steps. It is dropped before if it has come to rest for good: every component of its
    state has varied by less than `SETTLED_RANGE` for at least as long as remains. Rounding errors,
    1e-17 and more at every step, keep on disturbing it. In all that time an instability cannot have
    made them grow more than the 1e7-fold, or they would show; in the time that remains it cannot
    take them further than to 1e-3 of the range of the data, which the criterion is blind to.

    Parameters
    ----------
    forecaster
        Who forecasts.
    observable
        From states ``(dimension, ...)`` to the observable ``(...)``.
    washouts
        Observed states up to each starting point, ``(points, steps, dimension)``.
    settings
        How to run.

    Returns
    -------
    Statistics over the closed loops alone, without the washouts.

    Raises
    ------
    ValueError
        If there is no starting point.
    """
    points, _, dimension = washouts.shape
    if points == 0:
        raise ValueError("a climate run needs a starting point")
    fates = np.full(points, Fate.KEPT, dtype=np.int64)
    accumulator = SeriesAccumulator(points, dimension, settings.edges)
    stuck = (
        None if settings.stuck is None else _StuckDetector(settings.stuck, settings.steps, washouts)
    )
    running = np.arange(points)
    memory = forecaster.start(np.ascontiguousarray(washouts.transpose(1, 2, 0)))
    for start in range(0, settings.steps, STEPS_PER_CHUNK):
        chunk = min(STEPS_PER_CHUNK, settings.steps - start)
        states, memory = forecaster.advance(memory, chunk)
        with np.errstate(over="ignore", invalid="ignore"):
            values = observable(states.transpose(1, 0, 2))
        ended = _ends(forecaster, states, values, settings.laminarisation_threshold)
        fine = ended == Fate.KEPT
        if not fine.all():
            states, values = states[..., fine], values[:, fine]
        accumulator.add(running[fine], states, values)
        if stuck is not None:
            ended[fine] = stuck.look(running[fine], start, states, values)
        fates[running] = ended
        going_on = ended == Fate.KEPT
        if not going_on.all():
            running = running[going_on]
            memory = np.ascontiguousarray(memory[..., going_on])
        if running.size == 0:
            break
    return Climate(fates, accumulator.reductions().merged(fates == Fate.KEPT))


def _ends(
    forecaster: Forecaster, states: FloatArray, values: FloatArray, threshold: float | None
) -> IntArray:
    """Fates of trajectories ``(batch,)`` after a chunk, as far as it decides them."""
    diverged = forecaster.diverged(states)
    fates = np.where(diverged, Fate.DIVERGED, Fate.KEPT).astype(np.int64)
    if threshold is not None:
        above = values > threshold
        laminar = above.any(axis=0)
        fates[laminar & ~diverged] = Fate.LAMINAR
        for column in np.flatnonzero(laminar & diverged):
            until = int(above[:, column].argmax()) + 1
            if not forecaster.diverged(states[:until, :, column, np.newaxis])[0]:
                fates[column] = Fate.LAMINAR
    return fates


class _StuckDetector:
    """Tells which trajectories are stuck: at the end, or before where it is safe to tell.

    The observable is treated as one more component, behind those of the state.
    """

    def __init__(self, criterion: StuckCriterion, steps: int, washouts: FloatArray) -> None:
        points, _, dimension = washouts.shape
        self._criterion = criterion
        self._steps = steps
        # smallest and largest observable over the last interval of the closed loop
        self._low = np.full(points, np.inf)
        self._high = np.full(points, -np.inf)
        # range of each component since the trajectory has been (nearly) at rest
        self._rest_range = np.append(
            SETTLED_RANGE * np.ptp(washouts, axis=(0, 1)), criterion.variation
        )
        self._rest_since = np.zeros(points, dtype=np.int64)
        self._rest_low = np.full((dimension + 1, points), np.inf)
        self._rest_high = np.full((dimension + 1, points), -np.inf)

    def look(self, rows: IntArray, start: int, states: FloatArray, values: FloatArray) -> IntArray:
        """Fates (kept or stuck) of some trajectories after the chunk that begins at ``start``."""
        now = start + len(states)
        last = values[max(0, self._steps - self._criterion.interval - start) :]
        if len(last):
            self._low[rows] = np.minimum(self._low[rows], last.min(axis=0))
            self._high[rows] = np.maximum(self._high[rows], last.max(axis=0))
        if now == self._steps:
            stuck = (self._high[rows] - self._low[rows] < self._criterion.variation) & (
                self._low[rows] > self._criterion.above
            )
        else:
            stuck = self._settled(rows, start, now, states, values)
        return np.where(stuck, Fate.STUCK, Fate.KEPT).astype(np.int64)

    def _settled(
        self,
        rows: IntArray,
        start: int,
        now: int,
        states: FloatArray,
        values: FloatArray,
    ) -> BoolArray:
        components = np.concatenate([states, values[:, np.newaxis]], axis=1)
        chunk_low, chunk_high = components.min(axis=0), components.max(axis=0)
        low = np.minimum(self._rest_low[:, rows], chunk_low)
        high = np.maximum(self._rest_high[:, rows], chunk_high)
        since = self._rest_since[rows]
        limit = self._rest_range[:, np.newaxis]
        moved = ~(high - low < limit).all(axis=0)
        # rest begins anew: with this chunk, or behind it if it moves within
        moves = ~(chunk_high - chunk_low < limit).all(axis=0)
        since[moved] = np.where(moves, now, start)[moved]
        low[:, moved] = np.where(moves, np.inf, chunk_low)[:, moved]
        high[:, moved] = np.where(moves, -np.inf, chunk_high)[:, moved]
        self._rest_since[rows], self._rest_low[:, rows], self._rest_high[:, rows] = since, low, high
        long_enough = (now - since >= self._steps - now) & (
            since <= self._steps - self._criterion.interval
        )
        settled: BoolArray = long_enough & (low[-1] > self._criterion.above)
        return settled
