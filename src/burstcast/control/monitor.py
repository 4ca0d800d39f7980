"""Who watches the flow: monitors raise alarms from what has been observed.

Source: section "Control of extreme events" of the paper.
"""

import abc
from collections.abc import Callable
from dataclasses import dataclass

from burstcast.arrays import BoolArray, FloatArray, IntArray
from burstcast.control.timing import Timing
from burstcast.forecast import windows
from burstcast.forecast.base import Forecaster


class Monitor(abc.ABC):
    """Raises alarms in many flows at once, in each independently of the others."""

    @abc.abstractmethod
    def alarms(self, rows: IntArray, occasions: IntArray, washout: FloatArray) -> BoolArray:
        """Whether an event is expected in the window.

        Parameters
        ----------
        rows
            Which flows they are, ``(batch,)``.
        occasions
            How often each of them has been monitored before, ``(batch,)``.
        washout
            Observed states up to and including now, ``(steps, dimension, batch)``.

        Returns
        -------
        ``(batch,)``.
        """


@dataclass(frozen=True)
class ForecastMonitor(Monitor):
    """Raises an alarm if the forecast crosses the event threshold in the window.

    Attributes
    ----------
    forecaster
        Who forecasts: a network, or the equations.
    observable
        From states ``(dimension, ...)`` to the observable ``(...)``.
    timing
        Where the window lies.
    threshold
        The event threshold, k_e.
    """

    forecaster: Forecaster
    observable: Callable[[FloatArray], FloatArray]
    timing: Timing
    threshold: float

    def alarms(self, rows: IntArray, occasions: IntArray, washout: FloatArray) -> BoolArray:
        """Forecast, and look for a crossing (see `Monitor.alarms`)."""
        memory = self.forecaster.start(washout)
        forecast, _ = self.forecaster.advance(memory, self.timing.window_end)
        return crosses_in_window(
            self.observable(forecast.transpose(1, 0, 2)), self.timing, self.threshold
        )


@dataclass(frozen=True)
class RandomMonitor(Monitor):
    """Raises alarms at random: what control achieves without knowing anything.

    Attributes
    ----------
    alarm_probability
        Of each forecast. With the share of forecasts that were alarms under a network
        (`burstcast.control.accounting.Accounting.alarm_rate`), the flow spends as much time under
        actuation.
    draws
        Uniform random numbers in [0, 1), ``(flows, occasions)``: row i is for flow i, so that what
        happens in one flow does not depend on the others. `Timing` bounds the occasions (see
        `most_forecasts`).
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

    def alarms(self, rows: IntArray, occasions: IntArray, washout: FloatArray) -> BoolArray:
        """Compare the flows' own random numbers with the probability (see `Monitor.alarms`)."""
        alarms: BoolArray = self.draws[rows, occasions] < self.alarm_probability
        return alarms


def most_forecasts(timing: Timing) -> int:
    """Most forecasts that a flow can see: one per window, up to the last step that counts."""
    return (timing.window_end + timing.span_steps) // timing.window_steps + 1


def crosses_in_window(observable: FloatArray, timing: Timing, threshold: float) -> BoolArray:
    """Whether the observable crosses the threshold in the window (see `windows.crosses`).

    Parameters
    ----------
    observable
        ``(steps, batch)``; entry 0 is one step after the forecast was made.
    timing
        Where the window lies.
    threshold
        The event threshold, k_e.
    """
    summaries = windows.summarise(observable, (timing.window_start, timing.window_end))
    return windows.crosses(summaries, 0, 1, threshold)
