"""The windows of the paper's control: alarms and events in categories, and the event shown."""

from dataclasses import fields, replace

import numpy as np
import pytest
from helpers_control import (
    EQUATIONS,
    FLOW,
    PAPER,
    SCHEDULE,
    experiment,
    plain_flow,
    random_alarms,
    rotors,
    run,
    simulation_of,
)
from hypothesis import given, settings
from hypothesis import strategies as st

from burstcast.control.example import simulate_event, suppressed_event_times
from burstcast.control.loop import Looks
from burstcast.control.records import FlowSample, Span, record_flows
from burstcast.control.strategies.prediction_triggered import PredictionTriggered
from burstcast.control.windows import (
    SuppressedEvent,
    WindowCounts,
    count_windows,
    largest_suppressed_event,
    observable_histograms,
    totals,
)
from burstcast.forecasts.examples import forecast_observable

STRATEGY = PredictionTriggered(1.0, 1.0)
SHORT = replace(
    SCHEDULE,
    **{"washout": 3, "quiet_lt": 0.0, "steps_per_lyapunov_time": 3, "sampling_stride": 2},
    time_step=0.1,
)
JUDGED = ("would_cross", "would_be_under_way", "reached")


def test_windows_of_the_paper_s_control():
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


# -- counts, against one plain loop for each flow --------------------------------------------------

OUTCOMES = {  # what is judged of each look: "" has no alarm
    "": (False, False, False),
    "suppressed": (True, False, False),
    "unsuppressed": (True, False, True),
    "false": (False, False, True),
    "early": (False, True, False),
}


def random_flows(seed, share):
    """Flows of a few heights, of which a share is at or above the threshold, 1.

    Windows are from 3 to 6 steps after a look; the first look is at step 2, steps 9 to 17 count.
    """
    generator, timing, flows = np.random.default_rng(seed), STRATEGY.timing(SHORT), 12
    odds, size = 0.5 * np.array([1 - share, 1 - share, share, share]), (flows, timing.length)
    entries = []
    for flow in range(flows):
        step = timing.first_look
        while step <= timing.last_look:
            outcome = generator.choice(list(OUTCOMES))
            entries.append((flow, step, bool(outcome), *OUTCOMES[outcome]))
            step += 6 if outcome else 3
    flow, step, alarm, *judged = map(np.array, zip(*entries, strict=True))
    controlled = generator.choice([0.0, 0.6, 1.0, 2.0], size, p=odds)
    return simulation_of(
        *(timing, controlled),
        uncontrolled=generator.choice([0.0, 0.6, 1.0, 2.0, 3.0], size),
        looks=Looks(flow, step, alarm, step % 4 == 0, dict(zip(JUDGED, judged, strict=True))),
        **{"rows": 10 + np.arange(flows), "left_out": 2, "actuated": generator.random(size) < 0.3},
        actuated_integration_steps=generator.integers(0, 18, flows),
    )


RANDOM_FLOWS = st.builds(random_flows, st.integers(0, 2**32 - 1), st.sampled_from([0.02, 0.3]))
LAMINAR = st.sampled_from([None, 0.5, 2.0, 3.0])


def kept_flows(flows, laminar):
    """Flows that laminarise neither with control nor without it."""
    highest = np.maximum(flows.controlled, flows.uncontrolled)[:, 2:].max(axis=1)
    return [flow for flow in range(12) if laminar is None or highest[flow] <= laminar]


def plain_counts(flows, flow):
    """Counts of one flow, one look and one step after the other."""
    looks, height = flows.looks, flows.controlled[flow]
    counts = dict.fromkeys((field.name for field in fields(WindowCounts)), 0)
    events = [step for step in range(3, 18) if height[step - 1] < 1 <= height[step]]
    windows = {}
    for look in np.flatnonzero(looks.flow == flow):
        now = int(looks.step[look])
        crosses, under_way, reached = (bool(looks.judged[name][look]) for name in JUDGED)
        counts["forecasts"] += 1
        kind = "events_under_way" if height[min(now + 3, 17)] >= 1 else "missed_events"
        if looks.alarm[look]:
            counts["alarms"] += 1
            counts["true_alarms" if crosses else "false_alarms"] += 1
            counts["early_alarms"] += under_way
            kind = "events_after_true_alarms" if crosses else "events_after_false_alarms"
        if crosses:
            counts["unsuppressed_events" if reached else "suppressed_events"] += 1
            late = any(now + 6 < step <= now + 9 for step in events)
            counts["delayed_events"] += late and not reached
        windows |= dict.fromkeys(range(now + 4, now + 7), kind)
    for step in events:
        counts[windows.get(step, "events_between_windows")] += 1
    free = [step for step in range(9, 18) if not flows.actuated[flow, step]]
    counts["steps_free"] = len(free)
    counts["exceeding_free"] = sum(height[step] >= 1 for step in free)
    return counts


@settings(max_examples=40, deadline=None)
@given(flows=RANDOM_FLOWS, laminar=LAMINAR)
def test_count_windows_and_totals_are_those_of_a_plain_loop(flows, laminar):
    counts, records = count_windows(flows), record_flows(flows, laminar)
    expected = [plain_counts(flows, flow) for flow in range(12)]
    for name, of_flows in vars(counts).items():
        assert of_flows.tolist() == [of_flow[name] for of_flow in expected], name
    kept = kept_flows(flows, laminar)
    total = {name: sum(expected[flow][name] for flow in kept) for name in expected[0]}
    controlled, uncontrolled = flows.controlled[kept], flows.uncontrolled[kept]
    for name, heights in (("controlled", controlled), ("uncontrolled", uncontrolled)):
        total[f"exceeding_{name}"] = int((heights[:, 9:] >= 1).sum())
        highest = getattr(flows, name)[:, 2:].max(axis=1)
        total[f"laminarised_{name}"] = sum(highest > laminar) if laminar else 0
    rises = (uncontrolled[:, 8:-1] < 1) & (uncontrolled[:, 9:] >= 1)
    kinds = ("missed_events", "events_under_way", "events_after_true_alarms")
    kinds += ("events_after_false_alarms", "events_between_windows")
    acting = flows.actuated_integration_steps[kept].sum()
    total |= {"flows": len(kept), "left_out": 2, "laminarised": 12 - len(kept)}
    total["escaped"] = 0
    total |= {"steps": 9 * len(kept), "integration_steps": 18 * len(kept)}
    total |= {"actuated_integration_steps": acting, "events_uncontrolled": rises.sum()}
    total["events_controlled"] = sum(total[name] for name in kinds)

    def share(part, whole):
        return total[part] / total[whole] if total[whole] else np.nan

    shares = {
        "exceedance_uncontrolled": share("exceeding_uncontrolled", "steps"),
        "exceedance_controlled": share("exceeding_controlled", "steps"),
        "exceedance_free": share("exceeding_free", "steps_free"),
        "reduction": 1 - share("exceeding_controlled", "exceeding_uncontrolled"),
        "control_fraction": share("actuated_integration_steps", "integration_steps"),
        "alarm_rate": share("alarms", "forecasts"),
        "fallback_fraction": np.nan,
    }
    at_kept = np.isin(flows.looks.flow, kept)
    if at_kept.any():
        shares["fallback_fraction"] = flows.looks.without_forecast[at_kept].mean()
    computed = totals(FlowSample(records, Span.of(flows.timing)), counts, flows.left_out)
    assert computed == pytest.approx(total | shares, nan_ok=True)


@settings(max_examples=20, deadline=None)
@given(flows=RANDOM_FLOWS)
def test_observable_histograms_are_of_the_steps_that_count(flows):
    edges = np.array([0.0, 0.5, 1.0, 1.5])  # values beyond them are in no bin
    histograms = observable_histograms(flows, edges)
    for flow in range(12):
        controlled = flows.controlled[flow, 9:]
        samples = {"uncontrolled": flows.uncontrolled[flow, 9:], "controlled": controlled}
        samples["free"] = controlled[~flows.actuated[flow, 9:]]
        for name, sample in samples.items():
            counts = getattr(histograms, f"histogram_{name}")[flow].tolist()
            assert counts == np.histogram(sample, edges)[0].tolist()


# -- alarms, against one plain loop for each flow --------------------------------------------------


def plain_judgement(flow, strategy, schedule, threshold):
    """What would have come of each look, and what came: crossing, under way, reached."""
    start, end = strategy.window(schedule)
    first = strategy.timing(schedule).effect[0] // schedule.sampling_stride
    alarms = []
    for look in flow.looks:
        judged = (False, False, False)
        if look.alarm:
            window, heights = look.otherwise[start : end + 1], flow.heights[look.step :]
            reached = max(heights[start : end + 1]) >= threshold or any(
                heights[i] < threshold <= heights[i + 1] for i in range(first, start)
            )
            crosses = window[0] < threshold <= max(window)
            judged = (crosses, window[0] >= threshold, reached)
        alarms.append(judged)
    return alarms


@settings(max_examples=40, deadline=None)
@given(
    seed=st.integers(0, 2**32 - 1),
    time=st.sampled_from([1.0, 1.5, 2.0]),
    share=st.sampled_from([0.3, 0.7, 1.0]),
    duration=st.sampled_from([0.5, 1.5, 4.0]),
    frequency=st.sampled_from([0.05, 1.1]),
)
def test_judge_alarms_is_a_plain_loop(seed, time, share, duration, frequency):
    changes = {"steps_per_lyapunov_time": 5, "span_lt": 5.0, "washout": 2, "time_step": 0.25}
    schedule = replace(SHORT, **changes, actuation_duration_lt=duration)
    strategy, generator = PredictionTriggered(time, 1.0), np.random.default_rng(seed)
    timing, (start, _) = strategy.timing(schedule), strategy.window(schedule)
    experiment = rotors(generator.normal(size=(2, 6)), schedule, frequency, 0.35)
    experiment = replace(experiment, quiet_starts=False)
    policy = random_alarms(share, 6, timing, seed)
    plain = [
        plain_flow(
            experiment, row, timing, lambda number, _, row=row: int(policy.table[row, number])
        )
        for row in range(6)
    ]
    # thresholds that a flow has at the first step of a window, with and without control
    alarms = [(flow, look) for flow in plain for look in flow.looks if look.alarm]
    flow, look = alarms[seed % len(alarms)] if alarms else (plain[0], plain[0].looks[0])
    reached = [flow.heights[look.step + start], *look.otherwise[start : start + 1]]
    for threshold in (0.9, *reached):
        given = replace(experiment, threshold=threshold)
        looks = strategy.simulate(given, policy, noise=None).looks
        for number, flow in enumerate(plain):
            judged = plain_judgement(flow, strategy, schedule, threshold)
            for name, expected in zip(JUDGED, zip(*judged, strict=True), strict=True):
                assert looks.judged[name][looks.flow == number].tolist() == [*expected], name


# -- the suppressed event that is shown ------------------------------------------------------------


@settings(max_examples=60, deadline=None)
@given(flows=RANDOM_FLOWS, laminar=LAMINAR)
def test_largest_suppressed_event_is_that_of_a_plain_search(flows, laminar):
    expected, largest = None, 0.0
    for flow in kept_flows(flows, laminar):
        mine = np.flatnonzero((flows.looks.flow == flow) & flows.looks.alarm)
        for look in mine[:1]:  # the first alarm in its flow
            now = int(flows.looks.step[look])
            # up to the next window's first step, which counts
            room = now + 9 <= 17 and flows.controlled[flow, now : now + 10].max() < 1
            peak = flows.uncontrolled[flow, now + 3 : now + 7].max()
            if flows.looks.judged["would_cross"][look] and room and peak > largest:
                expected, largest = SuppressedEvent(flow, 10 + flow, now), peak
    assert largest_suppressed_event(flows, laminar) == expected


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
def test_times_of_an_event(observable, start, window, expected):
    assert suppressed_event_times(np.array(observable), 1.0, start, window) == expected


@pytest.mark.parametrize("observable", [[0, 0, 0, 2.0], [0, 2.0, 2.0, 2.0]])
def test_an_event_outside_the_window_is_refused(observable):
    with pytest.raises(ValueError, match="does not cross"):
        suppressed_event_times(np.array(observable), 1.0, 0, (1, 2))


def test_an_event_is_followed_again_as_it_was_found():
    given = experiment(30)
    followed = run(STRATEGY, given, keep_states=True)
    chosen = largest_suppressed_event(followed, None)
    event = simulate_event(chosen, STRATEGY, given, EQUATIONS, None)
    steps = np.rint(event.time_lt * 20).astype(int)
    shown = chosen.alarm_step + steps
    np.testing.assert_array_equal(np.diff(shown), 1)
    assert steps[0] == max(-20, -chosen.alarm_step)
    np.testing.assert_allclose(event.uncontrolled, followed.uncontrolled[chosen.flow, shown])
    np.testing.assert_allclose(event.controlled, followed.controlled[chosen.flow, shown])
    # the equations, from the true state: what happens if nobody acts
    ahead = (steps > 0) & (steps <= STRATEGY.window(SCHEDULE)[1])
    np.testing.assert_array_equal(np.isfinite(event.forecast), ahead)
    np.testing.assert_allclose(event.forecast[ahead], event.uncontrolled[ahead], rtol=1e-6)
    np.testing.assert_allclose(event.actuation_lt, [0.0, 1.5])
    states = followed.uncontrolled_states[chosen.flow, shown[event.mark]]
    np.testing.assert_allclose(event.uncontrolled_state, states)
    assert event.uncontrolled[event.mark[2]] == event.uncontrolled[event.mark[1] :].max()
    assert event.controlled_state.shape == (4, 9)
    # with noise: so little that the same alarm is raised, and yet more than rounding
    noise = np.random.default_rng(3).normal(0.0, 1e-7, (30, followed.timing.length, 9))
    noisy = simulate_event(chosen, STRATEGY, given, EQUATIONS, noise)
    washout = slice(chosen.alarm_step + 1 - SCHEDULE.washout, chosen.alarm_step + 1)
    observed = followed.controlled_states[chosen.flow, washout] + noise[chosen.row, washout]
    expected = forecast_observable(EQUATIONS, FLOW.observable, observed[np.newaxis], 40)
    forecast = noisy.forecast[np.isfinite(noisy.forecast)]
    np.testing.assert_allclose(forecast, expected[0], rtol=1e-9)


def test_an_event_is_shown_from_the_start_of_the_actuation():
    """Half a Lyapunov time after the alarm, which is ten steps."""
    strategy, given = PredictionTriggered(1.5, 1.0), experiment(40)
    chosen = largest_suppressed_event(run(strategy, given), None)
    event = simulate_event(chosen, strategy, given, EQUATIONS, None)
    np.testing.assert_allclose(event.time_lt[event.mark[0]], 0.5)
    np.testing.assert_allclose(event.actuation_lt, [0.5, 2.0])


def test_without_an_event_nothing_is_followed():
    event = simulate_event(None, STRATEGY, experiment(2), EQUATIONS, None)
    assert event.time_lt.size == event.mark.size == event.uncontrolled_state.size == 0
    np.testing.assert_allclose(event.actuation_lt, [0.0, 1.5])
