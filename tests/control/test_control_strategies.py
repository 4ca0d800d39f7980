"""Strategies by name, and that each does with flows what its own pieces do."""

from dataclasses import dataclass, replace

import numpy as np
import pytest
from helpers_control import Actuation, run_windowed, turbulent_washouts
from test_control_decisions import FLOW, RAISED

from burstcast import random_streams
from burstcast.arrays import BoolArray, FloatArray, IntArray
from burstcast.control.actuation import ActuationValues, actuation_interval
from burstcast.control.controllers.registry import controlling_monitor
from burstcast.control.experiment import ControlExperiment, Schedule
from burstcast.control.monitors.base import Monitor
from burstcast.control.monitors.forecast import ForecastMonitor
from burstcast.control.monitors.horizon import HorizonMonitor
from burstcast.control.monitors.observed import ObservedMonitor
from burstcast.control.monitors.vote import VoteMonitor
from burstcast.control.strategies.prediction_triggered import PredictionTriggered
from burstcast.control.strategies.receding_horizon import RecedingHorizon
from burstcast.control.strategies.registry import available_strategies, make_strategy
from burstcast.control.timing import Timing
from burstcast.forecasters.equations import EquationsFromTruth
from burstcast.systems.parameters import SystemParameters
from helpers_forecasters import MadeUpForecaster

SCHEDULE = Schedule(
    washout=5,
    quiet_lt=2.0,
    span_lt=3.0,
    delay_lt=0.0,
    actuation_start_lt=-1.0,
    actuation_duration_lt=1.5,
    steps_per_lyapunov_time=20,
    sampling_stride=4,
    time_step=0.25,
)


def experiment(flows: int = 6, schedule: Schedule = SCHEDULE) -> ControlExperiment:
    timing = make_strategy("reactive", {"level": 1.0, "decision_interval_lt": 1.0}).timing(schedule)
    return ControlExperiment(
        system=FLOW,
        actuated_system=RAISED,
        threshold=0.07,
        series=range(10, 10 + flows),
        washouts=turbulent_washouts(FLOW, flows, timing),
        quiet_starts=True,
        schedule=schedule,
        root_seed=7,
        case="Re400",
        values=ActuationValues((FLOW.reynolds,), (RAISED.reynolds,)),
    )


EQUATIONS = EquationsFromTruth(FLOW, 0.25, 4, SystemParameters.of(FLOW, ["reynolds"]))
SETTINGS = {
    "planned": {"horizon_lt": 3.0, "decision_interval_lt": 0.25},
    "prediction_triggered": {"prediction_time_lt": 1.0, "window_lt": 1.0},
    "probability_triggered": {"probability": 0.3, "hold_lt": 1.0, "decision_interval_lt": 0.25},
    "receding_horizon": {"horizon_lt": 2.0, "decision_interval_lt": 0.25},
    "reactive": {"level": 0.05, "decision_interval_lt": 0.25},
    "random_decisions": {"probability": 0.3, "decision_interval_lt": 0.25},
}


def test_strategies_are_found_by_name() -> None:
    assert available_strategies() == sorted(SETTINGS)
    for name, settings in SETTINGS.items():
        assert vars(make_strategy(name, settings)).items() >= settings.items()


@pytest.mark.parametrize(
    ("name", "settings", "message"),
    [
        ("receding_horizn", {}, "did you mean 'receding_horizon'"),
        ("reactive", {"levl": 0.1, "decision_interval_lt": 1}, "no setting 'levl'.*'level'"),
        ("reactive", {"level": 0.1}, "needs the setting 'decision_interval_lt'"),
        ("reactive", {"level": np.nan, "decision_interval_lt": 1}, "must be a finite number"),
        ("reactive", {"level": 1, "decision_interval_lt": 1, "watch": 2.0}, "must be a text"),
        ("receding_horizon", {"horizon_lt": 1, "decision_interval_lt": 1, "aware": 1}, "true or"),
        ("planned", {"horizon_lt": 1, "decision_interval_lt": 1, "starts_lt": 0.0}, "a list"),
        (
            "planned",
            {"horizon_lt": 1, "decision_interval_lt": 1, "starts_lt": [0.0, np.inf]},
            "an entry of setting 'starts_lt' .* finite number",
        ),
    ],
)
def test_a_strategy_that_cannot_be_made(name: str, settings: dict, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        make_strategy(name, settings)


@pytest.mark.parametrize(
    ("name", "changes", "of_schedule", "message"),
    [
        ("receding_horizon", {"horizon_lt": 0.01}, {}, "horizon of 0.01 .* lasts no step"),
        ("receding_horizon", {"decision_interval_lt": 0.01}, {}, "must last a step"),
        ("receding_horizon", {"aware": True}, {"delay_lt": 2.0}, "not reach beyond the delay of 2"),
        ("planned", {"horizon_lt": 1.0}, {"delay_lt": 1.0}, "does not reach beyond the delay"),
        ("planned", {}, {"delay_lt": 1.0}, "longer than the horizon: 3.0 .* a delay of 1.0"),
        ("planned", {"starts_lt": [0.5]}, {}, "no plan acts at once"),
        ("planned", {"starts_lt": [0.0, 3.0]}, {}, "longer than the horizon"),
        ("planned", {"durations_lt": []}, {}, "lasts no step"),
        ("planned", {"durations_lt": [0.01]}, {}, "lasts no step"),
        ("prediction_triggered", {"prediction_time_lt": 0.5}, {}, "before the alarm"),
        ("prediction_triggered", {"window_lt": 0.0}, {}, "must last a step"),
        ("reactive", {}, {"delay_lt": -1.0}, "must not be negative"),
    ],
)
def test_settings_are_checked_before_there_are_flows(
    name: str, changes: dict, of_schedule: dict, message: str
) -> None:
    strategy = make_strategy(name, {**SETTINGS[name], **changes})
    with pytest.raises(ValueError, match=message):
        strategy.check(replace(SCHEDULE, **of_schedule))
    make_strategy(name, SETTINGS[name]).check(SCHEDULE)


def test_the_papers_strategy_is_the_papers() -> None:
    """The same bits as the pieces of the paper's control, put together by hand."""
    given = experiment()
    timing = Timing(
        prediction_time_lt=1.0,
        window_lt=1.0,
        span_lt=3.0,
        washout=5,
        steps_per_lyapunov_time=20,
        sampling_stride=4,
        time_step=0.25,
    )
    by_hand = run_windowed(
        FLOW,
        given.washouts,
        ForecastMonitor(EQUATIONS, FLOW.observable, timing, 0.07),
        Actuation(RAISED, -1.0, 1.5),
        timing,
        0.07,
    )
    strategy = PredictionTriggered(1.0, 1.0)
    followed = strategy.simulate(given, strategy.monitor(given, [EQUATIONS]), noise=None)
    assert by_hand.decisions.alarm.any()
    # quiet for as long as the first window at least
    assert followed.timing.counted_from == timing.counted_from
    np.testing.assert_array_equal(followed.controlled, by_hand.controlled)
    np.testing.assert_array_equal(followed.decisions.alarm, by_hand.decisions.alarm)
    late = strategy.actuation_interval(replace(SCHEDULE, delay_lt=0.5))
    assert late == actuation_interval(timing, -0.5, 1.5) == (40, 160)


class NoProbability:
    """A classifier that expects no event."""

    def probabilities(self, washouts: FloatArray) -> FloatArray:
        return np.zeros((len(washouts), 1))


def test_quiet_flows_of_all_strategies_are_the_same() -> None:
    schedule = replace(SCHEDULE, quiet_lt=3.0)
    given = experiment(8, schedule)
    rows, uncontrolled = [], []
    for name, settings in SETTINGS.items():
        strategy = make_strategy(name, settings)
        asked = NoProbability() if strategy.by_probability else EQUATIONS
        flows = strategy.simulate(given, strategy.monitor(given, [asked]), noise=None)
        assert flows.timing.counted_from == 4 + 60
        rows.append(flows.rows.tolist())
        uncontrolled.append(flows.uncontrolled)
    assert 0 < len(rows[0]) < 8
    assert rows.count(rows[0]) == len(SETTINGS)
    for other in uncontrolled[1:]:
        np.testing.assert_array_equal(other, uncontrolled[0])


def test_what_a_forecaster_sees_under_actuation_is_the_flow_as_it_was_observed() -> None:
    """The washout is the last observed states, those under actuation among them, as they are."""
    seen: list[FloatArray] = []

    @dataclass(frozen=True)
    class Recorder(MadeUpForecaster):
        def start(self, washout: FloatArray) -> FloatArray:
            seen.append(washout.copy())
            return washout[-1]

        def advance(self, memory: FloatArray, steps: int) -> tuple[FloatArray, FloatArray]:
            # an event ahead wherever the last state is energetic
            return np.repeat(memory[np.newaxis], steps, axis=0), memory

    given = replace(experiment(4), threshold=0.05, quiet_starts=False)
    noise = np.random.default_rng(0).normal(scale=1e-4, size=(4, 200, 9))
    strategy = RecedingHorizon(decision_interval_lt=0.25, horizon_lt=1.0)
    flows = strategy.simulate(
        given, strategy.monitor(given, [Recorder()]), noise=noise, keep_states=True
    )
    assert flows.controlled_states is not None
    assert flows.decisions.washout_actuated.any()
    timing = flows.timing
    assert len(seen) == timing.most_forecasts
    for number, washout in enumerate(seen):
        now = timing.first_forecast + number * timing.interval
        span = slice(now - 4, now + 1)
        observed = flows.controlled_states[:, span] + noise[:, span]
        np.testing.assert_array_equal(washout, observed.transpose(1, 2, 0))


@dataclass(frozen=True)
class Script(MadeUpForecaster):
    """Forecasts a script, whatever it has seen."""

    script: FloatArray  # (steps, batch)

    def start(self, washout: FloatArray) -> FloatArray:
        return washout[-1]

    def advance(self, memory: FloatArray, steps: int) -> tuple[FloatArray, FloatArray]:
        return self.script[:steps, np.newaxis], memory


def test_half_of_a_committee_decides_where_nothing_is_said() -> None:
    for name in ("prediction_triggered", "receding_horizon"):
        assert make_strategy(name, SETTINGS[name]).vote_share == 0.5  # type: ignore[attr-defined]


def test_a_delay_puts_off_the_actuation_of_an_alarm() -> None:
    strategy = PredictionTriggered(2.0, 1.0)
    first, end = strategy.actuation_interval(SCHEDULE)
    late = strategy.actuation_interval(replace(SCHEDULE, delay_lt=0.5))
    assert late == (first + 40, end + 40)  # half a Lyapunov time of 20 samples, 4 steps each


def asked(monitor: Monitor, flows: int) -> list[bool]:
    rows = np.arange(flows)
    return monitor.alarms(rows, np.zeros_like(rows), np.zeros((1, 1, flows))).tolist()


def test_a_horizon_has_an_event_wherever_the_forecast_reaches_the_level() -> None:
    forecasts = np.array(
        [
            [0, 0, 0, 1],  # at the last step
            [1, 0, 0, 0],  # at the first one: under way
            [0, 0, 0.999, 0],  # below
            [0, 1, np.nan, np.nan],  # before it diverges
            [0, 0, np.inf, np.nan],  # diverges
            [0, 0, 0, 0],
        ]
    )
    script = Script(forecasts.T)
    monitor = HorizonMonitor(script, lambda states: states[0], 4, 1.0)
    assert asked(monitor, 6) == [True, True, False, True, False, False]
    assert asked(replace(monitor, horizon=3), 6) == [False, True, False, True, False, False]
    assert asked(replace(monitor, level=0.9), 6) == [True, True, True, True, False, False]
    with pytest.raises(ValueError, match="a step ahead"):
        replace(monitor, horizon=0)


def test_a_margin_lowers_the_level() -> None:
    given = experiment()
    strategy = RecedingHorizon(decision_interval_lt=0.25, horizon_lt=2.0, margin=0.02)
    monitor = strategy.monitor(given, [EQUATIONS])
    assert isinstance(monitor, HorizonMonitor)
    assert (monitor.horizon, monitor.level) == (40, pytest.approx(0.05))


def test_reactive_control_looks_at_the_last_observed_state() -> None:
    monitor = ObservedMonitor(lambda states: states[0], 0.5)
    washout = np.array([[[0.9, 0.1, 0.1, 0.9]], [[0.1, 0.5, 0.6, np.nan]]])  # (steps, 1, flows)
    rows = np.arange(4)
    assert monitor.alarms(rows, rows, washout).tolist() == [False, True, True, False]


@dataclass(frozen=True)
class Says(Monitor):
    what: BoolArray

    def alarms(
        self,
        rows: IntArray,
        forecast_number: IntArray,
        washout: FloatArray,
        acting: BoolArray | None = None,
    ) -> BoolArray:
        return self.what[rows]


def test_a_vote_needs_its_share() -> None:
    # ten members: flow i has the alarms of i members
    members = [Says(np.arange(11) > number) for number in range(10)]
    for votes in range(1, 11):
        monitor = VoteMonitor(members, votes / 10)
        assert asked(monitor, 11) == [count >= votes for count in range(11)]
    assert asked(VoteMonitor(members, 0.01), 11) == [False] + [True] * 10
    for share in (0.0, 1.1, np.nan):
        with pytest.raises(ValueError, match="share of a vote"):
            VoteMonitor(members, share)
    with pytest.raises(ValueError, match="one member"):
        VoteMonitor([], 0.5)


def test_several_forecasters_vote() -> None:
    given = experiment(2)
    quiet, event = Script(np.zeros((40, 2))), Script(np.ones((40, 2)))
    given = replace(given, system=replace(FLOW))
    for strategy in (
        RecedingHorizon(decision_interval_lt=0.25, horizon_lt=2.0, vote_share=0.5),
        PredictionTriggered(1.0, 1.0, vote_share=0.5),
    ):
        monitor = strategy.monitor(given, [quiet, event, event])
        assert isinstance(monitor, VoteMonitor)
        assert (len(monitor.members), monitor.share) == (3, 0.5)


def test_random_alarms_have_a_stream_for_each_flow() -> None:
    given, strategy = experiment(4), PredictionTriggered(1.0, 1.0)
    monitor = controlling_monitor("random", strategy, given, [], alarm_rate=0.4, seed=3)
    looks = strategy.timing(given.schedule).most_forecasts
    for row in range(4):
        stream = random_streams.stream(7, "random alarms", "Re400", 3, 10 + row)
        for number, value in enumerate(stream.random(looks)):
            said = monitor.alarms(np.array([row]), np.array([number]), np.zeros((1, 1, 1)))
            assert said.tolist() == [value < 0.4]


def test_random_decisions_have_a_stream_for_each_flow() -> None:
    given = experiment(6)
    strategy = make_strategy("random_decisions", SETTINGS["random_decisions"])
    flows = strategy.simulate(given, strategy.monitor(given, []), noise=None)
    for flow, row in enumerate(flows.rows):
        stream = random_streams.stream(7, "random decisions", "Re400", 10 + int(row))
        expected = stream.random(flows.timing.most_forecasts) < 0.3
        assert flows.decisions.on[flow].tolist() == expected.tolist()
