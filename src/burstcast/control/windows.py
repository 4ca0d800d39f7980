"""The windows of the paper's control: every event and alarm of a flow falls in one category.

A flow's windows are known from its timing: after an alarm the next look is at the end of the
alarm's window, and without one a window later.

Source: section "Control of extreme events" of the paper.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, fields
from typing import Annotated

import numpy as np

from burstcast.base.arrays import BoolArray, ByteArray, FloatArray, IntArray
from burstcast.base.files.described import Described
from burstcast.base.files.units import NUMBER, OBSERVABLE
from burstcast.control.loop import (
    ControlledFlows,
    Looks,
    RunningFlows,
    ending_at,
    observable_of,
)
from burstcast.control.records import FlowSample, record_flows
from burstcast.control.timing import Timing
from burstcast.data.events import upward_crossings
from burstcast.forecasts.scores import ratio
from burstcast.forecasts.windows import crosses_in_window
from burstcast.statistics.densities import histogram


def window_of(timing: Timing) -> tuple[int, int]:
    """Steps from a forecast to the first and to the last step of its window."""
    without_alarm, end = timing.pauses
    return end - without_alarm, end


def judge_alarms(flows: RunningFlows, looks: Looks) -> Mapping[str, BoolArray]:
    """Compare alarms with the truth, ``(looks,)`` each; False where there was no alarm.

    ``would_cross``: Whether the flow would have crossed the threshold in the window without this
    alarm: integration continues from the state at the alarm, with an earlier actuation that is
    still on. ``would_be_under_way``: Whether it would have been at or above the threshold at the
    window's first step already. ``reached``: Whether the controlled flow was at or above the
    threshold in the window, or crossed it between the start of the actuation and the window.
    """
    threshold, stride = flows.experiment.threshold, flows.timing.schedule.sampling_stride
    (start, end), begin = window_of(flows.timing), flows.timing.effect[0] // stride
    names = "would_cross", "would_be_under_way", "reached"
    judged = {name: np.zeros(len(looks.alarm), dtype=bool) for name in names}
    alarms, acting_still = np.flatnonzero(looks.alarm), _still_acting(flows, looks)
    # as many alarms at once as there are flows: their states fill no more memory
    for first in range(0, len(alarms), max(1, len(flows.rows))):
        some = alarms[first : first + len(flows.rows)]
        flow, now = looks.flow[some], looks.step[some]
        free = _observable_without(flows, flow, now, acting_still[some], end)
        judged["would_cross"][some] = crosses_in_window(free[1:], start, end, threshold)
        judged["would_be_under_way"][some] = free[start] >= threshold
        states = ending_at(flows.states, flow, now + end, end + 1)
        observable = observable_of(flows.experiment.system, states)
        # a step that is partly under actuation counts: the actuation could have changed it
        early = upward_crossings(observable, threshold)[:, begin + 1 : start + 1].any(axis=1)
        judged["reached"][some] = early | (observable[:, start:] >= threshold).any(axis=1)
    return judged


def _still_acting(flows: RunningFlows, looks: Looks) -> IntArray:
    """Integration steps from each alarm until the flow's previous actuation ends; 0 elsewhere."""
    stride, stop = flows.timing.schedule.sampling_stride, flows.timing.effect[1]
    alarms = np.flatnonzero(looks.alarm)
    same_flow = looks.flow[alarms[:-1]] == looks.flow[alarms[1:]]
    remaining = np.zeros_like(looks.step)
    remaining[alarms[1:]] = np.where(same_flow, stop - np.diff(looks.step[alarms]) * stride, 0)
    return remaining


def _observable_without(
    flows: RunningFlows, flow: IntArray, now: IntArray, acting_still: IntArray, steps: int
) -> FloatArray:
    """Observable of flows from their alarms on, without the actuation that these set off.

    Returns an array ``(steps + 1, alarms)``.
    """
    acting = flows.acting_from(flow, now, steps)
    ahead = np.arange(acting.shape[1])
    acting[(ahead >= flows.timing.effect[0]) & (ahead >= acting_still[:, np.newaxis])] = 0
    samples = flows.integrated(flow, now, steps, acting)
    return observable_of(flows.experiment.system, samples.transpose(2, 0, 1)).T


def _count(meaning: str) -> Described:
    return Described("flow", NUMBER, meaning)


@dataclass(frozen=True)
class WindowCounts:
    """Counts of each flow under prediction-triggered control, ``(flows,)``.

    The following always hold:

    * alarms = true_alarms + false_alarms <= forecasts
    * true_alarms = suppressed_events + unsuppressed_events
    * early_alarms <= false_alarms, delayed_events <= suppressed_events
    * events of the controlled flow from the first forecast to the last step = missed_events
      + events_under_way + events_after_true_alarms + events_after_false_alarms
      + events_between_windows
    """

    forecasts: Annotated[IntArray, _count("forecasts that were made")]
    alarms: Annotated[IntArray, _count("forecasts that raised an alarm")]
    true_alarms: Annotated[IntArray, _count("alarms without which the flow would have crossed")]
    false_alarms: Annotated[IntArray, _count("other alarms")]
    early_alarms: Annotated[IntArray, _count("false alarms in whose event the window begins")]
    #: true alarms after which the controlled flow stays below the threshold in the window, and does
    #: not cross it between the start of the actuation and the window
    suppressed_events: Annotated[IntArray, _count("true alarms whose event did not come")]
    #: suppressed events after which the controlled flow crosses the threshold after all, between
    #: the alarm's window and the first one after it, in which no forecast could have warned of it.
    #: The paper calls an event unsuppressed up to there: unsuppressed_events + delayed_events
    delayed_events: Annotated[IntArray, _count("suppressed events that came before a next window")]
    unsuppressed_events: Annotated[IntArray, _count("true alarms whose event came")]
    missed_events: Annotated[IntArray, _count("events in a window without an alarm")]
    #: an earlier event was under way, and the flow dipped below the threshold in between
    events_under_way: Annotated[
        IntArray, _count("events in a window without an alarm that begins in an event")
    ]
    events_after_true_alarms: Annotated[IntArray, _count("events in the window of a true alarm")]
    events_after_false_alarms: Annotated[IntArray, _count("events in the window of a false alarm")]
    events_between_windows: Annotated[IntArray, _count("events in no forecast's window")]
    steps_free: Annotated[IntArray, _count("counted steps without actuation")]
    exceeding_free: Annotated[IntArray, _count("those at or above the threshold")]


def count_windows(flows: ControlledFlows) -> WindowCounts:
    """Count the outcomes of each flow, whether it laminarises or not."""
    looks, counted = flows.looks, flows.timing.counted
    crosses, reached = looks.judged["would_cross"], looks.judged["reached"]
    upward = upward_crossings(flows.controlled, flows.threshold)
    upward[:, : flows.timing.first_look + 1] = False
    window, free = _windows(flows), ~flows.actuated[:, counted]

    def number(of_looks: BoolArray) -> IntArray:
        return np.bincount(looks.flow[of_looks], minlength=len(flows))

    def events(kind: int) -> IntArray:
        return np.asarray((upward & (window == kind)).sum(axis=1))

    return WindowCounts(
        forecasts=number(np.ones_like(looks.alarm)),
        alarms=number(looks.alarm),
        true_alarms=number(crosses),
        false_alarms=number(looks.alarm & ~crosses),
        early_alarms=number(looks.judged["would_be_under_way"]),
        suppressed_events=number(crosses & ~reached),
        delayed_events=number(crosses & ~reached & _crosses_between_windows(flows, upward)),
        unsuppressed_events=number(crosses & reached),
        missed_events=events(_MISSED),
        events_under_way=events(_UNDER_WAY),
        events_after_true_alarms=events(_TRUE_ALARM),
        events_after_false_alarms=events(_FALSE_ALARM),
        events_between_windows=events(_NO_WINDOW),
        steps_free=free.sum(axis=1),
        exceeding_free=(free & (flows.controlled[:, counted] >= flows.threshold)).sum(axis=1),
    )


# Kinds of windows
_NO_WINDOW, _MISSED, _UNDER_WAY, _TRUE_ALARM, _FALSE_ALARM = range(5)


def _windows(flows: ControlledFlows) -> ByteArray:
    """Kind of the window in which each step of each flow lies, ``(flows, timing.length)``.

    A window's first step belongs to the window before it: a flow that crosses the threshold in a
    window is below it at the first step.
    """
    timing, looks = flows.timing, flows.looks
    start, end = window_of(timing)
    kinds = np.full((len(flows), timing.length + end), _NO_WINDOW, dtype=np.uint8)
    # a last window may begin beyond the last step: its kind has no effect
    first_step = np.minimum(looks.step + start, timing.counted_until)
    under_way = flows.controlled[looks.flow, first_step] >= flows.threshold
    kind = np.select(
        [looks.judged["would_cross"], looks.alarm, under_way],
        [_TRUE_ALARM, _FALSE_ALARM, _UNDER_WAY],
        default=_MISSED,
    )
    within = looks.step[:, np.newaxis] + np.arange(start + 1, end + 1)
    kinds[looks.flow[:, np.newaxis], within] = kind[:, np.newaxis]
    return kinds[:, : timing.length]


def _crosses_between_windows(flows: ControlledFlows, upward: BoolArray) -> BoolArray:
    """Whether an event falls between each look's window, after an alarm, and the next window."""
    start, end = window_of(flows.timing)
    # one entry for each step beyond the end, where nothing counts
    padded = np.pad(upward, ((0, 0), (0, end + start)))
    ahead = flows.looks.step[:, np.newaxis] + np.arange(end + 1, end + start + 1)
    return np.asarray(padded[flows.looks.flow[:, np.newaxis], ahead].any(axis=1))


def totals(sample: FlowSample, counts: WindowCounts, left_out: int) -> dict[str, float]:
    """Counts and shares over all flows that neither laminarise nor escape.

    Steps and exceedances are of the steps that count. ``reduction`` is the share of the exceedance
    that control removes, ``alarm_rate`` the share of the forecasts that raise an alarm; NaN where
    there is nothing to divide by.
    """
    records, span, kept = sample.records, sample.span, sample.records.kept
    flows = int(kept.sum())
    total = {entry.name: int(getattr(counts, entry.name)[kept].sum()) for entry in fields(counts)}
    for name in ("exceeding_uncontrolled", "exceeding_controlled", "events_uncontrolled"):
        total[name] = int(getattr(records, name)[kept].sum())
    total |= {
        "actuated_integration_steps": int(records.actuated_integration_steps[kept].sum()),
        "flows": flows,
        "left_out": left_out,
        "laminarised": int(records.laminarises.sum()),
        "escaped": int(records.escapes.sum()),
        "laminarised_controlled": int((records.laminar_step_controlled >= 0).sum()),
        "laminarised_uncontrolled": int((records.laminar_step_uncontrolled >= 0).sum()),
        "events_controlled": sum(total[name] for name in _EVENTS),
        "steps": flows * span.steps,
        "integration_steps": flows * span.integration_steps,
    }

    def share(part: str, whole: str) -> float:
        return total[part] / total[whole] if total[whole] else float("nan")

    return total | {
        "exceedance_uncontrolled": share("exceeding_uncontrolled", "steps"),
        "exceedance_controlled": share("exceeding_controlled", "steps"),
        "exceedance_free": share("exceeding_free", "steps_free"),
        "reduction": 1.0 - share("exceeding_controlled", "exceeding_uncontrolled"),
        "control_fraction": share("actuated_integration_steps", "integration_steps"),
        "alarm_rate": share("alarms", "forecasts"),
        "fallback_fraction": float(
            ratio(records.fallbacks[kept].sum(), records.decisions[kept].sum())
        ),
    }


_EVENTS = (
    *("missed_events", "events_under_way", "events_after_true_alarms"),
    *("events_after_false_alarms", "events_between_windows"),
)


def _histogram(meaning: str) -> Described:
    return Described("flow bin", NUMBER, f"steps, {meaning}")


@dataclass(frozen=True)
class Histograms:
    """Steps that count of each flow in bins of the observable; beyond the edges in no bin."""

    edge: Annotated[FloatArray, Described("edge", OBSERVABLE, "edges of the bins")]
    histogram_uncontrolled: Annotated[IntArray, _histogram("without control")]
    histogram_controlled: Annotated[IntArray, _histogram("with control")]
    histogram_free: Annotated[IntArray, _histogram("with control, outside actuation")]


def observable_histograms(flows: ControlledFlows, edges: FloatArray) -> Histograms:
    """Histograms of each flow in bins with these edges, ``(bins + 1,)``."""
    counted = flows.timing.counted
    samples = flows.uncontrolled[:, counted], flows.controlled[:, counted]
    free = [flow[~on] for flow, on in zip(samples[1], flows.actuated[:, counted], strict=True)]

    def counts(sample: Iterable[FloatArray]) -> IntArray:
        by_flow = [histogram(flow, edges).counts for flow in sample]
        return np.array(by_flow, dtype=np.int64).reshape(-1, len(edges) - 1)

    return Histograms(edges, counts(samples[0]), counts(samples[1]), counts(free))


@dataclass(frozen=True)
class SuppressedEvent:
    """An event that control suppressed."""

    flow: int  #: position of its flow among the simulated flows
    row: int  #: row of its flow among the given ones
    alarm_step: int  #: step at which the alarm was raised


def largest_suppressed_event(
    flows: ControlledFlows, laminarisation_threshold: float | None
) -> SuppressedEvent | None:
    """Largest event that control suppressed; None if there is none.

    It is a true alarm, and the first alarm in its flow, so that up to there the two flows are the
    same and the uncontrolled one shows the very event that was predicted. From the alarm to the
    start of the next window the controlled flow stays below the threshold (the paper's criterion of
    a suppressed event), and all these steps count. Of all such alarms it is the one whose event has
    the largest observable in the alarm's window; the first one where there are several. Flows that
    laminarise, with or without control, are not considered.
    """
    looks, (start, end) = flows.looks, window_of(flows.timing)
    kept = record_flows(flows, laminarisation_threshold).kept
    alarms = np.flatnonzero(looks.alarm)
    _, first = np.unique(looks.flow[alarms], return_index=True)
    best, largest = None, -np.inf
    for index in alarms[first]:
        flow, alarm = int(looks.flow[index]), int(looks.step[index])
        stop = alarm + end + start
        if not (kept[flow] and looks.judged["would_cross"][index]):
            continue
        if stop > flows.timing.counted_until:
            continue
        if (flows.controlled[flow, alarm : stop + 1] >= flows.threshold).any():
            continue
        peak = flows.uncontrolled[flow, alarm + start : alarm + end + 1].max()
        if peak > largest:
            best, largest = SuppressedEvent(flow, int(flows.rows[flow]), alarm), peak
    return best
