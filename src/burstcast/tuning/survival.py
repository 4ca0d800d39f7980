"""Choice by survival among hyperparameters with equal objectives.

The objective measures forecasts of a few Lyapunov times. Points within its standard error of the
best one may have closed loops that leave the chaotic phase several times faster or more slowly than
the flow, which the objective does not measure.
"""

import numpy as np

from burstcast.arrays import BoolArray, FloatArray


def as_good_as_the_best(excess: FloatArray, paired_standard_error: FloatArray) -> BoolArray:
    """Whether each point is within one paired standard error of the best, ``(points,)``.

    ``excess``, ``paired_standard_error``: See `burstcast.tuning.uncertainty.ObjectiveUncertainty`,
    ``(points,)``. Where errors are not known (NaN), only the best point is chosen.
    """
    return np.asarray(excess <= paired_standard_error)


def nearest_escape_rate(rates: FloatArray, wanted: float) -> int:
    """Position of the rate that is nearest to the wanted one; the first of equals.

    ``rates``: Escape rates of closed loops, the point with the best objective first, ``(points,)``;
    NaN where all loops left so soon that there is no rate. ``wanted``: Escape rate of the data. If
    it, or every rate, is NaN, the first position is taken.
    """
    if rates.size == 0:
        raise ValueError("there is no point to choose")
    return int(np.argmin(np.nan_to_num(np.abs(rates - wanted), nan=np.inf)))
