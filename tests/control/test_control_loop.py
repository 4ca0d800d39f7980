"""The loop of control, against one plain loop for each flow, under all ways to look at flows."""

import re
from dataclasses import replace

import numpy as np
import pytest
from helpers_control import (
    FLOW,
    SCHEDULE,
    Rotor,
    experiment,
    plain_flow,
    random_alarms,
    rotors,
    run,
)
from hypothesis import given, settings
from hypothesis import strategies as st

from burstcast.control import loop as loop_module
from burstcast.control.experiment import controlled_series, noise_of_flows
from burstcast.control.records import FlowSample, Span, record_flows, score_flows
from burstcast.control.strategies.prediction_triggered import PredictionTriggered
from burstcast.control.strategies.probability_triggered import ProbabilityTriggered
from burstcast.control.strategies.receding_horizon import RecedingHorizon
from burstcast.control.timing import Schedule
from burstcast.data import dataset
from burstcast.systems.forced import ForcedSystem

WINDOWED = PredictionTriggered(1.0, 1.0)
SAMPLED = RecedingHorizon(decision_interval_lt=0.25, horizon_lt=1.0)


@st.composite
def schedules(draw):
    return Schedule(
        washout=draw(st.integers(1, 4)),
        quiet_lt=draw(st.sampled_from([0.0, 0.5, 2.0])),
        span_lt=draw(st.sampled_from([1.0, 2.5, 4.5])),
        delay_lt=draw(st.sampled_from([0.0, 0.25, 0.6, 2.0])),
        actuation_start_lt=draw(st.sampled_from([-1.0, -0.5, 0.0])),
        actuation_duration_lt=draw(st.sampled_from([0.5, 1.5, 4.0])),
        steps_per_lyapunov_time=draw(st.integers(4, 9)),
        sampling_stride=draw(st.integers(1, 3)),
        time_step=0.3,
    )


STRATEGIES = st.one_of(
    st.builds(PredictionTriggered, st.sampled_from([1.0, 1.5, 2.0]), st.just(1.0)),
    st.builds(RecedingHorizon, st.sampled_from([0.25, 0.5, 1.0]), st.just(1.0)),
    st.builds(
        ProbabilityTriggered, st.sampled_from([0.25, 0.5]), st.just(0.5), st.sampled_from([0.5, 2])
    ),
)


@settings(max_examples=60, deadline=None)
@given(
    *(schedules(), STRATEGIES, st.sampled_from([0.02, 0.9]), st.booleans()),
    *(st.sampled_from([1, 4, 100]), st.integers(0, 2**32 - 1)),
)
def test_simulate_is_a_plain_loop_bit_for_bit(
    schedule, strategy, frequency, quiet_starts, batch, seed
):
    """Whatever the batches are."""
    generator, timing = np.random.default_rng(seed), strategy.timing(schedule)
    experiment = rotors(generator.normal(size=(2, 6)), schedule, frequency)
    experiment = replace(experiment, quiet_starts=quiet_starts)
    policy = random_alarms(0.4, 6, timing, seed)
    noise = generator.normal(size=(6, timing.length + 3, 2))
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(loop_module, "FLOWS_PER_BATCH", batch)
        flows = strategy.simulate(experiment, policy, noise=noise, keep_states=True)
    assert flows.left_out == 6 - len(flows)
    first, last = (step * schedule.sampling_stride for step in (timing.counted_from, timing.length))
    for row in range(6):
        plain = plain_flow(
            experiment, row, timing, lambda number, _, row=row: int(policy.table[row, number])
        )
        quiet = plain.uncontrolled[: timing.counted_from + 1, 0].max() < 0.9
        assert (quiet or not quiet_starts) == (row in flows.rows)
        if row not in flows.rows:
            continue
        flow = int(np.flatnonzero(flows.rows == row)[0])
        np.testing.assert_array_equal(flows.uncontrolled_states[flow], plain.uncontrolled)
        np.testing.assert_array_equal(flows.uncontrolled[flow], plain.uncontrolled[:, 0])
        np.testing.assert_array_equal(flows.controlled_states[flow], plain.controlled)
        np.testing.assert_array_equal(flows.controlled[flow], plain.controlled[:, 0])
        counted = plain.acting[first : last - schedule.sampling_stride]
        assert flows.actuated_integration_steps[flow] == sum(counted)
        rises = [now and not before for before, now in zip([0, *counted], counted, strict=False)]
        assert flows.switchings[flow] == sum(rises)
        into_step = plain.acting[schedule.sampling_stride - 1 :: schedule.sampling_stride]
        assert flows.actuated[flow, 1:].tolist() == into_step[: timing.length - 1]
        mine = flows.looks.flow == flow
        assert flows.looks.step[mine].tolist() == [look.step for look in plain.looks]
        assert flows.looks.alarm[mine].tolist() == [look.alarm for look in plain.looks]
        # what the policy was given: states that lay behind it and their noise, the actuation under
        # which the flow came from one to the next, and the one on its way
        pending = timing.effect[0] // schedule.sampling_stride
        for number, look in enumerate(plain.looks):
            if look.step < timing.length:
                behind = slice(look.step + 1 - schedule.washout, look.step + 1)
                observed = plain.controlled[behind] + noise[row, behind]
                np.testing.assert_array_equal(policy.seen[row, number], observed)
                acting = into_step[behind.start : look.step + pending]
                assert policy.acting[row, number] == acting


# -- whatever the strategy -------------------------------------------------------------------------

BOTH = pytest.mark.parametrize("strategy", [WINDOWED, SAMPLED], ids=["windowed", "sampled"])


@BOTH
def test_simulate_may_be_left_with_no_flow(strategy):
    given, timing = experiment(2, threshold=0.0), strategy.timing(SCHEDULE)
    for washouts, left_out in ((given.washouts, 2), (given.washouts[:0], 0)):
        never = random_alarms(0.0, 2, timing)
        flows = strategy.simulate(
            replace(given, washouts=washouts), never, noise=None, keep_states=True, costs=True
        )
        assert (len(flows), flows.left_out) == (0, left_out)
        assert flows.controlled.shape == (0, timing.length)


def test_wrong_shapes_are_refused():
    given, timing = experiment(2), SAMPLED.timing(SCHEDULE)
    with pytest.raises(ValueError, match="washouts must have the shape"):
        run(SAMPLED, replace(given, washouts=given.washouts[:, 1:]))
    with pytest.raises(ValueError, match="noise must have the shape"):
        run(SAMPLED, given, noise=np.zeros((2, timing.length - 1, 9)))
    with pytest.raises(ValueError, match="another dimension"):
        run(SAMPLED, replace(given, actuated_system=Rotor(1.0)))


@BOTH
def test_a_flow_that_actuation_takes_out_of_the_range_of_numbers(strategy):
    """It is counted and the others go on; where all are lost, the message says what to change."""
    violent = experiment(3, threshold=10.0, actuated_system=ForcedSystem(FLOW, [1e200] * 9))
    timing = strategy.timing(SCHEDULE)
    policy = random_alarms(0.0, 3, timing)
    policy.table[1, 1] = True
    flows = strategy.simulate(violent, policy, noise=None, keep_states=True, costs=True)
    free = strategy.simulate(
        violent, random_alarms(0.0, 3, timing), noise=None, keep_states=True, costs=True
    )
    others = [0, 2]
    np.testing.assert_array_equal(flows.controlled[others], free.controlled[others])
    np.testing.assert_array_equal(
        flows.controlled_energy.input[others], free.controlled_energy.input[others]
    )
    assert flows.escape_step[others].tolist() == [-1, -1]
    escape = int(flows.escape_step[1])
    acted = np.flatnonzero(flows.actuated[1])
    assert escape == acted[0]
    assert np.isnan(flows.controlled_states[1, escape:]).all()
    np.testing.assert_array_equal(
        flows.controlled_states[1, :escape], free.controlled_states[1, :escape]
    )
    records = record_flows(flows, None)
    assert records.escapes.tolist() == [False, True, False]
    assert records.kept.tolist() == [True, False, True]
    assert records.escape_step[1] == escape - timing.first_look
    sample = FlowSample(records, Span.of(timing), {"effort": flows.cost.effort})
    scores = score_flows(sample, 10, np.random.default_rng(0))
    assert scores["escaped_fraction"].value == pytest.approx(1 / 3)
    assert scores["effort"].value == 0.0
    policy.table[:, 1] = True
    with pytest.raises(FloatingPointError) as caught:
        strategy.simulate(violent, policy, noise=None)
    assert re.match(
        r"all 3 controlled flows left the range of floating-point numbers under actuation, flow \d "
        r"at most (1|5|20) time units after it was first actuated, .* have no bounded solution: "
        "take a weaker actuation .*; or they need a shorter ensemble.time_step than 0.25",
        str(caught.value),
    ), caught.value


def test_a_flow_that_is_lost_without_actuation_is_an_error():
    """Its own equations are at fault: no flow that counts is like the others."""
    lost = experiment(2, threshold=10.0, system=ForcedSystem(FLOW, [1e200] * 9))
    with pytest.raises(FloatingPointError, match=r"trajectory \d left the range"):
        SAMPLED.simulate(lost, random_alarms(0.0, 2, SAMPLED.timing(SCHEDULE)), noise=None)


# -- the experiment --------------------------------------------------------------------------------


def test_the_flows_begin_with_the_series_after_the_training():
    assert controlled_series(kept=40, training=10, wanted=20) == range(10, 30)
    assert controlled_series(kept=25, training=10, wanted=20) == range(10, 25)


def test_the_noise_of_a_flow_is_that_of_its_series_and_not_the_one_of_the_data():
    scales = dataset.Scales(np.array([1.0, 10.0]), np.ones(2))
    noise = noise_of_flows(range(10, 14), 6, 0.01, scales, 2022, "Re400")
    assert noise.shape == (4, 6, 2)
    alone = noise_of_flows(range(12, 13), 6, 0.01, scales, 2022, "Re400")
    np.testing.assert_array_equal(alone[0], noise[2])
    observed = dataset.observed_series(np.zeros((4, 6, 2)), 10, 0.01, scales, 2022, "Re400")
    assert (noise != observed).all()
