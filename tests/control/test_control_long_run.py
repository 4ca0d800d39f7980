"""Long runs of control: counted like the flows that are kept, and laminarisations apart."""

from dataclasses import replace

import numpy as np
import pytest
from helpers_control import EQUATIONS, FLOW, PAPER, SCHEDULE, experiment, random_alarms

from burstcast.control import long_run
from burstcast.control.long_run import EndlessFlows, ObservationNoise, _Counting, run_long
from burstcast.control.strategies.prediction_triggered import PredictionTriggered
from burstcast.control.strategies.reactive import Reactive
from burstcast.control.strategies.receding_horizon import RecedingHorizon
from burstcast.control.strategies.uncontrolled import Uncontrolled
from burstcast.data.events import upward_crossings
from burstcast.systems.forced import ForcedSystem

LEVELS = [0.05, 0.07, 0.1]
STRATEGIES = {
    "free": Uncontrolled(),
    "reactive": Reactive(decision_interval_lt=0.25, level=0.06),
    "receding": RecedingHorizon(decision_interval_lt=0.25, horizon_lt=1.0),
    "paper's": PredictionTriggered(prediction_time_lt=2.0, window_lt=1.0),
}


@pytest.mark.parametrize("delay_lt", [0.0, 0.4])
@pytest.mark.parametrize("name", STRATEGIES)
def test_long_runs_count_the_flows_that_are_kept_elsewhere(name, delay_lt):
    """Eighteen settled Lyapunov times, in segments, or as one array of states."""
    strategy = STRATEGIES[name]
    schedule = replace(SCHEDULE, quiet_lt=6.0, span_lt=18.0, delay_lt=delay_lt)
    given = experiment(9, schedule, quiet_starts=False)
    policy = strategy.policy(given, EQUATIONS)
    flows = strategy.simulate(given, policy, noise=None)
    counts = run_long(
        given,
        strategy.timing(schedule),
        policy,
        levels=LEVELS,
        laminarisation_threshold=None,
    )
    counted = flows.timing.counted
    # an excursion above the lowest level that is under way when counting begins has no events
    low = flows.controlled[:, counted.start - 1 : counted.stop - 1] < min(LEVELS)
    begun = np.logical_or.accumulate(low, axis=1)
    assert counts.steps.tolist() == [counted.stop - counted.start] * 9
    for column, level in enumerate(LEVELS):
        crossings = (upward_crossings(flows.controlled, level)[:, counted] & begun).sum(axis=1)
        assert counts.events[:, column].tolist() == crossings.tolist()
        exceeding = (flows.controlled[:, counted] >= level).sum(axis=1)
        assert counts.exceeding[:, column].tolist() == exceeding.tolist()
    assert counts.actuated_steps.tolist() == flows.actuated[:, counted].sum(axis=1).tolist()
    assert counts.events.sum() > 0
    assert (counts.actuated_steps.sum() > 0) == (name != "free")
    assert not counts.laminarisations.any()


@pytest.mark.parametrize("segment_lt", [1.0, 6.0])
def test_the_length_of_segments_changes_nothing(segment_lt, monkeypatch):
    """With noise, whose streams go on from segment to segment."""
    schedule = replace(SCHEDULE, quiet_lt=0.0, span_lt=12.0)
    given, strategy = experiment(5, schedule), STRATEGIES["paper's"]
    scale = 0.02 * given.washouts.std(axis=(0, 1))

    def counts():
        result = run_long(
            given,
            replace(strategy.timing(schedule), settling=0),
            strategy.policy(given, EQUATIONS),
            levels=LEVELS,
            laminarisation_threshold=None,
            noise_scale=scale,
        )
        return [array.tolist() for array in vars(result).values()]

    usual = counts()
    monkeypatch.setattr(long_run, "_SEGMENT_LT", segment_lt)
    assert counts() == usual


def test_batches_change_nothing(monkeypatch):
    given, strategy = experiment(7), STRATEGIES["receding"]
    scale = 0.02 * given.washouts.std(axis=(0, 1))

    def counts():
        policy, timing = strategy.policy(given, EQUATIONS), strategy.timing(given.schedule)
        named = {"levels": LEVELS, "laminarisation_threshold": None, "noise_scale": scale}
        return [array.tolist() for array in vars(run_long(given, timing, policy, **named)).values()]

    usual = counts()
    monkeypatch.setattr(long_run, "FLOWS_PER_BATCH", 3)
    assert counts() == usual


def test_noise_is_white_and_of_its_scale():
    given, scale = experiment(4), np.array([0.1, 0.2, 0.3])
    noise = ObservationNoise(given, scale)
    drawn = np.concatenate([noise.draw(3000), noise.draw(2000)], axis=1)
    np.testing.assert_allclose(drawn.std(axis=(0, 1)), scale, rtol=0.03)
    assert abs(np.corrcoef(drawn[0, 1:, 0], drawn[0, :-1, 0])[0, 1]) < 0.05
    assert abs(np.corrcoef(drawn[0, :, 0], drawn[1, :, 0])[0, 1]) < 0.05


def plain_counts(observable, levels, settling, threshold, segment):
    """Counts of one flow, step by step; it laminarises once in a segment at most.

    Returns events, exceeding steps, counted steps and laminarisations.
    """
    events, exceeding = [0] * len(levels), [0] * len(levels)
    steps, laminarisations, age, step = 0, 0, 0, 1
    was_low = False
    excursion = [0] * len(levels)
    while step < len(observable):
        age += 1
        if threshold is not None and observable[step] > threshold:
            laminarisations += age > settling
            events = [number - begun for number, begun in zip(events, excursion, strict=True)]
            excursion = [0] * len(levels)
            age, was_low = 0, False
            step = segment * (1 + (step - 1) // segment) + 1  # a copy from the next segment on
            continue
        if age > settling:
            steps += 1
            was_low |= observable[step - 1] < min(levels)
            for number, level in enumerate(levels):
                exceeding[number] += observable[step] >= level
                if was_low and observable[step - 1] < level <= observable[step]:
                    events[number] += 1
                    excursion[number] += 1
        if observable[step] < min(levels):
            excursion = [0] * len(levels)
        step += 1
    return events, exceeding, steps, laminarisations


@pytest.mark.parametrize("settling", [0, 3, 25])
@pytest.mark.parametrize("threshold", [None, 2.0, 2.8])
def test_laminarisation_is_no_event_of_any_level(settling, threshold):
    """Walks of eighty steps in segments of ten; copies go on with the walk as it is."""
    generator, levels = np.random.default_rng(4), [0.5, 1.0, 1.9]
    walks = 0.8 * generator.normal(size=(60, 81)).cumsum(axis=1)
    counts = _Counting(60, np.array(levels), settling, threshold)
    for start in range(0, 80, 10):
        laminar = counts.add(walks[:, start : start + 11], np.ones((60, 10), dtype=bool))
        counts.age[laminar] = 0
    for flow, walk in enumerate(walks):
        events, exceeding, steps, laminarisations = plain_counts(
            walk, levels, settling, threshold, 10
        )
        assert counts.events[flow].tolist() == events
        assert counts.exceeding[flow].tolist() == exceeding
        assert counts.steps[flow] == counts.actuated[flow] == steps
        assert counts.laminarisations[flow] == laminarisations
    assert (counts.laminarisations.sum() > 5) == (threshold is not None)


def test_laminarised_flows_are_replaced_by_turbulent_ones():
    """A flow that begins laminar is a copy of another one, a hair apart, from there on."""
    schedule = replace(PAPER, quiet_lt=8.0, span_lt=20.0)
    given = experiment(6, schedule, threshold=0.1)
    given.washouts[2] = np.eye(9)[0]  # the laminar state
    timing, policy = Uncontrolled().timing(schedule), Uncontrolled().policy(given, None)
    named = {"levels": [0.1], "laminarisation_threshold": 0.48}
    counts = run_long(given, timing, policy, **named)
    # it laminarised before it settled; its copy settles, too
    expected = [7 * 4 - 8] * 6
    expected[2] -= 4
    steps = 61 * np.array(expected)
    kept = counts.laminarisations == 0
    assert kept[2]
    assert counts.steps[kept].tolist() == steps[kept].tolist()
    flows = EndlessFlows(given, timing, None)
    flows.run_segment(policy)
    flows.forget_segment()
    flows.replace(np.array([2]), np.array([4]), np.full((1, 9), 1e-6))
    now = flows.clock[2]
    assert now == flows.clock[4]
    np.testing.assert_allclose(flows.states[2, now] - flows.states[4, now], 1e-6)


def test_a_flow_that_escapes_under_control_is_counted_and_replaced():
    """The others keep their bits; its copy counts from the next segment on."""
    given = experiment(3, threshold=10.0, actuated_system=ForcedSystem(FLOW, [1e200] * 9))
    strategy = STRATEGIES["receding"]
    schedule = replace(given.schedule, quiet_lt=0.0, span_lt=12.0)
    given, timing = replace(given, schedule=schedule), strategy.timing(schedule)
    policy = random_alarms(0.0, 3, timing)
    named = {"levels": LEVELS, "laminarisation_threshold": 0.48}
    free = run_long(given, timing, policy, **named)
    policy.table[1, 1] = True
    counts = run_long(given, timing, policy, **named)
    assert counts.escapes.tolist() == [0, 1, 0]
    assert not counts.laminarisations.any()
    for name, values in vars(counts).items():
        if name != "level":
            np.testing.assert_array_equal(values[[0, 2]], getattr(free, name)[[0, 2]])
    segment = schedule.steps(4.0)
    assert counts.steps.tolist() == [3 * segment, timing.pauses[0] + 2 * segment, 3 * segment]
    assert not counts.actuated_steps.any()
    policy.table[:, 1] = True
    with pytest.raises(FloatingPointError, match="all 3 controlled flows left the range"):
        run_long(given, timing, policy, **named)


def test_an_excursion_that_ends_in_an_escape_is_no_event():
    """Of two flows, one comes back from the level, and one leaves the range of numbers."""
    counting = _Counting(2, np.array([0.1]), 0, 0.48)
    observable = np.array([[0.0, 0.2, 0.3, 0.0, 0.0], [0.0, 0.2, 9.0, np.nan, np.nan]])
    assert counting.add(observable, np.ones((2, 4), dtype=bool)).tolist() == [1]
    assert counting.events.tolist() == [[1], [0]]
    assert (counting.escapes.tolist(), counting.laminarisations.tolist()) == ([0, 1], [0, 0])
    assert counting.steps.tolist() == counting.actuated.tolist() == [4, 1]


def test_a_batch_without_a_turbulent_flow_is_told():
    given = experiment(2, replace(PAPER, span_lt=5.0))
    given.washouts[:] = np.eye(9)[0]
    strategy = Uncontrolled()
    with pytest.raises(RuntimeError, match=r"all 2 flows laminarised.*control\.flows"):
        run_long(
            given,
            strategy.timing(given.schedule),
            strategy.policy(given, None),
            levels=[0.1],
            laminarisation_threshold=0.48,
        )


def test_free_flow_laminarises_at_its_known_rate():
    """0.0058 per Lyapunov time, and an event in 19, in a long run of another program."""
    schedule = replace(PAPER, quiet_lt=20.0, span_lt=40.0)
    given = experiment(400, schedule, threshold=0.1)
    strategy = Uncontrolled()
    counts = run_long(
        given,
        strategy.timing(schedule),
        strategy.policy(given, None),
        levels=[0.1],
        laminarisation_threshold=0.48,
    )
    time = counts.steps.sum() / 61
    assert counts.laminarisations.sum() / time == pytest.approx(0.0058, rel=0.3)
    assert time / counts.events.sum() == pytest.approx(19, rel=0.15)
    assert FLOW.reynolds == 400
