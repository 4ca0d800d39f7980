"""Persistence: everything stays as it was last observed.

A baseline. It never predicts an event, which is a crossing. The time for which it stays near the
truth measures how slow the flow is.
"""

from dataclasses import dataclass
from typing import Self

import numpy as np

from burstcast.base.arrays import FloatArray
from burstcast.forecasters.base import Forecaster, ForecastingCase


@dataclass(frozen=True)
class Persistence(Forecaster):
    """Repeats the last state of the washout."""

    def fit(self, training: FloatArray, case: ForecastingCase) -> Self:
        """Nothing is learnt."""
        return self

    def start(self, washout: FloatArray) -> FloatArray:
        """Last observed state, ``(dimension, batch)``."""
        return np.ascontiguousarray(washout[-1])

    def advance(self, memory: FloatArray, steps: int) -> tuple[FloatArray, FloatArray]:
        """Repeat the state (see `Forecaster.advance`)."""
        return np.repeat(memory[np.newaxis], steps, axis=0), memory
