"""Analogues: continuations of the most similar states of the past.

The oldest forecaster without a model. Source: Lorenz, "Atmospheric predictability as revealed by
naturally occurring analogues", Journal of the Atmospheric Sciences 26 (1969).
"""

from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar, Self

import numpy as np
import scipy

from burstcast.base.arrays import BoolArray, FloatArray, IntArray
from burstcast.base.series_lengths import samples_of, series_lengths
from burstcast.forecasters._options import AnalogueOptions
from burstcast.forecasters.base import Forecaster, ForecasterRecord, ForecastingCase, fitted


@dataclass(frozen=True)
class Analogues(AnalogueOptions, Forecaster):
    """Forecasts the mean continuation of the nearest states of the training series.

    States are compared in units of each component's standard deviation. Where the series of an
    analogue ends, the mean is over the others; where all have ended, there is no forecast (it is
    not a number).
    """

    provides_ensemble: ClassVar[bool] = True
    tolerated_invalid: ClassVar[float] = 0.25
    why_invalid: ClassVar[str] = (
        "the series of an analogue ends before the window does; longer series have fewer of them"
    )

    #: observed series, ``(series, time, dimension)``; of unequal lengths, one after the other,
    #: ``(samples, dimension)``
    training: FloatArray = fitted()
    #: samples of each series, ``(series,)``; None: series of equal lengths
    lengths: FloatArray | None = fitted()

    def __repr__(self) -> str:
        if self.training is None:
            return f"Analogues(neighbours={self.neighbours})"
        series = len(self.training if self.lengths is None else self.lengths)
        samples = len(self._states)
        return f"Analogues({self.neighbours} of {samples} samples of {series} series)"

    def fit(self, training: FloatArray, case: ForecastingCase) -> Self:
        """Remember the series (see `Forecaster.fit`)."""
        samples = samples_of(training).shape[0] - len(training)
        if self.neighbours > samples:
            raise ValueError(
                f"neighbours is {self.neighbours}, but the training series have {samples} samples "
                f"that others follow: fewer neighbours, or more series"
            )
        if (lengths := series_lengths(training)) is None:
            return self.with_fitted(training=training.copy(), lengths=None)  # of an earlier fit
        return self.with_fitted(training=samples_of(training), lengths=lengths.astype(np.float64))

    def record(self) -> ForecasterRecord:
        """Series, and their lengths if these are unequal."""
        lengths = {} if self.lengths is None else {"lengths": self.lengths}
        return ForecasterRecord({"training": self.training, **lengths})

    def restore(self, record: ForecasterRecord, case: ForecastingCase) -> Self:
        """Take the series from their record."""
        return self.with_fitted(**record.arrays)

    @cached_property
    def _states(self) -> FloatArray:
        """Samples of all series, one after the other, ``(samples, dimension)``."""
        return self.training.reshape(-1, self.training.shape[-1])

    @cached_property
    def _last(self) -> BoolArray:
        """Whether a sample is the last of its series, ``(samples,)``."""
        last = np.zeros(len(self._states), dtype=bool)
        if self.lengths is None:
            last[self.training.shape[1] - 1 :: self.training.shape[1]] = True
        else:
            last[np.cumsum(self.lengths).astype(int) - 1] = True
        return last

    @cached_property
    def _end(self) -> IntArray:
        """Last sample of the series of each sample, ``(samples,)``."""
        ends = np.flatnonzero(self._last)
        return ends[np.searchsorted(ends, np.arange(len(self._states)))]

    @cached_property
    def _scale(self) -> FloatArray:
        scale: FloatArray = self._states.std(axis=0)
        return np.where(scale > 0, scale, 1.0)  # a constant component tells no states apart

    @cached_property
    def _tree(self) -> "scipy.spatial.KDTree":
        # nothing follows the last state of a series
        return scipy.spatial.KDTree(self._states[~self._last] / self._scale)

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
        nearest = self._tree.query(washout[-1].T / self._scale, k=list(count))[1].T
        # from rows of the tree, whose series are one shorter
        steps: FloatArray = np.flatnonzero(~self._last)[nearest].astype(np.float64)
        return steps

    def advance(self, memory: FloatArray, steps: int) -> tuple[FloatArray, FloatArray]:
        """Follow the analogues (see `Forecaster.advance`); one that has ended is not a number."""
        known = np.isfinite(memory)
        places = np.where(known, memory, 0).astype(int)
        left = np.where(known, self._end[places] - places, 0)
        ahead, batch = np.arange(1, steps + 1)[:, np.newaxis], memory.shape[1]
        total, count = np.zeros((steps, self._states.shape[1], batch)), np.zeros((steps, 1, batch))
        for place, until in zip(places, left, strict=True):
            going = ahead <= until
            continuation = self._states[np.where(going, place + ahead, 0)].transpose(0, 2, 1)
            going = going[:, np.newaxis]
            total += np.where(going, continuation, 0.0)
            count += going
        with np.errstate(invalid="ignore"):
            outputs = total / count
        return outputs, np.where(steps <= left, memory + steps, np.nan)
