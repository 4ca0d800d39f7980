"""Bootstrap over independent units: test series, events, long runs, trajectories.

What shares a series, an event or a run is drawn together; what is compared is drawn alike.
"""

import numpy as np

from burstcast.base.arrays import FloatArray, IntArray


def bootstrap_weights(count: int, resamples: int, generator: np.random.Generator) -> IntArray:
    """Number of draws of each of ``count`` units in each bootstrap sample, ``(resamples, count)``.

    Forecasters that are compared are given the same weights: what their samples share cancels.
    """
    return generator.multinomial(count, np.full(count, 1 / count), size=resamples)


def percentile_interval(samples: FloatArray, confidence: float) -> tuple[float, float]:
    """Ends between which a share of the bootstrap samples lies.

    ``samples``: Values of a statistic, ``(resamples,)``; values that are not finite are left out.
    """
    defined = samples[np.isfinite(samples)]
    if not defined.size:
        return float("nan"), float("nan")
    tail = (1 - confidence) / 2
    low, high = np.quantile(defined, [tail, 1 - tail])
    return float(low), float(high)
