"""Ends of the axis of an observable: from zero for one that comes near it, as an energy."""

import numpy as np

from burstcast.arrays import FloatArray

_MARGIN, _NAME = 0.06, 0.2


def axis_floor(*curves: FloatArray) -> float:
    """Lower end of an axis that shows these curves; NaN where there is nothing.

    Zero where the curves are never negative and come near it, or else a margin below them.
    """
    low = min(float(np.nanmin(curve)) for curve in curves)
    high = max(float(np.nanmax(curve)) for curve in curves)
    return 0.0 if 0.0 <= low < high / 4 else low - _MARGIN * (high - low)


def axis_limits(threshold: float, *curves: FloatArray) -> tuple[float, float]:
    """Ends of an axis that shows these curves and the event threshold, with room for its name."""
    floor = axis_floor(*curves, np.array(threshold))
    high = max(float(np.nanmax(curve)) for curve in curves)
    top = max(high + _MARGIN * (high - floor), threshold + _NAME * (max(high, threshold) - floor))
    return floor, top
