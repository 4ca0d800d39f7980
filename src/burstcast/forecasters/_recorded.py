"""Forecasts of other programs, identified by their washouts."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Self

import numpy as np

from burstcast.arrays import FloatArray
from burstcast.forecast.horizon import HorizonSearch, prediction_horizons
from burstcast.forecasters.base import Forecaster, ForecasterRecord, ForecastingCase


@dataclass(frozen=True)
class RecordedForecasts(Forecaster):
    """Repeats recorded forecasts. A memory is the row of a forecast and its past steps."""

    #: observed components up to each starting point, ``(points, steps, dimension)``
    washouts: FloatArray
    #: forecasts from these points, ``(points, steps, components)``. The components may differ from
    #: the components of the washouts: the observable alone, for example.
    outputs: FloatArray

    @cached_property
    def _rows(self) -> Mapping[bytes, int]:
        return {_key(washout): row for row, washout in enumerate(self.washouts)}

    @classmethod
    def fit(
        cls, training: FloatArray, case: ForecastingCase, parameters: FloatArray | None = None
    ) -> Self:
        """Raise `NotImplementedError`: recorded forecasts are not learnt."""
        raise NotImplementedError("recorded forecasts are not learnt from series")

    def record(self) -> ForecasterRecord:
        """Washouts and forecasts."""
        return ForecasterRecord({"washouts": self.washouts, "outputs": self.outputs})

    @classmethod
    def restore(cls, record: ForecasterRecord, case: ForecastingCase) -> Self:
        """Make the forecaster from washouts and forecasts."""
        return cls(record.arrays["washouts"], record.arrays["outputs"])

    def start(self, washout: FloatArray, parameters: FloatArray | None = None) -> FloatArray:
        """Row of the forecast that continues each washout, and 0 steps: ``(2, batch)``."""
        keys = [_key(one) for one in washout.transpose(2, 0, 1)]
        unknown = [key for key in keys if key not in self._rows]
        if unknown:
            raise ValueError(f"{len(unknown)} of {len(keys)} washouts have no recorded forecast")
        rows = np.array([self._rows[key] for key in keys], dtype=np.float64)
        return np.stack([rows, np.zeros(len(rows))])

    def advance(
        self, memory: FloatArray, steps: int, parameters: FloatArray | None = None
    ) -> tuple[FloatArray, FloatArray]:
        """Repeat the next steps of the forecasts (see `Forecaster.advance`)."""
        rows, done = memory.astype(np.int64)
        if done.size and done.max() + steps > self.outputs.shape[1]:
            raise ValueError(
                f"recorded forecasts have {self.outputs.shape[1]} steps, and "
                f"{done.max() + steps} are requested"
            )
        outputs = self.outputs[rows[:, np.newaxis], done[:, np.newaxis] + np.arange(steps)]
        later = np.stack([memory[0], memory[1] + steps])
        return np.ascontiguousarray(outputs.transpose(1, 2, 0)), later


def recorded_horizons(
    washouts: FloatArray,
    observable: FloatArray,
    observed: FloatArray,
    truth: FloatArray,
    search: HorizonSearch,
) -> FloatArray:
    """Prediction horizons of recorded forecasts, in Lyapunov times, ``(events,)``.

    ``washouts``, ``observable``: Starting points, ``(points, steps, dimension)``, and forecasts
    from them, ``(points, steps)``. ``observed``, ``truth``, ``search``: Events, as
    `burstcast.forecast.horizon.prediction_horizons` takes them.
    """
    recorded = RecordedForecasts(washouts, observable[..., np.newaxis])
    return prediction_horizons(recorded, lambda outputs: outputs[0], observed, truth, search)


def _key(washout: FloatArray) -> bytes:
    return np.ascontiguousarray(washout, dtype=np.float64).tobytes()
