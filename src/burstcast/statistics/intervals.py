"""Bootstrap intervals over runs for the statistics of long runs."""

import numpy as np

from burstcast.base.arrays import BoolArray, FloatArray, IntArray
from burstcast.statistics.measures import Measures, compare
from burstcast.statistics.reductions import LongTermStatistics, SeriesReductions
from burstcast.systems.mfe_modes import ProfileMatrices


def resampled_measures(
    reference: LongTermStatistics,
    runs: SeriesReductions,
    kept: BoolArray,
    matrices: ProfileMatrices | None,
    weights: IntArray,
) -> dict[str, FloatArray]:
    """Distances of each bootstrap sample of runs from a reference, which is taken as it is.

    A distance is never negative, so that the scatter of resampling adds to it: where a network is
    as near to the data as its runs can tell, the samples lie above the distance itself.

    ``kept``: Runs that count, ``(runs,)``; discarded runs are drawn, too, and left out.
    ``weights``: How often each run is in each sample, ``(resamples, runs)``
    (`burstcast.base.resampling.bootstrap_weights`). By measure, ``(resamples,)``; NaN where a
    sample has no run that counts.
    """
    rows = np.arange(len(runs))[kept]
    resampled = [
        compare(reference, runs.merged(np.repeat(rows, sample[kept])), matrices)
        for sample in weights
    ]
    return {
        name: np.array([getattr(measures, name) for measures in resampled])
        for name in Measures.__dataclass_fields__
    }
