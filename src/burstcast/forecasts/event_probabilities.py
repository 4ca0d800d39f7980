"""Probabilities of events that classifiers give."""

from dataclasses import dataclass
from typing import Annotated

import numpy as np

from burstcast.base.arrays import FloatArray
from burstcast.base.files.described import Described
from burstcast.base.files.units import LYAPUNOV_TIMES, NUMBER, OBSERVABLE


@dataclass(frozen=True)
class EventProbabilities:
    """Probabilities of one event at many starting points, by prediction time."""

    probability: Annotated[
        FloatArray,
        Described(
            "point prediction_time",
            NUMBER,
            "probability of an event in the window at each prediction time, not calibrated",
        ),
    ]
    prediction_time_lt: Annotated[
        FloatArray,
        Described("prediction_time", LYAPUNOV_TIMES, "time from the starting point to the window"),
    ]
    #: a single number
    event_threshold: Annotated[
        FloatArray, Described("threshold", OBSERVABLE, "observable that the event reaches")
    ]

    def at(self, prediction_time_lt: float, event_threshold: float) -> FloatArray:
        """Probabilities at one prediction time, ``(points,)``."""
        (columns,) = np.nonzero(self.prediction_time_lt == prediction_time_lt)
        threshold = self.event_threshold.item()
        if event_threshold != threshold or not columns.size:
            raise ValueError(
                f"probabilities are of events beyond {threshold:g} and prediction times "
                f"{self.prediction_time_lt.tolist()}, not of {event_threshold:g} and "
                f"{prediction_time_lt:g}"
            )
        return np.asarray(self.probability[:, columns[0]])
