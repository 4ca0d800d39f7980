"""When a forecast is no forecast: not finite, or far outside of what training has seen."""

from dataclasses import dataclass
from typing import Self

import numpy as np

from burstcast.base.arrays import BoolArray, FloatArray

DIVERGENCE_BOUND = 10.0
"""A forecast is invalid further than this many training ranges from the middle of the range."""


@dataclass(frozen=True)
class TrainingLimits:
    """Smallest and largest value of each component in the training series."""

    low: FloatArray  #: ``(dimension,)``
    high: FloatArray  #: ``(dimension,)``

    @classmethod
    def of(cls, training: FloatArray, dimension: int) -> Self:
        """Limits of the first components of series; NaN where shorter series have ended.

        ``training``: ``(series, time, component)``.
        """
        states = training[..., :dimension]
        return cls(np.nanmin(states, axis=(0, 1)), np.nanmax(states, axis=(0, 1)))

    def outside(self, outputs: FloatArray, bound: float) -> BoolArray:
        """Steps of forecasts ``(steps, dimension, batch)`` beyond the bound, ``(steps, batch)``.

        A component that is constant in training has no range, and no bound. What is not finite is
        outside.
        """
        extent = self.high - self.low
        reach = np.where(extent > 0, bound * extent, np.inf)
        middle = self.low + 0.5 * extent
        lowest, highest = (middle - reach)[:, np.newaxis], (middle + reach)[:, np.newaxis]
        inside = (outputs >= lowest) & (outputs <= highest) & np.isfinite(outputs)
        return np.asarray(~inside.all(axis=1))
