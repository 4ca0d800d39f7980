"""The monitor that looks ahead to a horizon: an alarm where the forecast holds an event."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from burstcast.arrays import BoolArray, ByteArray, FloatArray, IntArray
from burstcast.control.actuation import ActuationValues
from burstcast.control.monitors.base import Monitor
from burstcast.forecasters.base import Forecaster, for_members


@dataclass(frozen=True)
class HorizonMonitor(Monitor):
    """Raises an alarm if the forecast is at or above a level anywhere up to the horizon.

    An event that is under way counts like one that is still to come: unlike in a window, it is not
    asked whether the forecast was below the level before. A forecast counts as long as it is
    finite.

    A forecaster that knows the parameters may be given the past actuation and the actuation already
    triggered. It then forecasts the flow with the actuator off from the step at which the decision
    takes effect, and only later steps count.

    Attributes
    ----------
    forecaster
        Forecaster.
    observable
        Function from states ``(dimension, ...)`` to the observable ``(...)``.
    horizon
        Steps that are looked ahead.
    level
        Level of the observable: the event threshold less a margin.
    values
        Values of the parameters with the actuator off and on, given to the forecaster; None: the
        forecaster does not know the actuation.
    """

    forecaster: Forecaster
    observable: Callable[[FloatArray], FloatArray]
    horizon: int
    level: float
    values: ActuationValues | None = None

    def __post_init__(self) -> None:
        """Check the horizon.

        Raises
        ------
        ValueError
            If it is shorter than one step.
        """
        if self.horizon < 1:
            raise ValueError("a horizon must reach a step ahead")

    def alarms(
        self,
        rows: IntArray,
        forecast_number: IntArray,
        washout: FloatArray,
        acting: ByteArray | None = None,
    ) -> BoolArray:
        """Forecast, and look for the level (see `Monitor.alarms`)."""
        if self.values is None:
            memory = self.forecaster.start(washout)
            forecast, _ = self.forecaster.advance(memory, self.horizon)
        else:
            memory, delay = told_memory(self.forecaster, washout, acting, self.values)
            off = np.zeros((self.horizon - delay, memory.shape[-1]), dtype=bool)
            forecast, _ = self.forecaster.advance(memory, len(off), self.values.schedule(off))
        observable = self.observable(forecast.transpose(1, 0, 2))
        reached = (observable >= self.level) & np.isfinite(observable)
        return np.asarray(reached.any(axis=0))


def told_memory(
    forecaster: Forecaster,
    washout: FloatArray,
    acting: ByteArray | None,
    values: ActuationValues,
) -> tuple[FloatArray, int]:
    """Memory of a forecaster at the step at which a decision takes effect.

    Parameters
    ----------
    forecaster
        Forecaster that knows the parameters.
    washout, acting
        As in `Monitor.alarms`.
    values
        Values of the parameters with the actuator off and on.

    Returns
    -------
    The memory, which has followed the actuation that is on its way, and the steps of that.

    Raises
    ------
    ValueError
        If the actuation is unknown.
    """
    if acting is None:
        raise ValueError("the forecaster needs the actuation, which is unknown")
    past, pending = np.split(acting, [len(washout) - 1])
    memory = forecaster.start(washout, values.schedule(past))
    if len(pending):
        members = memory.shape[-1] // washout.shape[-1]
        schedule = for_members(values.schedule(pending), members)
        _, memory = forecaster.advance(memory, len(pending), schedule)
    return memory, len(pending)
