"""The reliability diagram with consistency bars.

Source: Broecker & Smith, "Increasing the reliability of reliability diagrams", Weather and
Forecasting 22 (2007). Their consistency bars resample the forecasts and draw outcomes as likely as
the forecasts say: what a reliable forecaster would show. Here whole series are resampled.
"""

from dataclasses import dataclass

import numpy as np

from burstcast.base.arrays import FloatArray, IntArray
from burstcast.base.resampling import percentile_interval
from burstcast.forecasts.brier import Binned, binned
from burstcast.forecasts.outcomes import Outcomes


@dataclass(frozen=True)
class ReliabilityDiagram:
    """Frequencies of events by bins of probability; arrays of shape ``(bins,)``."""

    whole: Binned  #: the forecasts in each bin
    #: low, high: consistency bars: where the frequency of a reliable forecaster would lie
    low: FloatArray
    high: FloatArray


def reliability_diagram(
    outcomes: Outcomes,
    bins: int,
    weights: IntArray,
    confidence: float,
    generator: np.random.Generator,
) -> ReliabilityDiagram:
    """Reliability diagram of outcomes ``(series, levels)`` with consistency bars."""
    resampled = outcomes.resampled(weights)
    drawn = generator.binomial(resampled.points, outcomes.levels)
    frequency = binned(Outcomes(outcomes.levels, resampled.points, drawn), bins).frequency
    bars = [percentile_interval(frequency[:, column], confidence) for column in range(bins)]
    return ReliabilityDiagram(
        whole=binned(outcomes.total(), bins),
        low=np.array([low for low, _ in bars]),
        high=np.array([high for _, high in bars]),
    )
