"""Uncertainty of the objective of the search, and of differences between two points.

All points are validated on the same intervals of the same data, so that effects of an interval on
all points cancel in a difference: its standard error is far smaller than those of the objectives
themselves, and still larger than many differences in a flat valley.
"""

import numpy as np

from burstcast.base.arrays import FloatArray


def objective_uncertainty(log_errors: FloatArray) -> dict[str, FloatArray]:
    """Standard errors of objectives, and of their differences from the best one, ``(points,)``.

    ``standard_error``: Of each objective by itself, over the validation intervals. ``excess``: Of
    each objective over the best one; zero for the best. ``paired_standard_error``: Of that
    difference, over the same intervals for both; zero for the best.

    ``log_errors``: log10 of the mean square error of each point in each interval, ``(points,
    intervals)``, which are assumed to be independent. NaN for a single interval, and where infinite
    objectives (diverged forecasts) leave differences undefined.
    """
    if not len(log_errors):
        raise ValueError("the search has no point")
    best = int(np.argmin(log_errors.mean(axis=1)))
    with np.errstate(invalid="ignore"):
        excess = log_errors - log_errors[best]
        excess[best] = 0.0
        single, paired = _standard_errors(log_errors), _standard_errors(excess)
    paired[best] = 0.0
    excess = excess.mean(axis=1)
    return {"standard_error": single, "excess": excess, "paired_standard_error": paired}


def _standard_errors(samples: FloatArray) -> FloatArray:
    """Standard error of the mean of each row; NaN with a single column."""
    count = samples.shape[1]
    if count < 2:
        return np.full(len(samples), np.nan)
    return np.asarray(samples.std(axis=1, ddof=1) / np.sqrt(count))
