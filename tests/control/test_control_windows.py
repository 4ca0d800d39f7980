"""The windows of the paper's control: alarms and events in categories, and the event shown."""

from dataclasses import fields, replace
from typing import Any

import numpy as np
import pytest
from helpers_control import (
    EQUATIONS,
    FLOW,
    PAPER,
    SCHEDULE,
    PlainFlow,
    experiment,
    plain_flow,
    random_alarms,
    rotors,
    run,
    simulation_of,
    turbulent_washouts,
)
from hypothesis import example, given, settings
from hypothesis import strategies as st

from burstcast.control.controllers import controlling_policy
from burstcast.control.example import simulate_event, suppressed_event_times
from burstcast.control.loop import ControlledFlows, Looks
from burstcast.control.records import Span, record_flows
from burstcast.control.strategies.prediction_triggered import PredictionTriggered
from burstcast.control.windows import (
    WindowCounts,
    count_windows,
    largest_suppressed_event,
    observable_histograms,
    totals,
)
from burstcast.events import upward_crossings
from burstcast.forecast.examples import forecast_observable

STRATEGY = PredictionTriggered(1.0, 1.0)
# windows from 3 to 6 steps after a forecast; the first forecast at step 0, steps 7 to 15 count
SHORT = replace(
    SCHEDULE,
    **{"washout": 1, "quiet_lt": 0.0, "steps_per_lyapunov_time": 3, "sampling_stride": 2},
    time_step=0.1,
)
TIMING = STRATEGY.timing(SHORT)
EDGES = np.array([0.0, 0.5, 1.0, 1.5])
NAMES = [field.name for field in fields(WindowCounts)]


def looks_of(*entries: tuple[int, int, str]) -> Looks:
    """Looks as (flow, step, outcome): "", "suppressed", "unsuppressed", "false", "early"."""
    flow, step, outcome = zip(*entries, strict=True)
    judged = {
        "would_cross": np.isin(outcome, ("suppressed", "unsuppressed")),
        "would_be_under_way": np.isin(outcome, ("early",)),
        "reached": np.isin(outcome, ("unsuppressed",)),
    }
    return Looks(np.array(flow), np.array(step), np.array(outcome) != "", judged)


def flows_of(
    controlled: list[list[float]],
    looks: Looks,
    uncontrolled: Any = None,
    actuated: tuple[int, int] = (0, 0),
) -> ControlledFlows:
    active = np.zeros((len(controlled), 16), dtype=bool)
    active[:, slice(*actuated)] = True
    return simulation_of(
        TIMING,
        controlled,
        uncontrolled=np.zeros((len(controlled), 16)) if uncontrolled is None else uncontrolled,
        looks=looks,
        rows=10 + np.arange(len(controlled)),
        left_out=2,
        actuated=active,
        actuated_integration_steps=np.full(len(controlled), 2 * (actuated[1] - actuated[0])),
    )


def series(*above: int, level: float = 1.0) -> list[float]:
    return [level if step in above else 0.0 for step in range(16)]


def counted(flows: ControlledFlows, laminarisation_threshold: float | None = None) -> dict:
    records = record_flows(flows, laminarisation_threshold)
    return totals(records, count_windows(flows), Span.of(flows.timing), flows.left_out)


QUIET = [(0, step, "") for step in (0, 3, 6, 9, 12)]


def test_windows_of_the_paper_s_control() -> None:
    timing = STRATEGY.timing(PAPER)
    assert STRATEGY.window(PAPER) == (61, 122)
    assert (timing.pauses, timing.first_look, timing.counted_from) == ((61, 122), 29, 29 + 122)
    assert timing.counted_until == 29 + 122 + 1220 == timing.length - 1
    # at 0, 1, ..., 21 Lyapunov times: a later alarm would change nothing that counts
    assert timing.most_looks == 22
    # 1.5 Lyapunov times of 61 steps are 366 integration steps, although 91.5 steps of the network
    for time, effect in ((1.0, (0, 366)), (2.0, (244, 610)), (1.5, (122, 488))):
        assert replace(STRATEGY, prediction_time_lt=time).timing(PAPER).effect == effect
    late = replace(PAPER, delay_lt=0.5)
    assert STRATEGY.timing(late).effect == (122, 488)
    early = replace(STRATEGY, prediction_time_lt=0.5)
    with pytest.raises(ValueError, match=r"not defined for a prediction time of 0\.5"):
        early.timing(PAPER)
    assert early.timing(replace(PAPER, actuation_start_lt=-0.5)).effect == (0, 366)
    with pytest.raises(ValueError, match="lasts no step"):
        STRATEGY.timing(replace(PAPER, actuation_duration_lt=0.0))


@pytest.mark.parametrize("time", [1.0, 1.5, 2.0, 2.5])
@pytest.mark.parametrize("window", [0.5, 1.0])
def test_windows_without_an_alarm_leave_no_gap(time: float, window: float) -> None:
    strategy = PredictionTriggered(time, window)
    start, end = strategy.window(PAPER)
    assert strategy.timing(PAPER).pauses == (end - start, end)


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
def test_an_event_without_alarms_is_missed_if_a_window_covers_it(above: Any, kind: str) -> None:
    counts = counted(flows_of([series(*above)], looks_of(*QUIET)))
    assert counts["events_controlled"] == counts[kind] == 1


def test_an_event_in_a_window_that_began_in_one_is_under_way() -> None:
    # the window from step 6 to 9 begins at or above the threshold
    counts = counted(flows_of([series(6, 8)], looks_of(*QUIET)))
    names = ("missed_events", "events_under_way", "events_controlled")
    assert [counts[name] for name in names] == [1, 1, 2]


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
    looks = looks_of((0, 0, ""), (0, 3, outcome), (0, 9, ""), (0, 12, ""))
    counts = counted(flows_of([series(9)], looks))
    assert counts[kind] == counts["events_controlled"] == 1
    between = counted(flows_of([series(10, 12, 13)], looks))
    assert between["events_between_windows"] == between["events_controlled"] == 2
    # the second of these events lasts into the next window, which it does not cross
    assert between["missed_events"] == 0


def test_alarms_are_told_apart() -> None:
    looks = looks_of(
        *((0, 0, "suppressed"), (0, 6, "early"), (0, 12, "")),
        *((1, 0, "unsuppressed"), (1, 6, "false"), (1, 12, "suppressed")),
    )
    # the first alarm's event is delayed: it comes after step 6, before the next window at 9
    flows = flows_of([series(8), series(9)], looks)
    of_flows = count_windows(flows)
    assert of_flows.alarms.tolist() == [2, 3]
    assert of_flows.true_alarms.tolist() == [1, 2]
    counts = counted(flows)
    expected = {"forecasts": 6, "alarms": 5, "true_alarms": 3, "false_alarms": 2, "early_alarms": 1}
    expected |= {"suppressed_events": 2, "unsuppressed_events": 1, "delayed_events": 1}
    assert counts.items() >= expected.items()
    assert counts["alarm_rate"] == 5 / 6


@pytest.mark.parametrize(("step", "delayed"), [(6, 0), (7, 1), (9, 1), (10, 0)])
def test_a_delayed_event_comes_between_the_alarm_s_window_and_the_next(
    step: int, delayed: int
) -> None:
    # alarm at step 0: window 3 to 6, next window 9 to 12
    looks = looks_of((0, 0, "suppressed"), (0, 6, ""), (0, 9, ""), (0, 12, ""))
    counts = counted(flows_of([series(step)], looks))
    assert counts["delayed_events"] == counts["events_between_windows"] == delayed


def test_statistics_of_the_steps_that_count() -> None:
    flows = flows_of(
        [series(6, 7, 8), series(9)],
        looks_of(*QUIET),
        uncontrolled=np.array([series(5, 12, 13, 14), series(7, 8, level=0.6)]),
        actuated=(8, 11),
    )
    counts = counted(flows)
    expected = {"flows": 2, "left_out": 2, "steps": 18, "integration_steps": 36}
    expected |= {"exceeding_uncontrolled": 3, "exceeding_controlled": 3}
    expected |= {"steps_free": 12, "exceeding_free": 1, "actuated_integration_steps": 12}
    assert counts.items() >= expected.items()
    assert counts["exceedance_uncontrolled"] == counts["exceedance_controlled"] == 3 / 18
    assert counts["exceedance_free"] == 1 / 12
    assert counts["reduction"] == 0.0
    assert counts["control_fraction"] == 12 / 36
    found = observable_histograms(flows, EDGES)
    assert found.histogram_uncontrolled.sum(axis=0).tolist() == [13, 2, 3]
    assert found.histogram_controlled.tolist() == [[7, 0, 2], [8, 0, 1]]
    assert found.histogram_free.sum(axis=0).tolist() == [11, 0, 1]


def test_a_flow_that_laminarises_in_one_sample_counts_in_neither() -> None:
    looks = looks_of(*((flow, 0, "suppressed") for flow in range(4)))
    calm, high = series(9), series(9, level=2.0)
    flows = flows_of([high, calm, high, calm], looks, np.array([calm, high, high, calm]))
    counts = counted(flows, 1.5)
    expected = {"flows": 1, "left_out": 2, "laminarised": 3, "alarms": 1, "forecasts": 1}
    expected |= {"laminarised_controlled": 2, "laminarised_uncontrolled": 2, "steps": 9}
    assert counts.items() >= (expected | {"events_uncontrolled": 1, "events_controlled": 1}).items()
    assert counted(flows)["flows"] == 4
    # exactly at the threshold is not above it
    assert counted(flows, 2.0)["flows"] == 4


def test_ratios_without_flows_are_not_numbers() -> None:
    flows = flows_of([series(9)], looks_of(*QUIET), uncontrolled=np.array([series(9)]))
    counts = counted(flows, 0.5)
    assert counts["flows"] == 0
    for ratio in ("exceedance_uncontrolled", "exceedance_free", "reduction", "alarm_rate"):
        assert np.isnan(counts[ratio])


def test_events_count_from_the_first_forecast_on() -> None:
    flows = flows_of([series(1, 4)], looks_of((0, 2, ""), (0, 5, "")))
    late = replace(flows, timing=STRATEGY.timing(replace(SHORT, washout=3, span_lt=7 / 3)))
    assert [counted(one)["events_controlled"] for one in (flows, late)] == [2, 1]


def test_upward_crossings() -> None:
    observable = np.array([[2.0, 0.0, 1.0, 1.0, 0.9, 3.0], [0.0, 1.0, 0.0, 0.0, 0.0, 0.0]])
    assert np.argwhere(upward_crossings(observable, 1.0)).tolist() == [[0, 2], [0, 5], [1, 1]]


# -- against one plain loop for each flow ----------------------------------------------------------


def plain_judgement(flow: PlainFlow, strategy: Any, schedule: Any, threshold: float) -> list:
    """What would have come of each look, and what came: crossing, under way, reached."""
    start, end = strategy.window(schedule)
    first = strategy.timing(schedule).effect[0] // schedule.sampling_stride
    found = []
    for look in flow.looks:
        judged = (False, False, False)
        if look.alarm:
            window, heights = look.otherwise[start : end + 1], flow.heights[look.step :]
            reached = max(heights[start : end + 1]) >= threshold or any(
                heights[i] < threshold <= heights[i + 1] for i in range(first, start)
            )
            crosses = window[0] < threshold <= max(window)
            judged = (crosses, window[0] >= threshold, reached)
        found.append(judged)
    return found


def plain_ledger(flow: PlainFlow, judged: list, window: Any, threshold: float) -> dict[str, int]:
    """Events of a flow, one step after the other."""
    height, (start, end) = flow.controlled[:, 0], window
    kinds = ("missed_events", "events_under_way", "events_after_true_alarms")
    kinds += ("events_after_false_alarms", "events_between_windows")
    ledger = dict.fromkeys(kinds, 0)
    for step in range(flow.looks[0].step + 1, len(height)):
        if not height[step - 1] < threshold <= height[step]:
            continue
        kind = "events_between_windows"
        for look, (crosses, _, _) in zip(flow.looks, judged, strict=True):
            if not look.step + start < step <= look.step + end:
                continue
            assert kind == "events_between_windows", "two windows overlap"
            if look.alarm:
                kind = "events_after_true_alarms" if crosses else "events_after_false_alarms"
            else:
                under_way = height[look.step + start] >= threshold
                kind = "events_under_way" if under_way else "missed_events"
        ledger[kind] += 1
    return ledger


@settings(max_examples=80, deadline=None)
@given(
    seed=st.integers(0, 2**32 - 1),
    time=st.sampled_from([1.0, 1.5, 2.0]),
    share=st.sampled_from([0.0, 0.3, 0.7, 1.0]),
    duration=st.sampled_from([0.5, 1.5, 4.0]),
    frequency=st.sampled_from([0.05, 1.1]),
    laminar=st.sampled_from([None, 1.3]),
)
# a flow of a radius of almost 5
@example(seed=1567, time=1.0, share=0.0, duration=1.5, frequency=0.05, laminar=None)
def test_counts_are_those_of_a_plain_loop_and_add_up(
    seed: int, time: float, share: float, duration: float, frequency: float, laminar: float | None
) -> None:
    changes = {"steps_per_lyapunov_time": 5, "span_lt": 5.0, "washout": 2, "time_step": 0.25}
    schedule = replace(SHORT, **changes, actuation_duration_lt=duration)
    strategy, generator = PredictionTriggered(time, 1.0), np.random.default_rng(seed)
    timing = strategy.timing(schedule)
    experiment = rotors(generator.normal(size=(2, 12)), schedule, frequency, 0.35)
    policy = random_alarms(share, 12, timing, seed)
    flows = strategy.simulate(experiment, policy, noise=None)
    own, records = count_windows(flows), record_flows(flows, laminar)
    assert own.alarms.tolist() == (own.true_alarms + own.false_alarms).tolist()
    assert own.true_alarms.tolist() == (own.suppressed_events + own.unsuppressed_events).tolist()
    assert (own.alarms <= own.forecasts).all()
    assert (own.early_alarms <= own.false_alarms).all()
    assert (own.delayed_events <= own.suppressed_events).all()
    # bins that hold every value: values outside of them are in none
    bound = 1 + np.abs([flows.controlled, flows.uncontrolled]).max(initial=0.0)
    histograms = observable_histograms(flows, np.linspace(-bound, bound, 9))
    for sample in (histograms.histogram_controlled, histograms.histogram_uncontrolled):
        assert (sample.sum(axis=1) == timing.span).all()
    assert histograms.histogram_free.sum(axis=1).tolist() == own.steps_free.tolist()
    counts = totals(records, own, Span.of(timing), flows.left_out)
    assert counts["flows"] + counts["left_out"] + counts["laminarised"] == 12
    assert counts["steps"] == counts["flows"] * timing.span
    assert counts["exceeding_free"] <= counts["exceeding_controlled"] <= counts["steps"]
    summed = dict.fromkeys(("alarms", "exceeding_controlled", "actuated_integration_steps"), 0)
    for flow, row in enumerate(flows.rows):
        plain = plain_flow(
            experiment, row, timing, lambda number, _, row=row: int(policy.table[row, number])
        )
        judged = plain_judgement(plain, strategy, schedule, 0.9)
        mine = flows.looks.flow == flow
        for name, expected in zip(
            ("would_cross", "would_be_under_way", "reached"), zip(*judged, strict=True), strict=True
        ):
            assert flows.looks.judged[name][mine].tolist() == [*expected], name
        ledger = plain_ledger(plain, judged, strategy.window(schedule), 0.9)
        assert {name: int(getattr(own, name)[flow]) for name in ledger} == ledger
        heights = np.stack([plain.controlled[:, 0], plain.uncontrolled[:, 0]])
        if laminar is None or heights.max() <= laminar:
            summed["alarms"] += sum(look.alarm for look in plain.looks)
            summed["exceeding_controlled"] += int((heights[0, timing.counted] >= 0.9).sum())
            acting = plain.acting[timing.counted_from * 2 : timing.counted_until * 2]
            summed["actuated_integration_steps"] += sum(acting)
    assert counts.items() >= summed.items()


@pytest.mark.parametrize(
    ("time", "start_lt", "crest", "number", "threshold", "expected"),
    [
        # the window from step 30 to 35 begins at the threshold: the event lasts into it
        (1.0, -1.0, 22, 5, "at step 30", (False, True, True)),
        (1.0, -1.0, 22, 5, "above it", (False, False, False)),
        # between the actuation, from step 17 on, and the window, which begins at step 25
        (2.0, -1.5, 19, 3, 0.98, (False, False, False)),  # crosses at 17: not to be prevented
        (2.0, -1.5, 20, 3, 0.98, (False, False, True)),  # crosses at step 18
        (2.0, -1.5, 22, 3, 0.98, (False, False, True)),  # is over at step 25
        (2.0, -1.5, 23, 3, 0.98, (False, True, True)),  # lasts into the window
    ],
)
def test_an_event_counts_as_reached_from_the_actuation_on(
    time: float, start_lt: float, crest: int, number: int, threshold: Any, expected: Any
) -> None:
    schedule = replace(SHORT, span_lt=8.0, steps_per_lyapunov_time=5, sampling_stride=1)
    changes = {"actuation_start_lt": start_lt, "actuation_duration_lt": 1.0, "time_step": 0.3}
    schedule, strategy = replace(schedule, **changes), PredictionTriggered(time, 1.0)
    first = np.array([[np.cos(0.09 * crest)], [-np.sin(0.09 * crest)]])
    given = replace(rotors(first, schedule, 0.3), quiet_starts=False)
    policy = random_alarms(0.0, 1, strategy.timing(schedule))
    policy.table[0, number] = True

    def simulated(level: float) -> ControlledFlows:
        return strategy.simulate(replace(given, threshold=level), policy, noise=None)

    heights = simulated(2.0).controlled[0]
    assert heights[:40].argmax() == crest
    at = heights[30]
    levels = {"at step 30": at, "above it": np.nextafter(at, 2.0)}
    looks = simulated(levels.get(threshold, threshold)).looks
    assert looks.step[looks.alarm].tolist() == [5 * number]
    judged = (looks.judged[name][looks.alarm][0] for name in looks.judged)
    assert tuple(map(bool, judged)) == expected


def test_a_perfect_forecaster_raises_no_false_alarm() -> None:
    schedule = replace(PAPER, span_lt=4.0, washout=1)
    flows = run(STRATEGY, experiment(40, schedule, threshold=0.1))
    assert flows.looks.alarm.sum() > 5
    np.testing.assert_array_equal(flows.looks.alarm, flows.looks.judged["would_cross"])


@pytest.mark.long
def test_the_equations_reduce_exceedance_and_chance_does_not() -> None:
    schedule = replace(PAPER, span_lt=10.0, washout=1)
    washouts = turbulent_washouts(FLOW, 200, schedule, seed=8, steps=1600)
    given = experiment(200, schedule, threshold=0.1, washouts=washouts)
    perfect = counted(run(STRATEGY, given), 0.48)
    policy = controlling_policy("random", STRATEGY, given, [], perfect["alarm_rate"], 4)
    chance = counted(STRATEGY.simulate(given, policy, noise=None), 0.48)
    assert perfect["false_alarms"] == 0
    assert perfect["exceedance_uncontrolled"] == pytest.approx(0.13, abs=0.04)
    assert perfect["reduction"] > 0.6
    assert abs(chance["control_fraction"] - perfect["control_fraction"]) < 0.03
    assert abs(chance["reduction"]) < 0.25


# -- the suppressed event that is shown ------------------------------------------------------------


def test_the_largest_suppressed_event_is_found() -> None:
    looks = looks_of(
        *((0, 3, "suppressed"), (1, 3, "suppressed"), (2, 0, "false"), (2, 6, "suppressed")),
        *((3, 3, "unsuppressed"), (4, 3, "suppressed"), (5, 9, "suppressed")),
    )
    levels = (1.1, 1.2, 1.9, 1.8, 1.7, 1.95)
    uncontrolled = np.array([series(5, 8, 14, level=level) for level in levels])
    # the event of flow 4 is only delayed; that of flow 2 does not follow its first alarm; that of
    # flow 5 has no room for the steps after it
    controlled = [series(), series(), series(), series(9), series(11), series()]
    flows = flows_of(controlled, looks, uncontrolled)
    event = largest_suppressed_event(flows, None)
    assert event is not None
    assert (event.flow, event.row, event.alarm_step) == (1, 11, 3)
    first_below = largest_suppressed_event(flows, 1.15)
    assert first_below is not None
    assert first_below.flow == 0
    assert largest_suppressed_event(flows, 1.05) is None
    # its steps, up to the next window's first at 12, may end with the last one that counts
    assert largest_suppressed_event(
        replace(flows, timing=STRATEGY.timing(replace(SHORT, span_lt=2.0))), None
    ) == replace(event)
    assert (
        largest_suppressed_event(
            replace(flows, timing=STRATEGY.timing(replace(SHORT, span_lt=5 / 3))), None
        )
        is None
    )


@pytest.mark.parametrize(
    ("observable", "start", "window", "expected"),
    [
        ([0, 0, 0.5, 0.9, 1.0, 3.0, 2.0, 0.9, 0.1], 2, (3, 6), (2, 4, 5, 7)),
        # an earlier and a later event are not looked at
        ([9, 0, 5.0, 0.9, 1.1, 0.5, 0, 7.0, 0], 1, (3, 6), (1, 4, 4, 5)),
        # under way at the end
        ([0, 0, 0.5, 1.5, 2.0], 0, (1, 4), (0, 3, 4, 4)),
    ],
)
def test_times_of_an_event(observable: Any, start: int, window: Any, expected: Any) -> None:
    assert suppressed_event_times(np.array(observable), 1.0, start, window) == expected


@pytest.mark.parametrize("observable", [[0, 0, 0, 2.0], [0, 2.0, 2.0, 2.0]])
def test_an_event_outside_the_window_is_refused(observable: list[float]) -> None:
    with pytest.raises(ValueError, match="does not cross"):
        suppressed_event_times(np.array(observable), 1.0, 0, (1, 2))


def test_an_event_is_followed_again_as_it_was_found() -> None:
    given = experiment(30)
    followed = run(STRATEGY, given, keep_states=True)
    chosen = largest_suppressed_event(followed, None)
    assert chosen is not None
    found = simulate_event(chosen, STRATEGY, given, EQUATIONS, None)
    steps = np.rint(found.time_lt * 20).astype(int)
    shown = chosen.alarm_step + steps
    np.testing.assert_array_equal(np.diff(shown), 1)
    assert steps[0] == max(-20, -chosen.alarm_step)
    np.testing.assert_allclose(found.uncontrolled, followed.uncontrolled[chosen.flow, shown])
    np.testing.assert_allclose(found.controlled, followed.controlled[chosen.flow, shown])
    # the equations, from the true state: what happens if nobody acts
    ahead = (steps > 0) & (steps <= STRATEGY.window(SCHEDULE)[1])
    np.testing.assert_array_equal(np.isfinite(found.forecast), ahead)
    np.testing.assert_allclose(found.forecast[ahead], found.uncontrolled[ahead], rtol=1e-6)
    np.testing.assert_allclose(found.actuation_lt, [0.0, 1.5])
    assert followed.uncontrolled_states is not None
    states = followed.uncontrolled_states[chosen.flow, shown[found.mark]]
    np.testing.assert_allclose(found.uncontrolled_state, states)
    assert found.uncontrolled[found.mark[2]] == found.uncontrolled[found.mark[1] :].max()
    assert found.controlled_state.shape == (4, 9)
    # with noise: so little that the same alarm is raised, and yet more than rounding
    noise = np.random.default_rng(3).normal(0.0, 1e-7, (30, followed.timing.length, 9))
    noisy = simulate_event(chosen, STRATEGY, given, EQUATIONS, noise)
    washout = slice(chosen.alarm_step + 1 - SCHEDULE.washout, chosen.alarm_step + 1)
    assert followed.controlled_states is not None
    observed = followed.controlled_states[chosen.flow, washout] + noise[chosen.row, washout]
    expected = forecast_observable(EQUATIONS, FLOW.observable, observed[np.newaxis], 40)
    forecast = noisy.forecast[np.isfinite(noisy.forecast)]
    np.testing.assert_allclose(forecast, expected[0], rtol=1e-9)


def test_an_event_is_shown_from_the_start_of_the_actuation() -> None:
    """Half a Lyapunov time after the alarm, which is ten steps."""
    strategy, given = PredictionTriggered(1.5, 1.0), experiment(40)
    chosen = largest_suppressed_event(run(strategy, given), None)
    assert chosen is not None
    found = simulate_event(chosen, strategy, given, EQUATIONS, None)
    np.testing.assert_allclose(found.time_lt[found.mark[0]], 0.5)
    np.testing.assert_allclose(found.actuation_lt, [0.5, 2.0])


def test_without_an_event_nothing_is_followed() -> None:
    found = simulate_event(None, STRATEGY, experiment(2), EQUATIONS, None)
    assert found.time_lt.size == found.mark.size == found.uncontrolled_state.size == 0
    np.testing.assert_allclose(found.actuation_lt, [0.0, 1.5])
