"""Monitor without forecasts: an alarm where an observed quantity is high now."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from burstcast.arrays import BoolArray, ByteArray, FloatArray, IntArray
from burstcast.control.monitors.base import Decision, Monitor


@dataclass(frozen=True)
class ObservedMonitor(Monitor):
    """Raises an alarm if a quantity of the last observed state is at or above a level.

    Attributes
    ----------
    observable
        Function from states ``(dimension, ...)`` to the watched quantity ``(...)``.
    level
        Level of the quantity.
    push
        Function from states ``(dimension, ...)`` to a quantity: where it is negative, an alarm
        sets off the reversed actuation. None: the actuation is never reversed.
    """

    observable: Callable[[FloatArray], FloatArray]
    level: float
    push: Callable[[FloatArray], FloatArray] | None = None

    def decide(
        self,
        rows: IntArray,
        forecast_number: IntArray,
        washout: FloatArray,
        acting: ByteArray | None = None,
    ) -> Decision:
        """Compare with the level, and push in the direction asked for (see `Monitor.decide`)."""
        alarm = self.alarms(rows, forecast_number, washout, acting)
        reverse = None if self.push is None else np.asarray(self.push(washout[-1]) < 0)
        return Decision(alarm, reverse=reverse)

    def alarms(
        self,
        rows: IntArray,
        forecast_number: IntArray,
        washout: FloatArray,
        acting: ByteArray | None = None,
    ) -> BoolArray:
        """Compare the last observed state with the level (see `Monitor.alarms`)."""
        alarms: BoolArray = self.observable(washout[-1]) >= self.level
        return alarms
