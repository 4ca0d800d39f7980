"""Monitor with random alarms: a baseline."""

from dataclasses import dataclass

from burstcast.arrays import BoolArray, ByteArray, FloatArray, IntArray
from burstcast.control.monitors.base import Monitor


@dataclass(frozen=True)
class RandomMonitor(Monitor):
    """Raises random alarms: control without information.

    Attributes
    ----------
    alarm_probability
        Alarm probability of each forecast. With the share of forecasts that were alarms under a
        network (its outcome's ``alarm_rate``), the flow spends as much time under actuation.
    draws
        Uniform random numbers in [0, 1), ``(flows, forecasts)``: row i is for flow i, so that what
        happens in one flow does not depend on the others. `Timing.most_forecasts` bounds their
        number.
    """

    alarm_probability: float
    draws: FloatArray

    def __post_init__(self) -> None:
        """Check the probability.

        Raises
        ------
        ValueError
            If it does not lie in [0, 1].
        """
        if not 0 <= self.alarm_probability <= 1:
            raise ValueError(
                f"the probability of an alarm must lie in [0, 1], not {self.alarm_probability}"
            )

    def alarms(
        self,
        rows: IntArray,
        forecast_number: IntArray,
        washout: FloatArray,
        acting: ByteArray | None = None,
    ) -> BoolArray:
        """Compare the flows' own random numbers with the probability (see `Monitor.alarms`)."""
        alarms: BoolArray = self.draws[rows, forecast_number] < self.alarm_probability
        return alarms
