"""Outcome of prediction-triggered control: every event and alarm falls in one category.

Source: section "Control of extreme events" of the paper.
"""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from burstcast.arrays import BoolArray, FloatArray, IntArray
from burstcast.control.counts import (
    FlowCounts,
    controlled_events,
    count_flows,
    laminarisation,
    share,
)
from burstcast.control.windowed.simulation import Forecasts, WindowedSimulation


@dataclass(frozen=True, kw_only=True)
class Outcome(FlowCounts):
    """Counts of prediction-triggered control: those common to all strategies, and by window.

    The following always hold beside what holds for all strategies:

    * forecasts = alarms + forecasts without an alarm
    * alarms = true_alarms + false_alarms
    * true_alarms = suppressed_events + unsuppressed_events
    * early_alarms <= false_alarms, delayed_events <= suppressed_events
    * events_controlled = missed_events + events_under_way + events_after_true_alarms
      + events_after_false_alarms + events_between_windows

    Attributes
    ----------
    forecasts, alarms
        Forecasts that were made, and that raised an alarm.
    true_alarms
        Alarms after which the flow would have crossed the threshold in the window, had the alarm
        not been acted on: the very state at the alarm is integrated on to know this.
    false_alarms
        The others. Of them, after ``early_alarms`` the flow would have been at or above the
        threshold at the window's first step already: there was an event, but it began earlier.
    suppressed_events
        True alarms after which the controlled flow stays below the threshold in the window, and
        does not cross it between the start of the actuation and the window.
    delayed_events
        Suppressed events after which the controlled flow crosses the threshold after all, between
        the alarm's window and the first one after it, in which no forecast could have warned of it.
        The paper calls an event unsuppressed up to there: unsuppressed_events + delayed_events.
    unsuppressed_events
        The other true alarms: events that were predicted, and came before the next forecast.
    missed_events
        Events of the controlled flow in a window for which no alarm was raised, and at whose first
        step the flow was below the threshold.
    events_under_way
        Events in a window for which no alarm was raised, and at whose first step the flow was at or
        above the threshold: a former event was under way, and the flow dipped below the threshold
        in between.
    events_after_true_alarms, events_after_false_alarms
        Events in a window for which an alarm was raised.
    events_between_windows
        Events in no forecast's window: between an alarm's window and the first one after it.
    """

    forecasts: int
    alarms: int
    true_alarms: int
    false_alarms: int
    early_alarms: int
    suppressed_events: int
    delayed_events: int
    unsuppressed_events: int
    missed_events: int
    events_under_way: int
    events_after_true_alarms: int
    events_after_false_alarms: int
    events_between_windows: int

    @property
    def alarm_rate(self) -> float:
        """Share of the forecasts that raise an alarm."""
        return share(self.alarms, self.forecasts)


def count_outcome(
    flows: WindowedSimulation, laminarisation_threshold: float | None, edges: FloatArray
) -> Outcome:
    """Count outcomes over flows (parameters as of `count_flows`)."""
    counts = laminarisation(flows, laminarisation_threshold).neither
    forecasts = flows.decisions
    scored = counts[forecasts.flow]
    true_alarm = forecasts.alarm & forecasts.would_cross & scored
    false_alarm = forecasts.alarm & ~forecasts.would_cross & scored
    upward = controlled_events(flows, counts)
    suppressed = true_alarm & ~forecasts.reached
    window = _windows(flows)

    def events(kind: int) -> int:
        return int((upward & (window == kind)).sum())

    return Outcome(
        **count_flows(flows, laminarisation_threshold, edges),
        forecasts=int(scored.sum()),
        alarms=int((forecasts.alarm & scored).sum()),
        true_alarms=int(true_alarm.sum()),
        false_alarms=int(false_alarm.sum()),
        early_alarms=int((false_alarm & forecasts.would_be_under_way).sum()),
        suppressed_events=int(suppressed.sum()),
        delayed_events=int((suppressed & _crosses_between_windows(flows, upward)).sum()),
        unsuppressed_events=int((true_alarm & forecasts.reached).sum()),
        missed_events=events(_MISSED),
        events_under_way=events(_UNDER_WAY),
        events_after_true_alarms=events(_TRUE_ALARM),
        events_after_false_alarms=events(_FALSE_ALARM),
        events_between_windows=events(_NO_WINDOW),
    )


# Kinds of windows
_NO_WINDOW, _MISSED, _UNDER_WAY, _TRUE_ALARM, _FALSE_ALARM = range(5)


def _windows(flows: WindowedSimulation) -> npt.NDArray[np.int8]:
    """Kind of the window in which each step of each flow lies, ``(flows, timing.length)``.

    A window's first step belongs to the window before it: whoever crosses the threshold in a window
    is below it at the first step.
    """
    timing = flows.timing
    forecasts = flows.decisions
    kinds = np.full((len(flows), timing.length + timing.window_end), _NO_WINDOW, dtype=np.int8)
    # a last window may begin beyond the last step: its kind has no effect
    first_step = np.minimum(forecasts.step + timing.window_start, timing.counted_until)
    under_way = flows.controlled[forecasts.flow, first_step] >= flows.threshold
    kind = np.select(
        [forecasts.alarm & forecasts.would_cross, forecasts.alarm, under_way],
        [_TRUE_ALARM, _FALSE_ALARM, _UNDER_WAY],
        default=_MISSED,
    )
    within = np.arange(timing.window_start + 1, timing.window_end + 1)
    kinds[forecasts.flow[:, np.newaxis], forecasts.step[:, np.newaxis] + within] = kind[
        :, np.newaxis
    ]
    return kinds[:, : timing.length]


def _crosses_between_windows(flows: WindowedSimulation, upward: BoolArray) -> BoolArray:
    """Whether there is an event between the window of each forecast, if an alarm, and the next."""
    timing = flows.timing
    forecasts = flows.decisions
    # one entry for each step beyond the end, where nothing counts
    padded = np.pad(upward, ((0, 0), (0, timing.window_end + timing.window_start)))
    ahead = np.arange(timing.window_end + 1, timing.window_end + timing.window_start + 1)
    crossed: BoolArray = padded[
        forecasts.flow[:, np.newaxis], forecasts.step[:, np.newaxis] + ahead
    ].any(axis=1)
    return crossed


@dataclass(frozen=True)
class SuppressedEvent:
    """An event that control suppressed.

    Attributes
    ----------
    flow
        Position of its flow among the counted flows.
    row
        Row of its flow among the given ones.
    alarm_step
        Step at which the alarm was raised.
    """

    flow: int
    row: int
    alarm_step: int


def largest_suppressed_event(
    flows: WindowedSimulation, laminarisation_threshold: float | None
) -> SuppressedEvent | None:
    """Find the largest event that control suppressed.

    It is a true alarm, and the first alarm in its flow, so that up to there the two flows are the
    same and the uncontrolled one shows the very event that was predicted. From the alarm to the
    start of the next window the controlled flow stays below the threshold (the paper's criterion of
    a suppressed event), and all these steps count. Of all such alarms it is the one whose event has
    the largest observable in the alarm's window; the first one where there are several.

    Parameters
    ----------
    flows
        The flows.
    laminarisation_threshold
        Flows whose observable exceeds it, with or without control, are not considered; None: all
        are.

    Returns
    -------
    The event, or None if there is none.
    """
    timing, considered = flows.timing, laminarisation(flows, laminarisation_threshold).neither
    candidates = _first_alarms(flows.decisions)
    best: SuppressedEvent | None = None
    largest = -np.inf
    for index in candidates:
        flow, alarm = int(flows.decisions.flow[index]), int(flows.decisions.step[index])
        controlled, uncontrolled = flows.controlled[flow], flows.uncontrolled[flow]
        stop = alarm + timing.window_end + timing.window_start
        if not (considered[flow] and flows.decisions.would_cross[index]):
            continue
        if stop > timing.counted_until:
            continue
        if (controlled[alarm : stop + 1] >= flows.threshold).any():
            continue
        peak = uncontrolled[alarm + timing.window_start : alarm + timing.window_end + 1].max()
        if peak > largest:
            largest = peak
            best = SuppressedEvent(flow=flow, row=int(flows.rows[flow]), alarm_step=alarm)
    return best


def _first_alarms(forecasts: Forecasts) -> IntArray:
    """Positions of the first alarm of each flow that has one."""
    alarms = np.flatnonzero(forecasts.alarm)
    # forecasts are in the order of flows, then time
    _, first = np.unique(forecasts.flow[alarms], return_index=True)
    return alarms[first]
