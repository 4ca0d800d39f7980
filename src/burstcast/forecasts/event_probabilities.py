"""Probabilities of events that classifiers give, and their variables in a file."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Self

import numpy as np

from burstcast.base.arrays import FloatArray
from burstcast.base.files.netcdf import Variable
from burstcast.base.files.units import LYAPUNOV_TIMES, NUMBER, OBSERVABLE


@dataclass(frozen=True)
class EventProbabilities:
    """Probabilities of one event at many starting points, by prediction time."""

    probability: FloatArray  #: ``(points, prediction times)``
    #: Lyapunov times from a point to its window, ``(prediction times,)``
    prediction_time_lt: FloatArray
    event_threshold: float  #: observable that the event reaches

    def at(self, prediction_time_lt: float, event_threshold: float) -> FloatArray:
        """Probabilities at one prediction time, ``(points,)``."""
        (columns,) = np.nonzero(self.prediction_time_lt == prediction_time_lt)
        if event_threshold != self.event_threshold or not columns.size:
            raise ValueError(
                f"probabilities are of events beyond {self.event_threshold:g} and prediction times "
                f"{self.prediction_time_lt.tolist()}, not of {event_threshold:g} and "
                f"{prediction_time_lt:g}"
            )
        return np.asarray(self.probability[:, columns[0]])

    def variables(self) -> dict[str, Variable]:
        """Variables of a file, from which `restore` recreates the probabilities."""
        return {
            "probability": Variable(
                ("point", "prediction_time"),
                self.probability,
                NUMBER,
                "probability of an event in the window at each prediction time, not calibrated",
            ),
            "prediction_time_lt": Variable(
                ("prediction_time",),
                self.prediction_time_lt,
                LYAPUNOV_TIMES,
                "time from the starting point to the window",
            ),
            "event_threshold": Variable(
                ("threshold",),
                np.array([self.event_threshold]),
                OBSERVABLE,
                "observable that the event reaches",
            ),
        }

    @classmethod
    def restore(cls, arrays: Mapping[str, Any]) -> Self:
        """Probabilities from the variables of their file."""
        times, threshold = arrays["prediction_time_lt"], float(arrays["event_threshold"][0])
        return cls(arrays["probability"], times, threshold)
