"""Strategies by name, their settings, what their policies decide at a look, and votes."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from helpers_control import EQUATIONS, PAPER, SCHEDULE, Script, asked, experiment, look_at
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as npst

from burstcast.base import random_streams
from burstcast.control.controllers import controlling_policy, votes
from burstcast.control.policy import FALLBACKS, WITHOUT_FORECAST, Members, at_random, by_vote
from burstcast.control.setting_names import as_columns, options_in
from burstcast.control.strategies.prediction_triggered import PredictionTriggered
from burstcast.control.strategies.reactive import Reactive
from burstcast.control.strategies.receding_horizon import RecedingHorizon
from burstcast.control.strategies.registry import (
    available_strategies,
    make_strategy,
    strategy_class,
)
from burstcast.forecasters._limits import TrainingLimits
from burstcast.systems.measured import MeasuredSeries

SETTINGS = {
    "planned": {"horizon_lt": 3.0, "decision_interval_lt": 0.25},
    "prediction_triggered": {"prediction_time_lt": 1.0, "window_lt": 1.0},
    "probability_triggered": {"probability": 0.3, "hold_lt": 1.0, "decision_interval_lt": 0.25},
    "receding_horizon": {"horizon_lt": 2.0, "decision_interval_lt": 0.25},
    "reactive": {"level": 0.05, "decision_interval_lt": 0.25},
    "uncontrolled": {"decision_interval_lt": 0.5},
}


def test_strategies_are_found_by_name():
    assert available_strategies() == sorted(SETTINGS)
    for name, settings in SETTINGS.items():
        strategy = make_strategy(name, settings)
        assert vars(strategy).items() >= settings.items()
        # half of a committee decides
        assert vars(strategy).get("vote_share") == (0.5 if votes(type(strategy)) else None)
    voting = [name for name in SETTINGS if votes(strategy_class(name))]
    assert voting == ["planned", *VOTING[::-1]]


@pytest.mark.parametrize(
    ("name", "settings", "message"),
    [
        ("receding_horizn", {}, "did you mean 'receding_horizon'"),
        ("reactive", {"levl": 0.1, "decision_interval_lt": 1}, "no setting 'levl'.*'level'"),
        ("reactive", {"level": 1, "decision_interval_lt": 1, "watch": 2.0}, "must be a text"),
    ],
)
def test_a_strategy_that_cannot_be_made(name, settings, message):
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
        ("planned", {"durations_lt": [0.01, 1.0]}, {}, "lasts no step"),
        ("prediction_triggered", {"prediction_time_lt": 0.5}, {}, "before the alarm"),
        *(
            ("probability_triggered", changes, {}, message)
            for changes, message in (
                ({"probability": 1.0}, "probability must lie between 0 and 1, not be 1"),
                ({"hold_lt": 0.1}, "hold_lt must be at least decision_interval_lt, 0.25, not 0.1"),
                ({"windows": 1.5}, "windows must be a whole number from 1 on, not 1.5"),
            )
        ),
        ("prediction_triggered", {"window_lt": 0.0}, {}, "must last a step"),
    ],
)
def test_settings_are_checked_before_there_are_flows(name, changes, of_schedule, message):
    strategy = make_strategy(name, {**SETTINGS[name], **changes})
    with pytest.raises(ValueError, match=message):
        strategy.check(replace(SCHEDULE, **of_schedule))
    make_strategy(name, SETTINGS[name]).check(SCHEDULE)


# -- timing ----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "change", [{"span_lt": 1 / 61}, {"washout": 1}, {"sampling_stride": 1}, {"quiet_lt": 0.0}]
)
def test_one_step_is_enough(change):
    timing = make_strategy("reactive", SETTINGS["reactive"]).timing(replace(PAPER, **change))
    assert timing.span >= 1


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"span_lt": 0.0}, "span of control must last a step"),
        ({"washout": 0}, "at least one input"),
        ({"sampling_stride": 0}, "stride must be at least one step"),
        ({"quiet_lt": -0.1}, "begin after the first"),
        ({"delay_lt": -0.1}, "delay must not be negative"),
    ],
)
def test_durations_that_mean_nothing_are_refused(change, message):
    with pytest.raises(ValueError, match=message):
        replace(PAPER, **change)


def test_decisions_at_equal_intervals_take_effect_a_delay_later():
    strategy = make_strategy("probability_triggered", SETTINGS["probability_triggered"])
    timing = strategy.timing(replace(SCHEDULE, delay_lt=0.35, quiet_lt=0.0))
    assert (timing.pauses, timing.effect) == ((5, 5), (7 * 4, (7 + 20) * 4))
    # flows count from the first effect, and are looked at as long as that matters
    assert (timing.first_look, timing.counted_from, timing.counted_until) == (4, 11, 71)
    assert (timing.last_look, timing.most_looks) == (63, 12)


# -- policies --------------------------------------------------------------------------------------

VOTING = ("receding_horizon", "prediction_triggered")
EXPERIMENT = experiment(schedule=replace(SCHEDULE, steps_per_lyapunov_time=3))
PLANE = MeasuredSeries(["height"], "height")


def decisions(policy, washout):
    return np.asarray(policy(look_at(washout))).tolist()


def heights(given, **changes):
    """An experiment that observes one number."""
    return replace(given, sensor=SimpleNamespace(space=PLANE), **changes)


def holds_event(name, observable, threshold, per_lt=20):
    """Whether one valid forecast, step by step, holds an event, for strategies of SETTINGS."""
    if name == "receding_horizon":  # two Lyapunov times
        return any(value >= threshold for value in observable[: 2 * per_lt])
    # from the end of the first one, below, up to that of the second
    window = observable[per_lt - 1 : 2 * per_lt]
    # it crosses nothing once it is no longer finite
    crosses = window[0] < threshold and any(value >= threshold for value in window)
    return bool(np.isfinite(window).all() and crosses)


@given(
    npst.arrays(np.float64, (6, 5), elements=st.sampled_from([0.0, 0.8, 0.9, 0.999, 1.0, np.nan])),
    st.sampled_from([0.0, 0.1]),
)
def test_a_policy_acts_where_the_forecast_holds_an_event(forecasts, margin):
    """Forecasts of two Lyapunov times of three steps; an invalid one leaves it to the fallback.

    The fallback's level lies halfway from the mean of the observable, 0, to the threshold.
    """
    space = replace(heights(EXPERIMENT, threshold=1.0), system=PLANE, washouts=np.zeros((6, 2, 1)))
    horizon = RecedingHorizon(decision_interval_lt=1.0, horizon_lt=2.0, margin=margin)
    washout = np.zeros((2, 1, 5))
    washout[-1] = np.array([0.0, 0.49, 0.5, 0.51, 2.0])
    window = PredictionTriggered(1.0, 1.0)
    for strategy, level in ((horizon, 1.0 - margin), (window, 1.0)):
        name = VOTING[isinstance(strategy, PredictionTriggered)]
        valid = np.isfinite(forecasts).all(axis=0)
        for fallback in FALLBACKS:
            expected = []
            for forecast, now, sound in zip(forecasts.T, washout[-1, 0], valid, strict=True):
                acts = {"reactive": now >= 0.5, "off": False, "on": True}[fallback]
                held = holds_event(name, forecast, level, 3)
                expected.append(int(held) if sound else int(acts) + WITHOUT_FORECAST)
            policy = replace(strategy, fallback=fallback).policy(space, Script(forecasts))
            assert decisions(policy, washout) == expected


def test_a_forecast_far_outside_of_the_training_range_is_acted_on_by_nobody():
    """Finite, and above the threshold: on its way to infinity."""
    space = replace(heights(EXPERIMENT, threshold=1.0), system=PLANE, washouts=np.zeros((6, 2, 1)))
    grows = np.tile(np.array([0.1, 0.9, 1.2, 1.5, 9.0, 11.0])[:, np.newaxis], (1, 5))
    strategy = RecedingHorizon(decision_interval_lt=1.0, horizon_lt=2.0, fallback="off")
    washout = np.zeros((2, 1, 5))
    forecaster = Script(grows)
    assert decisions(strategy.policy(space, forecaster), washout) == [1] * 5
    limited = forecaster.within(TrainingLimits(np.array([0.0]), np.array([1.0])))
    assert decisions(strategy.policy(space, limited), washout) == [WITHOUT_FORECAST] * 5


@pytest.mark.parametrize("strategy", [RecedingHorizon(0.5, 1.0), PredictionTriggered(1.0, 1.0)])
def test_unknown_fallbacks_are_refused(strategy):
    with pytest.raises(ValueError, match="fallback must be one of reactive, off, on, not 'maybe'"):
        replace(strategy, fallback="maybe").check(SCHEDULE)


def test_voters_without_a_forecast_abstain_and_decide_only_where_most_have_none():
    invalid = {0: [], 1: [0], 2: [0, 1], 3: [0, 1, 2]}  # voters without a forecast, by flow

    def voter(number):
        def decide(look):
            return np.array(
                [
                    WITHOUT_FORECAST + 1 if number in invalid[flow] else number == 3
                    for flow in range(4)
                ],
                dtype=np.uint8,
            )

        return decide

    policy = by_vote([voter(number) for number in range(4)], 0.5)
    # of four: 1 votes for it; of three: 1; of two: 1, which is enough; of one: the fallback acts
    assert decisions(policy, np.zeros((1, 1, 4))) == [0, 0, 1, WITHOUT_FORECAST + 1]


def test_reactive_control_looks_at_the_last_observed_state():
    policy = Reactive(decision_interval_lt=0.25, level=0.5).policy(heights(experiment()), None)
    washout = np.array([[[0.9, 0.1, 0.1, 0.9]], [[0.1, 0.5, 0.6, np.nan]]])  # (steps, 1, flows)
    assert asked(policy, washout) == [False, True, True, False]


def test_random_alarms_have_a_stream_for_each_flow():
    given, strategy = experiment(4), PredictionTriggered(1.0, 1.0)
    policy = controlling_policy("random", strategy, given, [], alarm_rate=0.4, seed=3)
    looks = strategy.timing(given.schedule).most_looks
    for row in range(4):
        stream = random_streams.stream(7, "random alarms", "Re400", 3, 10 + row)
        for number, value in enumerate(stream.random(looks)):
            look = replace(look_at(np.zeros((1, 1, 1))), rows=[row], number=[number])
            assert np.asarray(policy(look)).tolist() == [value < 0.4]


def test_a_vote_needs_its_share():
    # ten members: flow i has the alarms of i members
    members = [lambda look, number=number: look.rows > number for number in range(10)]
    washout = np.zeros((1, 1, 11))
    for needed in range(1, 11):
        expected = [count >= needed for count in range(11)]
        assert asked(by_vote(members, needed / 10), washout) == expected
    assert asked(by_vote(members, 0.01), washout) == [False] + [True] * 10


@pytest.mark.parametrize("share", [-0.1, 0.0, 1.1, np.nan])
def test_shares_are_no_more_than_all(share):
    with pytest.raises(ValueError, match="share of a vote"):
        by_vote([lambda look: look.rows > 0], share)
    if share != 0:
        with pytest.raises(ValueError, match="must lie in"):
            at_random(share, np.zeros((1, 1)))
    with pytest.raises(ValueError, match="one member"):
        by_vote([], 0.5)


# -- control by a vote -----------------------------------------------------------------------------


def test_a_strategy_without_votes_takes_no_committee():
    reactive = make_strategy("reactive", SETTINGS["reactive"])
    with pytest.raises(TypeError, match="Reactive has no vote_share"):
        controlling_policy("committee", reactive, experiment(2), [EQUATIONS, EQUATIONS])


def test_members_without_rows_of_their_memory_are_side_by_side_too():
    """Analogues have one number for each member: nothing before its axis."""
    memory = np.arange(6.0).reshape(2, 3)  # (members, batch)

    class Listed(Script):
        def ensemble(self, washout):
            return memory

    members = Members(Listed(np.zeros(1)))
    assert members.start(np.zeros((1, 1, 3))).tolist() == [*range(6)]


@given(st.text(), st.text(), st.floats(allow_nan=False))
def test_any_text_in_a_name_is_put_back(watched, pushed, number):
    columns = as_columns({"watch": watched, "force": number, "push": pushed})
    assert columns == {"force": number, "options": columns["options"]}
    assert options_in(columns["options"]) == {"watch": watched, "push": pushed}
