"""The paper's strategy: an alarm for a window sets off one actuation of a given length.

Source: section "Control of extreme events" of the paper. The forecast is judged in a window after
the prediction time; an alarm sets off the case's actuation, which starts and lasts as the case
says; no forecast is made before the end of the alarm's window.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

from burstcast.arrays import FloatArray
from burstcast.control.actuation import actuation_interval
from burstcast.control.experiment import ControlExperiment, Schedule
from burstcast.control.monitors.base import Monitor
from burstcast.control.monitors.forecast import ForecastMonitor
from burstcast.control.monitors.vote import VoteMonitor
from burstcast.control.strategies.base import ControlStrategy
from burstcast.control.timing import Timing
from burstcast.control.windowed.outcome import Outcome, count_outcome
from burstcast.control.windowed.simulation import WindowedSimulation, WindowedStepper
from burstcast.forecasters.base import Forecaster


@dataclass(frozen=True)
class PredictionTriggered(ControlStrategy):
    """Acts for a while on each alarm.

    Attributes
    ----------
    prediction_time_lt
        Time from a forecast to the start of its window, in Lyapunov times; positive.
    window_lt
        Length of the window, in Lyapunov times; positive.
    vote_share
        Share of several forecasters that must forecast an event.
    """

    forecasts: ClassVar[bool] = True

    prediction_time_lt: float
    window_lt: float
    vote_share: float = 0.5

    def timing(self, schedule: Schedule) -> Timing:
        """Windows one after the other (see `ControlStrategy.timing`)."""
        return Timing(
            prediction_time_lt=self.prediction_time_lt, window_lt=self.window_lt, **schedule.clock
        )

    def check(self, schedule: Schedule) -> None:
        """Check the window, and that no actuation starts before its alarm."""
        self.actuation_interval(schedule)

    def actuation_interval(self, schedule: Schedule) -> tuple[int, int]:
        """Integration steps that an alarm sets off: the case's actuation, a delay later.

        See `burstcast.control.actuation.actuation_interval`.
        """
        return actuation_interval(
            self.timing(schedule),
            schedule.actuation_start_lt + schedule.delay_lt,
            schedule.actuation_duration_lt,
        )

    def monitor(self, experiment: ControlExperiment, forecasters: Sequence[Forecaster]) -> Monitor:
        """Alarms where forecasts cross the threshold in the window."""
        timing, observable = self.timing(experiment.schedule), experiment.observed_space.observable
        members = [
            ForecastMonitor(forecaster, observable, timing, experiment.threshold)
            for forecaster in forecasters
        ]
        return members[0] if len(members) == 1 else VoteMonitor(members, self.vote_share)

    def stepper(self, experiment: ControlExperiment, monitor: Monitor) -> WindowedStepper:
        """Advance flows window by window (see `ControlStrategy.stepper`)."""
        return WindowedStepper(
            experiment.system,
            experiment.actuated_system,
            monitor,
            self.timing(experiment.schedule),
            experiment.threshold,
            self.actuation_interval(experiment.schedule),
            sensor=experiment.sensor,
        )

    def outcome(
        self, flows: WindowedSimulation, laminarisation_threshold: float | None, edges: FloatArray
    ) -> Outcome:
        """Count outcomes in windows and between them (see `ControlStrategy.outcome`)."""
        return count_outcome(flows, laminarisation_threshold, edges)
