"""The event threshold as a quantile over the training series."""

import numpy as np

from burstcast.base.arrays import FloatArray


def threshold_at(quantile: float, observable: FloatArray) -> float:
    """Event threshold: a share ``quantile`` of the samples of the observable lies below it.

    ``observable``: Observable of the training series alone, of any shape.
    """
    if not 0 < quantile < 1:
        raise ValueError(f"a quantile lies between 0 and 1, not at {quantile}")
    if observable.size == 0 or not np.isfinite(observable).all():
        raise ValueError("a quantile is taken of finite samples, one at least")
    threshold = float(np.quantile(observable, quantile))
    tied = f"which {(observable == threshold).mean():.0%} of the samples have"
    if not observable.max() > threshold:
        raise ValueError(
            f"no sample is above the quantile {quantile} of the observable: it is {threshold:g}, "
            f"the highest value, {tied}; where an event is at or above it, give the number itself "
            f"as event_threshold: {threshold:g}"
        )
    if not observable.min() < threshold:
        above = float(observable[observable > threshold].min())
        share = (observable < above).mean()
        raise ValueError(
            f"no sample is below the quantile {quantile} of the observable: it is {threshold:g}, "
            f"the lowest value, {tied}; give a number above it, or a quantile above {share:.4g}"
        )
    return threshold
