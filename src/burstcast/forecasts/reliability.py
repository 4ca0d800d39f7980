"""Consistency bars of the reliability diagram.

Source: Broecker & Smith, "Increasing the reliability of reliability diagrams", Weather and
Forecasting 22 (2007). Their consistency bars resample the forecasts and draw outcomes as likely as
the forecasts say: what a reliable forecaster would show. Here whole series are resampled.
"""

import numpy as np

from burstcast.base.arrays import FloatArray, IntArray
from burstcast.base.resampling import percentile_interval
from burstcast.forecasts.brier import binned
from burstcast.forecasts.outcomes import Outcomes


def consistency_bars(
    outcomes: Outcomes,
    bins: int,
    weights: IntArray,
    confidence: float,
    generator: np.random.Generator,
) -> FloatArray:
    """Ends between which frequencies of a reliable forecaster would lie, ``(2, bins)``.

    ``outcomes``: By series, ``(series, levels)``.
    """
    resampled = outcomes.resampled(weights)
    drawn = generator.binomial(resampled.points, outcomes.levels)
    frequency = binned(Outcomes(outcomes.levels, resampled.points, drawn), bins).frequency
    return np.array([percentile_interval(of_bin, confidence) for of_bin in frequency.T]).T
