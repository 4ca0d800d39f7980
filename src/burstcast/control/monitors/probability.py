"""The monitor by probabilities: an alarm where a classifier gives an event a high probability."""

from dataclasses import dataclass

import numpy as np

from burstcast.arrays import BoolArray, ByteArray, FloatArray, IntArray
from burstcast.control.monitors.base import Monitor
from burstcast.forecasters._event_classifier import EventClassifier


@dataclass(frozen=True)
class ProbabilityMonitor(Monitor):
    """Raises an alarm if an event is at least as probable as a level in any prediction window.

    Attributes
    ----------
    classifier
        Gives the probability of an event in each of its windows.
    windows
        How many of its windows count, from the first.
    level
        Probability at which an alarm is raised.
    """

    classifier: EventClassifier
    windows: int
    level: float

    def alarms(
        self,
        rows: IntArray,
        forecast_number: IntArray,
        washout: FloatArray,
        acting: ByteArray | None = None,
    ) -> BoolArray:
        """Compare probabilities with the level (see `Monitor.alarms`)."""
        given = np.ascontiguousarray(washout.transpose(2, 0, 1))
        probabilities = self.classifier.probabilities(given)[:, : self.windows]
        return np.asarray((probabilities >= self.level).any(axis=1))
