"""Choice by survival among hyperparameters with equal objectives.

The objective looks at forecasts of a few Lyapunov times. Points within its own error of the best
one may have closed loops that leave the chaotic phase several times as fast or as slowly as the
flow does; nothing in the objective sees that.
"""

import numpy as np

from burstcast.arrays import BoolArray, FloatArray


def as_good_as_the_best(excess: FloatArray, paired_standard_error: FloatArray) -> BoolArray:
    """Points within one paired standard error of the best, which is included, ``(points,)``.

    ``excess``, ``paired_standard_error``: Excess and paired standard error of
    `burstcast.tuning.uncertainty.ObjectiveUncertainty`, ``(points,)``. Where the error is not known
    (NaN), only the best is as good as itself.
    """
    return np.asarray(excess <= paired_standard_error)


def nearest_escape_rate(rates: FloatArray, wanted: float) -> int:
    """Position of the rate that is nearest to the wanted one; the first of equals.

    ``rates``: Escape rates of closed loops, the point with the best objective first, ``(points,)``.
    NaN where all loops left so soon that there is no rate. ``wanted``: Wanted rate: the rate of the
    data. Where it is not known (NaN), or no rate is, the first position is taken.
    """
    if rates.size == 0:
        raise ValueError("there is no point to choose")
    return int(np.argmin(np.nan_to_num(np.abs(rates - wanted), nan=np.inf)))
