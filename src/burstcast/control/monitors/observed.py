"""The monitor that does not look ahead: an alarm where the observed observable is high now."""

from collections.abc import Callable
from dataclasses import dataclass

from burstcast.arrays import BoolArray, FloatArray, IntArray
from burstcast.control.monitors.base import Monitor


@dataclass(frozen=True)
class ObservedMonitor(Monitor):
    """Raises an alarm if the observable of the last observed state is at or above a level.

    Attributes
    ----------
    observable
        From states ``(dimension, ...)`` to the observable ``(...)``.
    level
        Of the observable.
    """

    observable: Callable[[FloatArray], FloatArray]
    level: float

    def alarms(self, rows: IntArray, forecast_number: IntArray, washout: FloatArray) -> BoolArray:
        """Compare the last observed state with the level (see `Monitor.alarms`)."""
        alarms: BoolArray = self.observable(washout[-1]) >= self.level
        return alarms
