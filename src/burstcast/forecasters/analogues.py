"""Analogues: continuations of the most similar states of the past.

The oldest forecaster without a model. Source: Lorenz, "Atmospheric predictability as revealed by
naturally occurring analogues", Journal of the Atmospheric Sciences 26 (1969).
"""

from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar, Self

import numpy as np
from scipy.spatial import KDTree

from burstcast.arrays import FloatArray
from burstcast.forecasters._options import AnalogueOptions
from burstcast.forecasters.base import Forecaster, ForecastingCase, fitted


@dataclass(frozen=True)
class Analogues(AnalogueOptions, Forecaster):
    """Forecasts the mean continuation of the nearest states of the training series.

    States are compared in units of each component's standard deviation. Where the series of an
    analogue ends, the mean is over the others; where all have ended, there is no forecast (it is
    not a number).
    """

    provides_ensemble: ClassVar[bool] = True

    training: FloatArray = fitted()  #: observed series, ``(series, time, dimension)``

    def __repr__(self) -> str:
        if self.training is None:
            return f"Analogues(neighbours={self.neighbours})"
        series, samples, _ = self.training.shape
        return f"Analogues({self.neighbours} of {series} series of {samples} samples)"

    def fit(self, training: FloatArray, case: ForecastingCase) -> Self:
        """Remember the series (see `Forecaster.fit`)."""
        return self.with_fitted(training=training.copy())

    @cached_property
    def _scale(self) -> FloatArray:
        scale: FloatArray = self.training.std(axis=(0, 1))
        return np.where(scale > 0, scale, 1.0)  # a constant component tells no states apart

    @cached_property
    def _tree(self) -> KDTree:
        # nothing follows the last state of a series
        candidates = self.training[:, :-1] / self._scale
        return KDTree(candidates.reshape(-1, candidates.shape[2]))

    def ensemble(self, washout: FloatArray) -> FloatArray:
        """Memories of one analogue each, ``(1, neighbours, batch)`` (see `Forecaster.ensemble`)."""
        return self.start(washout)[np.newaxis]

    def combined(self, ensemble: FloatArray) -> FloatArray:
        """Memory of all analogues (see `Forecaster.combined`)."""
        memory: FloatArray = ensemble[0]
        return memory

    def start(self, washout: FloatArray) -> FloatArray:
        """Analogues of the last observed state, ``(neighbours, batch)``.

        They are numbers of steps, counted through all series.
        """
        count = range(1, self.neighbours + 1)
        found = self._tree.query(washout[-1].T / self._scale, k=list(count))[1].T
        length = self.training.shape[1]
        # from rows of the tree, whose series are one shorter
        steps: FloatArray = (found + found // (length - 1)).astype(np.float64)
        return steps

    def advance(self, memory: FloatArray, steps: int) -> tuple[FloatArray, FloatArray]:
        """Follow the analogues (see `Forecaster.advance`); one that has ended is not a number."""
        length, dimension = self.training.shape[1:]
        states = self.training.reshape(-1, dimension)
        outputs = np.empty((steps, dimension, memory.shape[1]))
        for step in range(steps):
            memory = np.where((memory + 1) % length == 0, np.nan, memory + 1)
            total, count = np.zeros(outputs.shape[1:]), np.zeros(memory.shape[1])
            for place in memory:
                going = np.isfinite(place)
                total[:, going] += states[place[going].astype(int)].T
                count += going
            with np.errstate(invalid="ignore"):
                outputs[step] = total / count
        return outputs, memory
