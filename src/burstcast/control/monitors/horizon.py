"""The monitor that looks ahead to a horizon: an alarm where the forecast holds an event."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from burstcast.arrays import BoolArray, FloatArray, IntArray
from burstcast.control.monitors.base import Monitor
from burstcast.forecasters.base import Forecaster


@dataclass(frozen=True)
class HorizonMonitor(Monitor):
    """Raises an alarm if the forecast is at or above a level anywhere up to the horizon.

    An event that is under way counts like one that is still to come: unlike in a window, it is not
    asked whether the forecast was below the level before. A forecast counts as long as it is
    finite.

    Attributes
    ----------
    forecaster
        Who forecasts.
    observable
        From states ``(dimension, ...)`` to the observable ``(...)``.
    horizon
        Steps that are looked ahead.
    level
        Of the observable: the event threshold less a margin.
    """

    forecaster: Forecaster
    observable: Callable[[FloatArray], FloatArray]
    horizon: int
    level: float

    def __post_init__(self) -> None:
        """Check the horizon.

        Raises
        ------
        ValueError
            If it is shorter than one step.
        """
        if self.horizon < 1:
            raise ValueError("a horizon must reach a step ahead")

    def alarms(self, rows: IntArray, forecast_number: IntArray, washout: FloatArray) -> BoolArray:
        """Forecast, and look for the level (see `Monitor.alarms`)."""
        memory = self.forecaster.start(washout)
        forecast, _ = self.forecaster.advance(memory, self.horizon)
        observable = self.observable(forecast.transpose(1, 0, 2))
        reached = (observable >= self.level) & np.isfinite(observable)
        return np.asarray(reached.any(axis=0))
