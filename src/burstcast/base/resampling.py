"""Bootstrap over independent units: test series, events, long runs, trajectories.

What shares a series, an event or a run is drawn together; what is compared is drawn alike.
"""

import numpy as np

from burstcast.base.arrays import FloatArray, IntArray


def bootstrap_weights(count: int, resamples: int, generator: np.random.Generator) -> IntArray:
    """Number of draws of each of ``count`` units in each bootstrap sample, ``(resamples, ...)``."""
    return generator.multinomial(count, np.full(count, 1 / count), size=resamples)


def percentile_interval(samples: FloatArray, confidence: float) -> tuple[float, float]:
    """Ends between which a share of the finite bootstrap samples ``(resamples,)`` lies."""
    defined = samples[np.isfinite(samples)]
    if not defined.size:
        return float("nan"), float("nan")
    tail = (1 - confidence) / 2
    low, high = np.quantile(defined, [tail, 1 - tail])
    return float(low), float(high)
