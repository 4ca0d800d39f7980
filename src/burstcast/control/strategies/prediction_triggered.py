"""The paper's strategy: an alarm for a window sets off one actuation of a given length.

Source: section "Control of extreme events" of the paper. A forecast made at step t covers the
window from t + prediction time to t + prediction time + window. Without an alarm the next forecast
is made one window later, so that windows follow each other without a gap; after an alarm it is made
at the end of the alarm's window, and the prediction time up to the next window is covered by no
forecast. An alarm sets off the case's actuation, with the start and duration of the case; if it is
still on at the next alarm, it stays on until the later of the two ends.

Steps count from the end of the first window: flows are chosen to be free of events up to there.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from burstcast.base.arrays import BoolArray, ByteArray
from burstcast.control.experiment import ControlExperiment
from burstcast.control.loop import ControlledFlows, Looks, RunningFlows
from burstcast.control.policy import (
    OFF,
    Fallback,
    Look,
    Policy,
    check_fallback,
    forecast,
    is_invalid,
)
from burstcast.control.strategies.base import ControlStrategy
from burstcast.control.timing import Schedule, Timing
from burstcast.control.windows import WindowCounts, count_windows, judge_alarms
from burstcast.forecasts.windows import crosses_in_window


@dataclass(frozen=True)
class PredictionTriggered(ControlStrategy):
    """Actuates for a fixed duration after each alarm."""

    forecasts = True

    #: time from a forecast to the start of its window, in Lyapunov times; positive
    prediction_time_lt: float
    window_lt: float  #: length of the window, in Lyapunov times; positive
    vote_share: float = 0.5  #: share of several forecasters that must forecast an event
    #: what decides where a forecast is invalid: "reactive", "off" or "on"
    #: (`burstcast.control.policy.Fallback`). In the paper, such a forecast predicts no event
    fallback: str = OFF

    def window(self, schedule: Schedule) -> tuple[int, int]:
        """Steps from a forecast to the first and to the last step of its window."""
        start = schedule.steps(self.prediction_time_lt)
        end = schedule.steps(self.prediction_time_lt + self.window_lt)
        if start < 1 or end - start < 1:
            raise ValueError("the prediction time and window of control must last a step")
        return start, end

    def timing(self, schedule: Schedule) -> Timing:
        """Windows one after the other, and the case's actuation, a delay later.

        Durations of the actuation are rounded down to whole integration steps.
        """
        start, end = self.window(schedule)
        start_lt = schedule.actuation_start_lt + schedule.delay_lt
        first = schedule.integration_steps(self.prediction_time_lt + start_lt)
        length = schedule.integration_steps(schedule.actuation_duration_lt)
        if first < 0:
            raise ValueError(
                f"control is not defined for a prediction time of {self.prediction_time_lt} "
                f"Lyapunov times: the actuation starts {-start_lt} Lyapunov times before the "
                f"window, which would be before the alarm"
            )
        if length < 1:
            raise ValueError(
                f"an actuation of {schedule.actuation_duration_lt} Lyapunov times lasts no step"
            )
        return Timing(schedule, (end - start, end), (first, first + length), settling=end)

    def check(self, schedule: Schedule) -> None:
        """Check the window and the fallback."""
        super().check(schedule)
        check_fallback(self.fallback)

    def policy(self, experiment: ControlExperiment, forecaster: Any) -> Policy:
        """Policy that acts if the forecast crosses the threshold in the window."""
        start, end = self.window(experiment.schedule)
        observable = experiment.observed_space.observable
        fallback = Fallback(self.fallback, experiment)

        def decide(look: Look) -> ByteArray:
            ahead = forecast(forecaster, look, end)
            crosses = crosses_in_window(observable(ahead), start, end, experiment.threshold)
            return fallback.where(is_invalid(ahead), crosses, look)

        return decide

    def judge(self, flows: RunningFlows, looks: Looks) -> Mapping[str, BoolArray]:
        """Outcomes of each alarm, and outcomes without it (`judge_alarms`)."""
        return judge_alarms(flows, looks)

    def categories(self, flows: ControlledFlows) -> WindowCounts:
        """Events, alarms and forecasts of each flow, each in one category."""
        return count_windows(flows)
