from dataclasses import replace

import numpy as np
import pytest
from helpers_control import (
    PAPER,
    Actuation,
    Rotor,
    TableMonitor,
    plain_flow,
    run_windowed,
    table_monitor,
    turbulent_washouts,
    washouts_of,
)
from hypothesis import given, settings
from hypothesis import strategies as st

from burstcast.control.actuation import actuated_system
from burstcast.control.monitors.forecast import ForecastMonitor
from burstcast.control.timing import Timing
from burstcast.forecasters.equations import EquationsFromTruth
from burstcast.systems.integration import integrate
from burstcast.systems.mfe import MoehlisFaisstEckhardt

FLOW = MoehlisFaisstEckhardt(reynolds=400.0)
RAISED = Actuation(actuated_system(FLOW, {"reynolds": 2000.0}), -1.0, 1.5)
SHORT = replace(PAPER, span_lt=3.0, washout=5, steps_per_lyapunov_time=20)


def never(flows: int, timing: Timing) -> TableMonitor:
    return table_monitor(np.zeros((flows, timing.most_forecasts), dtype=bool))


@st.composite
def cases(draw: st.DrawFn) -> tuple[Timing, Actuation, tuple[int, int], int]:
    stride = draw(st.integers(1, 3))
    steps_per_lyapunov_time = draw(st.integers(4, 9))
    prediction_time_lt = draw(st.sampled_from([1.0, 1.5, 2.0]))
    start_lt = draw(st.sampled_from([-1.0, -0.5, 0.0]))
    duration_lt = draw(st.sampled_from([0.5, 1.5, 4.0]))
    timing = Timing(
        prediction_time_lt=prediction_time_lt,
        window_lt=1.0,
        span_lt=draw(st.sampled_from([3.0, 4.5])),
        washout=draw(st.integers(1, 4)),
        steps_per_lyapunov_time=steps_per_lyapunov_time,
        sampling_stride=stride,
        time_step=0.3,
    )
    per_lyapunov_time = stride * steps_per_lyapunov_time
    interval = (
        int((prediction_time_lt + start_lt) * per_lyapunov_time),
        int(duration_lt * per_lyapunov_time),
    )
    actuation = Actuation(
        Rotor(draw(st.sampled_from([0.02, 0.9]))), start_lt=start_lt, duration_lt=duration_lt
    )
    return timing, actuation, interval, draw(st.integers(0, 2**32 - 1))


@settings(max_examples=60, deadline=None)
@given(cases())
def test_flows_are_those_of_a_plain_loop_bit_for_bit(
    case: tuple[Timing, Actuation, tuple[int, int], int],
) -> None:
    timing, actuation, (start, steps), seed = case
    generator = np.random.default_rng(seed)
    system = Rotor(0.3)
    # what can be about 1, so that some crests are events; threshold 0.9
    washouts = washouts_of(system, generator.normal(size=(2, 6)), timing)
    table = generator.random((6, timing.most_forecasts)) < 0.4
    monitor = table_monitor(table)
    flows = run_windowed(
        system, washouts, monitor, actuation, timing, threshold=0.9, keep_states=True
    )
    assert flows.controlled_states is not None
    assert flows.left_out == 6 - len(flows)
    for row in range(6):
        plain = plain_flow(
            system, washouts[row], list(table[row]), actuation, timing, 0.9, start, steps
        )
        assert plain.uncontrolled.shape == (timing.length, 2)
        quiet = plain.uncontrolled[: timing.counted_from + 1, 0].max() < 0.9
        assert quiet == (row in flows.rows)
        if not quiet:
            continue
        flow = int(np.flatnonzero(flows.rows == row)[0])
        np.testing.assert_array_equal(flows.uncontrolled[flow], plain.uncontrolled[:, 0])
        np.testing.assert_array_equal(flows.controlled_states[flow], plain.controlled)
        np.testing.assert_array_equal(flows.controlled[flow], plain.controlled[:, 0])
        stride = timing.sampling_stride
        counted = plain.acting[timing.counted_from * stride : timing.counted_until * stride]
        assert flows.actuated_integration_steps[flow] == counted.sum()
        into_step = plain.acting[stride - 1 :: stride][: timing.length - 1]
        np.testing.assert_array_equal(flows.actuated[flow, 1:], into_step)

        mine = flows.decisions.flow == flow
        assert flows.decisions.step[mine].tolist() == [f.step for f in plain.forecasts]
        for name in ("alarm", "would_cross", "would_be_under_way", "reached"):
            expected = [getattr(forecast, name) for forecast in plain.forecasts]
            assert getattr(flows.decisions, name)[mine].tolist() == expected, name
        # what the monitor saw is what lay behind it
        for number, forecast in enumerate(plain.forecasts):
            seen = monitor.seen[row, number]
            last = plain.controlled[: forecast.step + 1]
            if forecast.step < timing.length:
                np.testing.assert_array_equal(seen, last[-timing.washout :])


def test_actuation_lasts_from_the_alarm_for_366_integration_steps() -> None:
    timing = replace(PAPER, span_lt=2.0)
    monitor = never(1, timing)
    monitor.table[0, 0] = True
    washouts = turbulent_washouts(FLOW, 1, timing)
    flows = run_windowed(FLOW, washouts, monitor, RAISED, timing, np.inf, keep_states=True)
    assert flows.controlled_states is not None
    raised = MoehlisFaisstEckhardt(reynolds=2000.0)
    under_control = integrate(raised, washouts[:, -1].T, 0.25, 366, stride=1)
    after = integrate(FLOW, under_control[-1], 0.25, (timing.length - 30) * 4 - 366, stride=1)
    truth = np.concatenate([under_control, after[1:]])[::4, :, 0]
    np.testing.assert_array_equal(flows.controlled_states[0, 29:], truth)
    # the next forecast is made at the end of the alarm's window
    assert flows.decisions.step[:3].tolist() == [29, 29 + 122, 29 + 183]
    assert flows.actuated.sum() == 91


def test_a_perfect_forecaster_raises_no_false_alarm() -> None:
    timing = replace(PAPER, span_lt=4.0, washout=1)
    washouts = turbulent_washouts(FLOW, 40, timing)
    monitor = ForecastMonitor(
        EquationsFromTruth(FLOW, timing.time_step, timing.sampling_stride),
        FLOW.observable,
        timing,
        threshold=0.1,
    )
    flows = run_windowed(FLOW, washouts, monitor, RAISED, timing, 0.1)
    assert flows.decisions.alarm.sum() > 5
    np.testing.assert_array_equal(flows.decisions.alarm, flows.decisions.would_cross)


def test_an_event_that_lasts_into_the_window_counts_as_reached() -> None:
    timing = Timing(
        prediction_time_lt=1.0,
        window_lt=1.0,
        span_lt=8.0,
        washout=1,
        steps_per_lyapunov_time=5,
        sampling_stride=1,
        time_step=0.3,
    )
    system = Rotor(0.3)
    crest_at_step_22 = np.array([[[np.cos(0.09 * 22), -np.sin(0.09 * 22)]]])
    monitor = never(1, timing)
    monitor.table[0, 5] = True  # at step 25, after the crest: the window is from 30 to 35
    actuation = Actuation(system, -1.0, 1.0)

    def alarm(threshold: float) -> tuple[bool, bool, bool]:
        flows = run_windowed(system, crest_at_step_22, monitor, actuation, timing, threshold)
        forecasts = flows.decisions
        raised = forecasts.step == 25
        assert forecasts.alarm.tolist() == raised.tolist()
        return (
            bool(forecasts.would_cross[raised][0]),
            bool(forecasts.would_be_under_way[raised][0]),
            bool(forecasts.reached[raised][0]),
        )

    heights = run_windowed(system, crest_at_step_22, monitor, actuation, timing, 2.0).controlled[0]
    assert heights.argmax() == 22
    assert alarm(heights[30]) == (False, True, True)
    assert alarm(np.nextafter(heights[30], 2.0)) == (False, False, False)


@pytest.mark.parametrize(
    ("crest", "reached"),
    [
        (19, False),  # crosses at step 17, which actuation from step 17 on could not prevent
        (20, True),  # crosses at step 18
        (22, True),  # is over at step 25, where the window begins
        (23, True),  # lasts into the window
    ],
)
def test_an_event_between_actuation_and_window_counts_as_reached(crest: int, reached: bool) -> None:
    timing = Timing(
        prediction_time_lt=2.0,
        window_lt=1.0,
        span_lt=8.0,
        washout=1,
        steps_per_lyapunov_time=5,
        sampling_stride=1,
        time_step=0.3,
    )
    system = Rotor(0.3)
    start = np.array([[[np.cos(0.09 * crest), -np.sin(0.09 * crest)]]])
    monitor = never(1, timing)
    monitor.table[0, 3] = True  # at step 15
    flows = run_windowed(system, start, monitor, Actuation(system, -1.5, 1.0), timing, 0.98)
    above = np.flatnonzero(flows.controlled[0, :30] >= 0.98)
    assert (above[0], above[-1]) == (crest - 2, crest + 2)
    assert flows.decisions.reached[flows.decisions.step == 15].tolist() == [reached]
