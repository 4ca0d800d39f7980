"""A suppressed event as it is shown: both flows, the forecast, the times of the flow fields.

Source: section "Control of extreme events" of the paper, figure of a suppressed event.
"""

from dataclasses import dataclass, replace
from typing import Annotated

import numpy as np

from burstcast.base.arrays import FloatArray, IntArray
from burstcast.base.files.described import Described
from burstcast.base.files.units import COMPONENT, LYAPUNOV_TIMES, NUMBER, OBSERVABLE
from burstcast.control.experiment import ControlExperiment
from burstcast.control.strategies.prediction_triggered import PredictionTriggered
from burstcast.control.windows import SuppressedEvent
from burstcast.data.events import upward_crossings
from burstcast.forecasters.base import Forecaster
from burstcast.forecasts.examples import forecast_observable

BEFORE_LT = 1.0
AFTER_LT = 0.5
"""What is shown before the alarm and after the last of the event's times, if there is as much."""


@dataclass(frozen=True)
class EventUnderControl:
    """An event that control suppressed; where there is none, nothing has a time.

    Times are in Lyapunov times after the alarm.
    """

    time_lt: Annotated[FloatArray, Described("time", LYAPUNOV_TIMES, "time after the alarm")]
    uncontrolled: Annotated[FloatArray, Described("time", OBSERVABLE, "observable without control")]
    controlled: Annotated[FloatArray, Described("time", OBSERVABLE, "observable with control")]
    forecast: Annotated[FloatArray, Described("time", OBSERVABLE, "observable forecast")]
    actuation_lt: Annotated[
        FloatArray, Described("end", LYAPUNOV_TIMES, "start and end of the actuation")
    ]
    mark: Annotated[IntArray, Described("mark", NUMBER, "entries of time that the states are for")]
    uncontrolled_state: Annotated[
        FloatArray, Described("mark component", COMPONENT, "states without control")
    ]
    controlled_state: Annotated[
        FloatArray, Described("mark component", COMPONENT, "states with control")
    ]


def simulate_event(
    chosen: SuppressedEvent | None,
    strategy: PredictionTriggered,
    experiment: ControlExperiment,
    forecaster: Forecaster,
    noise: FloatArray | None,
) -> EventUnderControl:
    """Simulate a flow of an experiment once more, and keep its states around a suppressed event."""
    schedule, observable = experiment.schedule, experiment.system.observable
    timing, window = strategy.timing(schedule), strategy.window(schedule)
    if chosen is None:
        steps = marks = np.empty(0, dtype=np.int64)
        uncontrolled = controlled = np.empty((0, experiment.system.dimension))
        forecast = np.empty(0)
    else:
        only = slice(chosen.row, chosen.row + 1)
        flow_noise = None if noise is None else noise[only]
        flow = strategy.simulate(
            replace(experiment, washouts=experiment.washouts[only]),
            strategy.policy(experiment, forecaster),
            noise=flow_noise,
            keep_states=True,
        )
        times = suppressed_event_times(
            flow.uncontrolled[0, chosen.alarm_step :],
            experiment.threshold,
            timing.effect[0] // schedule.sampling_stride,
            window,
        )
        lyapunov_time = schedule.steps_per_lyapunov_time
        first = max(0, chosen.alarm_step - round(BEFORE_LT * lyapunov_time))
        last = chosen.alarm_step + max(times[-1], sum(window))
        last = min(last + round(AFTER_LT * lyapunov_time), timing.counted_until)
        steps = np.arange(first, last + 1) - chosen.alarm_step
        marks = np.array(times) - steps[0]
        assert flow.uncontrolled_states is not None
        assert flow.controlled_states is not None
        uncontrolled = flow.uncontrolled_states[0, first : last + 1]
        controlled = flow.controlled_states[0, first : last + 1]
        washout = slice(chosen.alarm_step + 1 - schedule.washout, chosen.alarm_step + 1)
        observed = flow.controlled_states[:, washout]
        if flow_noise is not None:
            observed = observed + flow_noise[:, washout]
        forecast = np.full(len(steps), np.nan)
        ahead = slice(1 - steps[0], 1 - steps[0] + window[1])
        forecast[ahead] = forecast_observable(forecaster, observable, observed, window[1])[0]
    # of the actuation in integration steps
    unit = schedule.steps_per_lyapunov_time * schedule.sampling_stride
    return EventUnderControl(
        steps / schedule.steps_per_lyapunov_time,
        observable(uncontrolled.T),
        observable(controlled.T),
        forecast,
        np.array(timing.effect) / unit,
        marks,
        uncontrolled[marks],
        controlled[marks],
    )


def suppressed_event_times(
    uncontrolled: FloatArray, threshold: float, actuation_start: int, window: tuple[int, int]
) -> tuple[int, int, int, int]:
    """Four steps of an event that control suppresses, after the alarm.

    The start of the actuation, up to which the flow is the same with and without control; the first
    step of the event in the window; its peak; and the first step after it below the threshold, or
    else the last step that there is.

    ``uncontrolled``: Observable without control from the alarm on, ``(steps,)``, which crosses the
    threshold in the window. ``actuation_start``: Step before the window ends. ``window``: First and
    last step of the alarm's window.
    """
    first, last = window
    crossings = np.flatnonzero(upward_crossings(uncontrolled, threshold)[first + 1 : last + 1])
    if crossings.size == 0:
        raise ValueError("the observable does not cross the threshold in the window")
    crossing = first + 1 + int(crossings[0])
    below = np.flatnonzero(uncontrolled[crossing:] < threshold)
    end = crossing + int(below[0]) if below.size else len(uncontrolled) - 1
    peak = crossing + int(uncontrolled[crossing : end + 1].argmax())
    return actuation_start, crossing, peak, end
