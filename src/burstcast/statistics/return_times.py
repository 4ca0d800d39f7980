"""Return times of events: mean times from one event to the next, with exact intervals.

An event of a level is an upward crossing of it (`burstcast.data.events`). The number of independent
events in a given time is Poisson distributed, which gives the exact interval of their rate; the
return time is its reciprocal. Whether events are independent shows in the dispersion of their
numbers in blocks of time, variance over mean, which is 1 for a Poisson process. Where it is larger,
events come in clusters, and the interval is that of the blocks.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import scipy

from burstcast.base.arrays import BoolArray, FloatArray, IntArray
from burstcast.base.poisson import poisson_interval, rate_bound
from burstcast.data.events import upward_crossings


@dataclass(frozen=True)
class ReturnTimes:
    """Return times of levels, ``(levels,)`` each, in the unit of the time of observation."""

    levels: FloatArray
    events: IntArray
    time: float  #: total time of observation
    #: time over events; infinite where no event was observed
    return_time: FloatArray
    #: low, high: confidence interval; where no event was observed, ``low`` is the one-sided bound
    #: (3.0 events at 0.95) and ``high`` infinite
    low: FloatArray
    high: FloatArray
    #: variance over mean of the numbers of events in blocks; NaN with one block, or without events
    dispersion: FloatArray
    clustered: BoolArray  #: whether the interval is that of blocks, not that of a Poisson process
    blocks: int  #: number of blocks with any time of observation


def return_times(
    events: npt.ArrayLike,
    time: npt.ArrayLike,
    levels: npt.ArrayLike | None = None,
    confidence: float = 0.95,
) -> ReturnTimes:
    """Return times of levels from numbers of events in blocks of time.

    Where the dispersion is not significantly above 1 (chi-squared test of the blocks at
    ``confidence``), the interval is the exact one of a Poisson process (Garwood, Biometrika 28
    (1936) 437). Otherwise the events are worth as many independent ones as their number divided by
    the dispersion, and by the square of the ratio of the quantiles of Student's t for these blocks
    and of the normal distribution, since the dispersion is an estimate, too (quasi-Poisson,
    McCullagh & Nelder, Generalized Linear Models, 1989, section 6.2.3).

    Parameters
    ----------
    events
        Number of events in each block, ``(blocks, levels)``, or ``(blocks,)`` of one level: of
        separate series, or of stretches that are much longer than the memory of the process
        (`events_in_blocks`).
    time
        Time of observation of each block, ``(blocks,)``, or the same for all.
    levels
        The levels; by default numbered from 0.
    confidence
        Probability that an interval covers the true return time.

    Raises
    ------
    ValueError
        If shapes do not fit, there is no time of observation, or a count is negative or not whole.

    Examples
    --------
    >>> from burstcast.statistics.return_times import return_times
    >>> of_flows = return_times([[3, 0], [1, 0], [2, 0], [2, 0]], 100.0, levels=[0.1, 0.2])
    >>> of_flows.return_time.tolist(), of_flows.low.round(1).tolist()
    ([50.0, inf], [25.4, 133.5])
    """
    counts = np.asarray(events)
    if counts.ndim == 1:
        counts = counts[:, np.newaxis]
    if counts.ndim != 2 or not np.array_equal(counts, np.asarray(counts, dtype=np.int64)):
        raise ValueError("events must be whole numbers, (blocks, levels)")
    counts = counts.astype(np.int64)
    times = np.broadcast_to(np.asarray(time, dtype=np.float64), len(counts))
    numbers = np.arange(counts.shape[1]) if levels is None else levels
    chosen = np.asarray(numbers, dtype=np.float64)
    if chosen.shape != (counts.shape[1],):
        raise ValueError(f"there are {chosen.size} levels, but events of {counts.shape[1]}")
    if not 0 < confidence < 1:
        raise ValueError(f"the confidence must lie in (0, 1), not {confidence}")
    if (counts < 0).any() or not (times >= 0).all() or counts[times == 0].any():
        raise ValueError(
            "numbers of events and times of observation must not be negative, and without time "
            "there is no event"
        )
    counts, times = counts[times > 0], times[times > 0]
    if not len(times):
        raise ValueError("return times need some time of observation")
    total, time_of_all = counts.sum(axis=0), float(times.sum())
    dispersion = _dispersion(counts, times)
    freedom = len(times) - 1
    clustered = np.zeros(len(total), dtype=bool)
    shrink = 1.0
    if freedom:
        critical = float(scipy.special.chdtri(freedom, 1 - confidence)) / freedom
        clustered = np.nan_to_num(dispersion) > critical
        upper = (1 + confidence) / 2
        shrink = float(scipy.special.stdtrit(freedom, upper) / scipy.special.ndtri(upper)) ** 2
    ends = [
        _interval(int(number), float(factor) * shrink if apart else 1.0, time_of_all, confidence)
        for number, factor, apart in zip(total, dispersion, clustered, strict=True)
    ]
    low, high = np.array(ends).reshape(-1, 2).T
    with np.errstate(divide="ignore"):
        return_time = time_of_all / total
    return ReturnTimes(
        chosen, total, time_of_all, return_time, low, high, dispersion, clustered, len(times)
    )


def events_in_blocks(
    observable: FloatArray,
    levels: Sequence[float] | FloatArray,
    sampling_interval: float,
    steps: int | None = None,
) -> tuple[IntArray, FloatArray]:
    """Numbers of events of series in blocks of time, and the time of each block.

    Parameters
    ----------
    observable
        Series, ``(series, samples)``, or one, ``(samples,)``.
    levels
        Levels of the observable, ``(levels,)``.
    sampling_interval
        Time between two samples.
    steps
        Steps in each block: much more than the process remembers. A remainder at the end of a
        series is a shorter block. None: each series is a block.

    Returns
    -------
    events, time
        ``(blocks, levels)`` and ``(blocks,)``, as `return_times` takes them.

    Examples
    --------
    >>> import numpy as np
    >>> from burstcast.statistics.return_times import events_in_blocks, return_times
    >>> wave = np.sin(np.arange(20_001) * np.pi / 10)
    >>> found = return_times(*events_in_blocks(wave, [0.5, 2.0], 0.1, steps=1000), [0.5, 2.0])
    >>> found.events.tolist(), found.return_time.tolist()
    ([1000, 0], [2.0, inf])
    """
    series = np.atleast_2d(observable)
    if series.ndim != 2 or series.shape[1] < 2:
        raise ValueError("events need series of two samples at least, (series, samples)")
    if steps is not None and steps < 1:
        raise ValueError(f"a block must last a step at least, not {steps}")
    crossings = np.stack([upward_crossings(series, level)[:, 1:] for level in levels], axis=-1)
    length = crossings.shape[1]
    starts = np.arange(0, length, steps or length)
    counts = np.add.reduceat(crossings.astype(np.int64), starts, axis=1)
    lengths = np.diff(np.append(starts, length)) * sampling_interval
    return counts.reshape(-1, len(levels)), np.tile(lengths, len(series))


def _dispersion(counts: IntArray, times: FloatArray) -> FloatArray:
    """Pearson's chi-squared of counts in blocks over its degrees of freedom, ``(levels,)``."""
    result = np.full(counts.shape[1], np.nan)
    seen = counts.any(axis=0)
    if len(times) > 1:
        expected = np.outer(times / times.sum(), counts[:, seen].sum(axis=0))
        squares = np.square(counts[:, seen] - expected) / expected
        result[seen] = squares.sum(axis=0) / (len(times) - 1)
    return result


def _interval(events: int, worth: float, time: float, confidence: float) -> tuple[float, float]:
    """Interval of a return time; ``worth``: events for one independent event."""
    if not events:
        return 1 / rate_bound(time, confidence), math.inf
    low, high = poisson_interval(events / worth, time / worth, confidence)
    return 1 / high, 1 / low if low else math.inf
