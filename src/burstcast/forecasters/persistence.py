"""Persistence: everything stays as it was last observed.

A baseline. It never predicts an event, which is a crossing. The time for which it stays near the
truth measures how slow the flow is.
"""

from dataclasses import dataclass
from typing import Self

import numpy as np

from burstcast.arrays import FloatArray
from burstcast.forecasters.base import Forecaster, ForecasterRecord, ForecastingCase


@dataclass(frozen=True)
class Persistence(Forecaster):
    """Repeats the last state of the washout."""

    @classmethod
    def fit(
        cls, training: FloatArray, case: ForecastingCase, parameters: FloatArray | None = None
    ) -> Self:
        """Nothing is learnt."""
        return cls()

    def record(self) -> ForecasterRecord:
        """Nothing was learnt."""
        return ForecasterRecord()

    @classmethod
    def restore(cls, record: ForecasterRecord, case: ForecastingCase) -> Self:
        """There is nothing to restore."""
        return cls()

    def start(self, washout: FloatArray, parameters: FloatArray | None = None) -> FloatArray:
        """Last observed state, ``(dimension, batch)``."""
        return np.ascontiguousarray(washout[-1])

    def advance(
        self, memory: FloatArray, steps: int, parameters: FloatArray | None = None
    ) -> tuple[FloatArray, FloatArray]:
        """Repeat the state (see `Forecaster.advance`)."""
        return np.repeat(memory[np.newaxis], steps, axis=0), memory
