"""Intervals of the statistics of long runs."""

import numpy as np

from burstcast.base.arrays import BoolArray, FloatArray, IntArray
from burstcast.statistics.measures import StatisticsErrors, compare
from burstcast.statistics.reductions import LongTermStatistics, SeriesReductions
from burstcast.systems.mfe_modes import ProfileMatrices


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
