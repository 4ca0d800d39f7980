"""Where the axis of an observable begins: at zero for one that is never negative, as an energy."""

import numpy as np

from burstcast.arrays import FloatArray

_MARGIN = 0.06


def axis_floor(*curves: FloatArray) -> float:
    """Lower end of an axis that shows these curves; NaN where there is nothing."""
    low = min(float(np.nanmin(curve)) for curve in curves)
    high = max(float(np.nanmax(curve)) for curve in curves)
    return 0.0 if low >= 0.0 else low - _MARGIN * (high - low)
