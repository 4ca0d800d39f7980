from dataclasses import fields, replace

import numpy as np
import pytest
from helpers_control import (
    Actuation,
    PlainFlow,
    Rotor,
    plain_flow,
    run_windowed,
    simulation_of,
    table_monitor,
    turbulent_washouts,
    washouts_of,
)
from hypothesis import example, given, settings
from hypothesis import strategies as st

from burstcast.control.actuation import actuated_system
from burstcast.control.counts import controlled_events
from burstcast.control.monitors.forecast import ForecastMonitor
from burstcast.control.monitors.random import RandomMonitor
from burstcast.control.timing import Timing
from burstcast.control.windowed.outcome import Outcome, count_outcome, largest_suppressed_event
from burstcast.control.windowed.simulation import Forecasts, WindowedSimulation
from burstcast.events import upward_crossings
from burstcast.forecasters.equations import EquationsFromTruth
from burstcast.systems.mfe import MoehlisFaisstEckhardt

# Windows from 3 to 6 steps after a forecast; the first forecast at step 0, steps 7 to 15 count
TIMING = Timing(
    prediction_time_lt=1.0,
    window_lt=1.0,
    span_lt=3.0,
    washout=1,
    steps_per_lyapunov_time=3,
    sampling_stride=2,
    time_step=0.1,
)
EDGES = np.array([0.0, 0.5, 1.0, 1.5])


def forecasts_of(*entries: tuple[int, int, str]) -> Forecasts:
    """Forecasts as (flow, step, outcome): "", "suppressed", "unsuppressed", "false", "early"."""
    outcome = [entry[2] for entry in entries]
    true_alarm = [name in ("suppressed", "unsuppressed") for name in outcome]
    return Forecasts(
        flow=np.array([entry[0] for entry in entries], dtype=np.int64),
        step=np.array([entry[1] for entry in entries], dtype=np.int64),
        alarm=np.array([name != "" for name in outcome]),
        would_cross=np.array(true_alarm),
        would_be_under_way=np.array([name == "early" for name in outcome]),
        reached=np.array([name == "unsuppressed" for name in outcome]),
    )


def flows_of(
    controlled: list[list[float]],
    forecasts: Forecasts,
    uncontrolled: list[list[float]] | None = None,
    actuated: tuple[int, int] = (0, 0),
) -> WindowedSimulation:
    values = np.array(controlled, dtype=np.float64)
    active = np.zeros(values.shape, dtype=bool)
    active[:, slice(*actuated)] = True
    return simulation_of(
        TIMING,
        controlled=values,
        uncontrolled=np.array(uncontrolled) if uncontrolled is not None else np.zeros_like(values),
        decisions=forecasts,
        rows=10 + np.arange(len(values)),
        left_out=2,
        actuated=active,
        actuated_integration_steps=np.full(len(values), 2 * (actuated[1] - actuated[0])),
    )


def series(*above: int, level: float = 1.0) -> list[float]:
    return [level if step in above else 0.0 for step in range(16)]


QUIET = [(0, step, "") for step in (0, 3, 6, 9, 12)]


@pytest.mark.parametrize(
    ("above", "kind"),
    [
        ((4,), "missed_events"),  # the first step that a window can be crossed at
        ((6,), "missed_events"),  # the window's last step
        ((7,), "missed_events"),  # the next window's first
        ((15,), "missed_events"),
        ((1,), "events_between_windows"),  # before the first window
        ((3,), "events_between_windows"),
    ],
)
def test_an_event_without_alarms_is_missed_if_a_window_covers_it(
    above: tuple[int, ...], kind: str
) -> None:
    counts = count_outcome(flows_of([series(*above)], forecasts_of(*QUIET)), None, EDGES)
    assert counts.events_controlled == 1
    assert getattr(counts, kind) == 1


def test_an_event_in_a_window_that_began_in_one_is_under_way() -> None:
    # the window from step 6 to 9 begins at or above the threshold
    counts = count_outcome(flows_of([series(6, 8)], forecasts_of(*QUIET)), None, EDGES)
    assert counts.missed_events == 1
    assert counts.events_under_way == 1
    assert counts.events_controlled == 2


@pytest.mark.parametrize(
    ("outcome", "kind"),
    [
        ("unsuppressed", "events_after_true_alarms"),
        ("false", "events_after_false_alarms"),
        ("early", "events_after_false_alarms"),
    ],
)
def test_an_event_after_an_alarm(outcome: str, kind: str) -> None:
    # alarm at step 3: window 6 to 9, next forecast at 9, next window from 12
    forecasts = forecasts_of((0, 0, ""), (0, 3, outcome), (0, 9, ""), (0, 12, ""))
    counts = count_outcome(flows_of([series(9)], forecasts), None, EDGES)
    assert getattr(counts, kind) == counts.events_controlled == 1
    between = count_outcome(flows_of([series(10, 12, 13)], forecasts), None, EDGES)
    assert between.events_between_windows == between.events_controlled == 2
    # the second of these events lasts into the next window, which it does not cross
    assert between.missed_events == 0


def test_alarms_are_told_apart() -> None:
    forecasts = forecasts_of(
        (0, 0, "suppressed"),
        (0, 6, "early"),
        (0, 12, ""),
        (1, 0, "unsuppressed"),
        (1, 6, "false"),
        (1, 12, "suppressed"),
    )
    # the first alarm's event is delayed: it comes after step 6, before the next window at 9
    counts = count_outcome(flows_of([series(8), series(9)], forecasts), None, EDGES)
    assert (counts.forecasts, counts.alarms) == (6, 5)
    assert (counts.true_alarms, counts.false_alarms, counts.early_alarms) == (3, 2, 1)
    assert (counts.suppressed_events, counts.unsuppressed_events) == (2, 1)
    assert counts.delayed_events == 1
    assert counts.alarm_rate == 5 / 6


@pytest.mark.parametrize(("step", "delayed"), [(6, 0), (7, 1), (9, 1), (10, 0)])
def test_a_delayed_event_comes_between_the_alarm_s_window_and_the_next(
    step: int, delayed: int
) -> None:
    # alarm at step 0: window 3 to 6, next window 9 to 12
    forecasts = forecasts_of((0, 0, "suppressed"), (0, 6, ""), (0, 9, ""), (0, 12, ""))
    counts = count_outcome(flows_of([series(step)], forecasts), None, EDGES)
    assert counts.delayed_events == delayed
    assert counts.events_between_windows == delayed


def test_statistics_of_the_steps_that_count() -> None:
    flows = flows_of(
        [series(6, 7, 8), series(9)],
        forecasts_of(*QUIET),
        uncontrolled=[series(5, 12, 13, 14), series(7, 8, level=0.6)],
        actuated=(8, 11),
    )
    counts = count_outcome(flows, None, EDGES)
    assert counts.left_out == 2
    assert counts.steps == 18
    assert counts.exceeding_uncontrolled == 3
    assert counts.exceeding_controlled == 3
    assert (counts.steps_free, counts.exceeding_free) == (12, 1)
    assert counts.exceedance_uncontrolled == counts.exceedance_controlled == 3 / 18
    assert counts.exceedance_free == 1 / 12
    assert counts.reduction == 0.0
    assert counts.control_fraction == 12 / 36
    assert counts.histogram_uncontrolled.sum(axis=0).tolist() == [13, 2, 3]
    assert counts.histogram_controlled.sum(axis=0).tolist() == [15, 0, 3]
    assert counts.histogram_free.sum(axis=0).tolist() == [11, 0, 1]
    assert counts.histogram_controlled.shape == (counts.flows, 3)
    assert counts.row.shape == (counts.flows,)


def test_a_flow_that_laminarises_in_one_sample_counts_in_neither() -> None:
    forecasts = forecasts_of(*((flow, 0, "suppressed") for flow in range(4)))
    calm, high = series(9), series(9, level=2.0)
    flows = flows_of([high, calm, high, calm], forecasts, uncontrolled=[calm, high, high, calm])
    counts = count_outcome(flows, 1.5, EDGES)
    assert (counts.flows, counts.left_out, counts.laminarised) == (1, 2, 3)
    assert (counts.laminarised_controlled, counts.laminarised_uncontrolled) == (2, 2)
    assert (counts.alarms, counts.forecasts) == (1, 1)
    assert (counts.steps, counts.events_uncontrolled, counts.events_controlled) == (9, 1, 1)
    assert count_outcome(flows, None, EDGES).flows == 4
    # exactly at the threshold is not above it
    assert count_outcome(flows, 2.0, EDGES).flows == 4


def test_ratios_without_flows_are_not_numbers() -> None:
    flows = flows_of([series(9)], forecasts_of(*QUIET), uncontrolled=[series(9)])
    counts = count_outcome(flows, 0.5, EDGES)
    assert counts.flows == 0
    for ratio in ("exceedance_uncontrolled", "exceedance_free", "reduction", "alarm_rate"):
        assert np.isnan(getattr(counts, ratio))


def test_events_count_from_the_first_forecast_on() -> None:
    flows = flows_of([series(1, 4)], forecasts_of(*QUIET))
    late = replace(flows, timing=replace(TIMING, washout=3))
    found = [np.flatnonzero(controlled_events(one, np.array([True]))[0]) for one in (flows, late)]
    assert [list(steps) for steps in found] == [[1, 4], [4]]


def test_upward_crossings() -> None:
    observable = np.array([[2.0, 0.0, 1.0, 1.0, 0.9, 3.0], [0.0, 1.0, 0.0, 0.0, 0.0, 0.0]])
    crossings = upward_crossings(observable, 1.0)
    assert np.argwhere(crossings).tolist() == [[0, 2], [0, 5], [1, 1]]


KINDS = ("missed", "under_way", "after_true_alarms", "after_false_alarms", "between_windows")


def plain_ledger(flow: PlainFlow, timing: Timing, threshold: float) -> dict[str, int]:
    """Events of a flow, one step after the other."""
    height = flow.controlled[:, 0]
    ledger = dict.fromkeys(KINDS, 0)
    for step in range(timing.washout, timing.length):
        if not height[step - 1] < threshold <= height[step]:
            continue
        kind = "between_windows"
        for forecast in flow.forecasts:
            start, end = forecast.step + timing.window_start, forecast.step + timing.window_end
            if not start < step <= end:
                continue
            assert kind == "between_windows", "two windows overlap"
            if forecast.alarm:
                kind = "after_true_alarms" if forecast.would_cross else "after_false_alarms"
            else:
                kind = "under_way" if height[start] >= threshold else "missed"
        ledger[kind] += 1
    return ledger


@settings(max_examples=60, deadline=None)
@given(
    seed=st.integers(0, 2**32 - 1),
    prediction_time_lt=st.sampled_from([1.0, 1.5, 2.0]),
    alarm_share=st.sampled_from([0.0, 0.3, 0.7, 1.0]),
    frequency=st.sampled_from([0.05, 1.1]),
    laminarisation_threshold=st.sampled_from([None, 1.3]),
)
# a flow of a radius of almost 5
@example(
    seed=1567,
    prediction_time_lt=1.0,
    alarm_share=0.0,
    frequency=0.05,
    laminarisation_threshold=None,
)
def test_the_counts_add_up(
    seed: int,
    prediction_time_lt: float,
    alarm_share: float,
    frequency: float,
    laminarisation_threshold: float | None,
) -> None:
    timing = replace(
        TIMING,
        prediction_time_lt=prediction_time_lt,
        steps_per_lyapunov_time=5,
        span_lt=5.0,
        washout=2,
        time_step=0.25,
    )
    generator = np.random.default_rng(seed)
    system = Rotor(0.35)
    actuation = Actuation(Rotor(frequency), start_lt=-1.0, duration_lt=1.5)
    washouts = washouts_of(system, generator.normal(size=(2, 12)), timing)
    table = generator.random((12, timing.most_forecasts)) < alarm_share
    flows = run_windowed(system, washouts, table_monitor(table), actuation, timing, 0.9)
    # bins that hold every value: values outside of them are in none
    bound = 1 + np.abs([flows.controlled, flows.uncontrolled]).max(initial=0.0)
    counts = count_outcome(flows, laminarisation_threshold, np.linspace(-bound, bound, 9))

    assert counts.flows + counts.left_out + counts.laminarised == 12
    assert counts.alarms == counts.true_alarms + counts.false_alarms <= counts.forecasts
    assert counts.true_alarms == counts.suppressed_events + counts.unsuppressed_events
    assert counts.early_alarms <= counts.false_alarms
    assert counts.delayed_events <= counts.suppressed_events
    assert counts.events_controlled == (
        counts.missed_events
        + counts.events_under_way
        + counts.events_after_true_alarms
        + counts.events_after_false_alarms
        + counts.events_between_windows
    )
    assert counts.steps == counts.flows * timing.span_steps
    assert counts.integration_steps == counts.steps * timing.sampling_stride
    assert counts.histogram_controlled.sum() == counts.histogram_uncontrolled.sum() == counts.steps
    assert counts.histogram_free.sum() == counts.steps_free <= counts.steps
    assert counts.exceeding_free <= counts.exceeding_controlled <= counts.steps
    for field in fields(Outcome):
        assert np.all(getattr(counts, field.name) >= 0) or field.name == "edges"

    # and they are those of a plain loop over the steps of each flow
    start, steps = int((prediction_time_lt - 1.0) * 10), 15
    expected = dict.fromkeys(KINDS, 0)
    alarms = exceeding = acting = 0
    for row in flows.rows:
        flow = plain_flow(
            system, washouts[row], list(table[row]), actuation, timing, 0.9, start, steps
        )
        heights = np.stack([flow.controlled[:, 0], flow.uncontrolled[:, 0]])
        if laminarisation_threshold is not None and heights.max() > laminarisation_threshold:
            continue
        for kind, number in plain_ledger(flow, timing, 0.9).items():
            expected[kind] += number
        alarms += sum(forecast.alarm for forecast in flow.forecasts)
        exceeding += int((flow.controlled[timing.counted_from + 1 :, 0] >= 0.9).sum())
        acting += int(flow.acting[timing.counted_from * 2 : timing.counted_until * 2].sum())
    assert counts.alarms == alarms
    assert counts.exceeding_controlled == exceeding
    assert counts.actuated_integration_steps == acting
    assert expected == {
        "missed": counts.missed_events,
        "under_way": counts.events_under_way,
        "after_true_alarms": counts.events_after_true_alarms,
        "after_false_alarms": counts.events_after_false_alarms,
        "between_windows": counts.events_between_windows,
    }


def test_the_largest_suppressed_event_is_found() -> None:
    forecasts = forecasts_of(
        (0, 3, "suppressed"),
        (1, 3, "suppressed"),
        (2, 0, "false"),
        (2, 6, "suppressed"),
        (3, 3, "unsuppressed"),
        (4, 3, "suppressed"),
        (5, 9, "suppressed"),
    )
    uncontrolled = [series(5, 8, 14, level=level) for level in (1.1, 1.2, 1.9, 1.8, 1.7, 1.95)]
    # the event of flow 4 is only delayed; that of flow 2 does not follow its first alarm; that of
    # flow 5 has no room for the steps after it
    controlled = [series(), series(), series(), series(9), series(11), series()]
    flows = flows_of(controlled, forecasts, uncontrolled=uncontrolled)
    event = largest_suppressed_event(flows, None)
    assert event is not None
    assert (event.flow, event.row, event.alarm_step) == (1, 11, 3)
    first_below = largest_suppressed_event(flows, 1.15)
    assert first_below is not None
    assert first_below.flow == 0
    assert largest_suppressed_event(flows, 1.05) is None


FLOW = MoehlisFaisstEckhardt(reynolds=400.0)
RAISED = Actuation(actuated_system(FLOW, {"reynolds": 2000.0}), -1.0, 1.5)


@pytest.mark.long
def test_the_equations_reduce_exceedance_and_chance_does_not() -> None:
    timing = Timing(
        prediction_time_lt=1.0,
        window_lt=1.0,
        span_lt=10.0,
        washout=1,
        steps_per_lyapunov_time=61,
        sampling_stride=4,
        time_step=0.25,
    )
    washouts = turbulent_washouts(FLOW, 200, timing, seed=8, steps=1600)
    edges = np.linspace(0.012, 0.48, 101)
    forecaster = EquationsFromTruth(FLOW, timing.time_step, timing.sampling_stride)
    perfect = count_outcome(
        run_windowed(
            FLOW,
            washouts,
            ForecastMonitor(forecaster, FLOW.observable, timing, 0.1),
            RAISED,
            timing,
            0.1,
        ),
        0.48,
        edges,
    )
    draws = np.random.default_rng(4).random((200, timing.most_forecasts))
    chance = count_outcome(
        run_windowed(FLOW, washouts, RandomMonitor(perfect.alarm_rate, draws), RAISED, timing, 0.1),
        0.48,
        edges,
    )
    assert perfect.false_alarms == 0
    assert perfect.exceedance_uncontrolled == pytest.approx(0.13, abs=0.04)
    assert perfect.reduction > 0.6
    assert abs(chance.control_fraction - perfect.control_fraction) < 0.03
    assert abs(chance.reduction) < 0.25
