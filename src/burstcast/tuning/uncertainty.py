"""Uncertainty of the objective of the search, and of differences between two points.

All points are validated on the same intervals of the same data, so that effects of an interval on
all points cancel in a difference: its standard error is far smaller than those of the objectives
themselves, and still larger than many differences in a flat valley.
"""

from dataclasses import dataclass

import numpy as np

from burstcast.arrays import FloatArray


@dataclass(frozen=True)
class ObjectiveUncertainty:
    """Standard errors of objectives over the validation intervals; arrays ``(points,)``."""

    standard_error: FloatArray  #: standard error of each objective by itself
    excess: FloatArray  #: excess of each objective over the best one; zero for the best
    #: standard error of that difference, over the same intervals for both; zero for the best
    paired_standard_error: FloatArray


def objective_uncertainty(log_errors: FloatArray) -> ObjectiveUncertainty:
    """Standard errors of objectives, and of their differences from the best one.

    The intervals, which are Lyapunov times long, are assumed to be independent.

    ``log_errors``: log10 of the mean square error of each point (and Tikhonov parameter) in each
    interval, ``(points, intervals)``; the objective is the mean over the intervals. With a single
    interval, all standard errors but the best point's paired one are NaN; so are differences and
    errors of infinite objectives (diverged forecasts) where they are not defined.
    """
    points, intervals = log_errors.shape
    if points == 0:
        raise ValueError("the search has no point")
    objectives = log_errors.mean(axis=1)
    best = int(np.argmin(objectives))
    with np.errstate(invalid="ignore"):
        difference = log_errors - log_errors[best]
    difference[best] = 0.0
    if intervals < 2:
        unknown = np.full(points, np.nan)
        error = np.where(np.arange(points) == best, 0.0, np.nan)
        return ObjectiveUncertainty(unknown, difference.mean(axis=1), error)
    root = np.sqrt(intervals)
    with np.errstate(invalid="ignore"):
        return ObjectiveUncertainty(
            log_errors.std(axis=1, ddof=1) / root,
            difference.mean(axis=1),
            difference.std(axis=1, ddof=1) / root,
        )
