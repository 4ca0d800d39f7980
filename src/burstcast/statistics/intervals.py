"""Intervals of means, and of the statistics of long runs."""

from collections.abc import Sequence

import numpy as np
import scipy

from burstcast.base.arrays import BoolArray, FloatArray, IntArray
from burstcast.statistics.measures import StatisticsErrors, compare
from burstcast.statistics.reductions import LongTermStatistics, SeriesReductions
from burstcast.systems.mfe_modes import ProfileMatrices


def mean_and_margin(values: Sequence[float], confidence: float) -> tuple[float, float]:
    """Mean of independent values, and half the width of its Student interval, or NaN."""
    count, mean = len(values), float(np.mean(values))
    if count < 2:
        return mean, float("nan")
    error = np.std(values, ddof=1) / np.sqrt(count)
    return mean, float(scipy.special.stdtrit(count - 1, 0.5 + 0.5 * confidence) * error)


def resampled_measures(
    reference: LongTermStatistics,
    runs: SeriesReductions,
    kept: BoolArray,
    matrices: ProfileMatrices | None,
    weights: IntArray,
) -> dict[str, FloatArray]:
    """Distances of each bootstrap sample of runs from a reference, by measure, ``(resamples,)``.

    A distance is never negative, so that resampling adds to it. ``kept``: Runs that count,
    ``(runs,)``; others are drawn and left out. ``weights``: ``(resamples, runs)``. NaN where no
    drawn run counts.
    """
    rows = np.arange(len(runs))[kept]
    resampled = [
        compare(reference, runs.merged(np.repeat(rows, sample[kept])), matrices)
        for sample in weights
    ]
    return {
        name: np.array([getattr(measures, name) for measures in resampled])
        for name in StatisticsErrors.__dataclass_fields__
    }
