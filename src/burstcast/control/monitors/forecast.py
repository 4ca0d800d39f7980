"""The monitor that forecasts: an alarm where the forecast crosses the event threshold.

Source: section "Control of extreme events" of the paper.
"""

from collections.abc import Callable
from dataclasses import dataclass

from burstcast.arrays import BoolArray, ByteArray, FloatArray, IntArray
from burstcast.control.monitors.base import Monitor
from burstcast.control.timing import Timing
from burstcast.forecast import windows
from burstcast.forecasters.base import Forecaster


@dataclass(frozen=True)
class ForecastMonitor(Monitor):
    """Raises an alarm if the forecast crosses the event threshold in the window.

    Attributes
    ----------
    forecaster
        A forecaster of any kind.
    observable
        Function from states ``(dimension, ...)`` to the observable ``(...)``.
    timing
        Where the window lies.
    threshold
        The event threshold, k_e.
    """

    forecaster: Forecaster
    observable: Callable[[FloatArray], FloatArray]
    timing: Timing
    threshold: float

    def alarms(
        self,
        rows: IntArray,
        forecast_number: IntArray,
        washout: FloatArray,
        acting: ByteArray | None = None,
    ) -> BoolArray:
        """Forecast, and look for a crossing (see `Monitor.alarms`)."""
        memory = self.forecaster.start(washout)
        forecast, _ = self.forecaster.advance(memory, self.timing.window_end)
        return windows.crosses_in_window(
            self.observable(forecast.transpose(1, 0, 2)),
            self.timing.window_start,
            self.timing.window_end,
            self.threshold,
        )
