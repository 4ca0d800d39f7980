"""Controllers of one's own: the interface, the arenas, the entries of the benchmark."""

import re
from dataclasses import dataclass, replace

import numpy as np
import pytest
from helpers_control import PAPER, experiment
from scipy import stats

from burstcast.base.discovery import UnsoundError
from burstcast.control import rules
from burstcast.control.arenas import (
    Lorenz96Arena,
    ShearFlowArena,
    checked_action,
    run_shear_flow,
)
from burstcast.control.check import _shear_flow, check_controller
from burstcast.control.controller import Controller, make_controller
from burstcast.control.long_run import run_long
from burstcast.control.rules import (
    ClassifierTriggered,
    ForecastTriggered,
    LocalInterventions,
    NoAction,
    WhileHigh,
    WhileRising,
)
from burstcast.control.strategies.reactive import Reactive
from burstcast.data.events import upward_crossings
from burstcast.forecasters._event_classifier import EventClassifier
from burstcast.systems.integration import integrate
from helpers_library import ROOT

SMALL = Lorenz96Arena(flows=6, years=0.05, settling_years=0.01)


@dataclass
class Bad(Controller):
    """Breaks a rule."""

    rule: str = ""
    calls: int = 0

    def observe(self, observations):
        self.flows = observations.shape[-1]
        if self.rule == "changes":
            observations += 1.0

    def act(self):
        self.calls += 1
        if self.rule == "fails":
            raise KeyError("weights")
        action = np.zeros((self.task.actuators, self.flows))
        if self.rule == "strong":
            action[0] = 2 * self.task.limit
        if self.rule == "several":
            action[:] = self.task.limit
        if self.rule == "remembers":
            action[0, 0] = self.task.limit * (self.calls % 7 == 0)
        if self.rule == "pushes":
            action[0, 0] = self.task.limit / 2
        if self.rule == "fails to count":
            action[0, 3] = np.nan
        if self.rule == "draws":
            action[0, 0] = self.task.limit * (np.random.default_rng().random() < 0.5)
        if self.rule == "calibrates":
            self.task.training[:] -= self.task.training.mean()
        return action[0] if self.rule == "shape" else action


@pytest.mark.parametrize(
    ("rule", "message"),
    [
        ("changes", "observe changes the observations"),
        ("fails", r"KeyError: 'weights' \(test_control_controllers.py, line \d+\)"),
        ("fails to count", "act returns no number for the flow 3"),
        ("draws", "a second run acts otherwise: begin .* or seeds no generator"),
        ("calibrates", "read-only"),
        ("strong", "beyond the limit of"),
        ("shape", r"act returns the shape \(5,\), not \(actuators, flows\) \(1, 5\)"),
        ("remembers", "a second run acts otherwise"),
    ],
)
def test_controllers_that_break_a_rule_are_told_so(rule, message):
    with pytest.raises(UnsoundError, match=message):
        check_controller(Bad(rule))


def test_only_as_many_actuators_act_as_may():
    task = SMALL.task()
    action = np.zeros((40, 6))
    action[3, 2] = -task.limit
    assert checked_action(action, task, 6) is not None
    action[5, 2] = task.limit
    with pytest.raises(ValueError, match="more than 1 of the actuators"):
        checked_action(action, task, 6)
    # of the shear flow's one actuator no second one can act: the rule is that of the other arena
    assert "does not fit: act uses more than 1" in check_controller(Bad("several"))
    # nor may a switch be half on, as a push may
    assert "does not fit: act returns values between: act" in check_controller(Bad("pushes"))


def test_arenas_score_controllers_in_words_and_numbers():
    """As their counts have it."""
    arena = ShearFlowArena(initial_states=30, span_lt=60.0)
    score, counts = arena.score(WhileHigh(level=0.08)), arena.run(WhileHigh(level=0.08))
    time = counts.steps.sum() / 61
    low, high = stats.gamma.ppf([0.025, 0.975], score.events + np.array([0, 1])) / time
    assert score.events == counts.events.sum() > 0
    assert score.rate == pytest.approx((score.events / time, low, high))
    assert score.acting == counts.actuated_steps.sum() / counts.steps.sum()
    assert re.match(
        rf"{score.events} events in \d+ LT: one in [\d.]+ \([\d.]+ to [\d.]+\) LT", str(score)
    )
    pushed = SMALL.score(LocalInterventions())
    assert (pushed.time, pushed.decisions) == (pytest.approx(6 * 0.05), 6 * (15 + 73))
    assert pushed.rate == (0, 0, pytest.approx(-np.log(0.05) / 0.3))
    with pytest.raises(ValueError, match="no flow is left of 12 initial_states"):
        ShearFlowArena(initial_states=12).run(NoAction())
    assert "0 events in 0.3 years: fewer than one in 0.1 years" in str(pushed)


def test_a_report_says_for_which_arena_a_controller_is():
    report = check_controller(make_controller("burstcast.control.rules:WhileHigh", {"level": 0.0}))
    assert "shear flow           acts at 100 % of the decisions" in report
    assert "Lorenz 96            does not fit: act returns the shape (1, 5)" in report
    with pytest.raises(ValueError, match="names no controller: write <module>:<class>"):
        make_controller("reactive", {})
    with pytest.raises(ValueError, match="did you mean 'level'"):
        make_controller("burstcast.control.rules:WhileHigh", {"levle": 0.0})


def test_a_rule_controls_the_shear_flow_as_the_strategy_does():
    """In both the actuator is on while the last observed k is high."""
    schedule = replace(PAPER, quiet_lt=2.0, span_lt=10.0)
    given = experiment(8, schedule, threshold=0.1, quiet_starts=False)
    noise = 0.01 * given.washouts.std(axis=(0, 1))
    counts = run_shear_flow(
        WhileHigh(level=0.06),
        given,
        given.washouts,
        noise,
        decision_interval_lt=0.25,
        laminarisation_threshold=None,
    )
    strategy = Reactive(decision_interval_lt=0.25, level=0.06)
    expected = run_long(
        given,
        strategy.timing(schedule),
        strategy.policy(given, None),
        levels=[0.1],
        laminarisation_threshold=None,
        noise_scale=noise,
    )
    for name, values in vars(expected).items():
        assert getattr(counts, name).tolist() == values.tolist()
    assert 0 < counts.actuated_steps.sum() < counts.steps.sum()


def test_slopes_and_forecasts_see_what_comes():
    task, seen = _shear_flow()
    exact = replace(task, noise=0 * task.noise)
    for start in range(0, 300, 60):
        window = seen[start : start + 30]
        rising, ahead = WhileRising(level=0.05, ahead=20.0), ForecastTriggered(horizon=100.0)
        for controller in (rising, ahead):
            controller.begin(exact, 5)
            controller.observe(window)
        observable = task.space.observable(window.transpose(1, 0, 2))
        lines = [np.polyfit(np.arange(-29, 1), flow, 1) for flow in observable.T]
        expected = [np.polyval(line, 20.0) >= 0.05 for line in lines]
        assert rising.act()[0].tolist() == [float(value) for value in expected]
        states = integrate(task.equations, window[-1], 0.25, 400, 4)
        comes = (task.equations.observable(states[1:].transpose(1, 0, 2)) >= 0.1).any(axis=0)
        assert ahead.act()[0].tolist() == [float(value) for value in comes]
    two = WhileHigh(9.0, "observable", "-a1", -0.3)
    two.begin(task, 5)
    two.observe(seen[:30])
    assert two.act()[0].tolist() == [float(value) for value in seen[29, 0] <= 0.3]


class Shown(EventClassifier):
    """Keeps the points that it is fitted to; the probability is a tenth of the last component."""

    def fit(self, points, case):
        self.__dict__["points"] = points
        return self

    def probabilities(self, washouts, exogenous=None):
        return 0.1 * washouts[:, -1, -1:]


def test_a_classifier_learns_whether_the_threshold_is_reached(monkeypatch):
    task, seen = _shear_flow()
    shown = Shown()
    monkeypatch.setattr(rules, "make_kind", lambda kind, options: shown)
    controller = ClassifierTriggered(horizon=100.0, probability=0.04)
    controller.begin(task, 5)
    points = shown.points
    assert len(points.washouts) == len(points.happened) == len(points.series) > 100
    # each washout is found in its series, and what follows it there is compared step by step
    k = task.space.observable(task.training.transpose(2, 0, 1))
    for washout, happened, number in list(
        zip(points.washouts, points.happened, points.series, strict=True)
    )[::37]:
        series = task.training[number]
        now = int(np.flatnonzero((series == washout[-1]).all(axis=1))[0])
        assert (series[now + 1 - len(washout) : now + 1] == washout).all()
        assert happened.tolist() == [any(k[number, now + step] >= 0.1 for step in range(1, 101))]
    assert 0 < points.happened.mean() < 1
    window = seen[:30].copy()
    window[-1, -1] = [0.3, 0.5, 0.4, 0.1, 0.9]
    controller.observe(window)
    assert controller.act()[0].tolist() == [0.0, 1.0, 1.0, 0.0, 1.0]
    monkeypatch.undo()
    with pytest.raises(ValueError, match="nvar gives no probability"):
        ClassifierTriggered(100.0, 0.1, "nvar").begin(task, 5)
    with pytest.raises(ValueError, match="too short for a horizon"):
        ClassifierTriggered(1e5, 0.1).begin(task, 5)


def test_the_free_flow_of_lorenz_is_counted_as_it_is():
    """Events of any variable, in one array of states without noise or control."""
    arena = replace(SMALL, threshold=10.0)
    counts = arena.run(NoAction())
    steps = round(0.01 * 1460), round(0.01 * 1460) + round(0.05 * 1460)
    states = integrate(arena.system, arena._start(), 0.01, 5 * steps[1], 5)
    events = upward_crossings(states, 10.0, axis=0)[steps[0] + 1 :].sum(axis=(0, 1))
    assert counts.events.tolist() == events.tolist()
    assert counts.events.sum() > 10
    assert not counts.effort.any()
    assert not counts.interventions.any()


def test_local_interventions_avoid_events():
    """At a threshold with many of them, as the flow is short; what they cost is counted."""
    arena = replace(SMALL, threshold=11.0, limit=1.0, years=0.06)
    free = arena.run(NoAction()).events.sum()
    controller = LocalInterventions(members=20, scenarios=4)
    first, second = (arena.run(controller) for _ in range(2))
    assert first.events.tolist() == second.events.tolist()
    assert first.events.sum() < 0.5 * free
    assert first.effort.tolist() == first.interventions.tolist()
    assert first.interventions.sum() > 0


def test_a_better_intervention_is_found_among_all():
    """Each of 80 and none is simulated here one by one, for one member without noise."""
    arena = replace(SMALL, threshold=11.0, limit=1.0)
    task = arena.task()
    states = integrate(arena.system, arena._start(), 0.01, 3000, 5)
    rises = (states.max(axis=1) >= 11.0).nonzero()
    step, flow = next((s, f) for s, f in zip(*rises, strict=True) if s > 30)
    state = states[step - 15, :, [flow]].T
    controller = LocalInterventions(scenarios=1)
    controller.begin(task, 1)
    controller._ensemble = np.ascontiguousarray(state[:, np.newaxis])
    action = controller.act()[:, 0]
    options = np.concatenate([np.zeros((1, 40)), np.eye(40), -np.eye(40)])
    ahead = integrate(arena.system, state + options.T, 0.01, 100, 5)[1:]
    peaks = ahead.max(axis=(0, 1))
    best = np.lexsort((peaks, peaks >= 11.0))[0]
    assert action.tolist() == options[best].tolist()
    assert peaks[0] >= 11.0
    assert peaks[best] < peaks[0]


def test_the_controller_of_the_page_keeps_to_the_interface_and_runs(tmp_path, monkeypatch, capsys):
    page = (ROOT / "docs" / "controllers.md").read_text(encoding="utf-8")
    code, running = (block.split("```")[0] for block in page.split("```python\n")[1:])
    (tmp_path / "my_controllers.py").write_text(code, encoding="utf-8")
    monkeypatch.syspath_prepend(tmp_path)
    controller = make_controller("my_controllers:HighAndRising", {"level": 0.03})
    report = check_controller(controller)
    assert re.search(r"shear flow +acts at [1-9]\d* % of the decisions", report)
    for large, small in (
        ("60, span_lt=100.0", "24, span_lt=5.0"),
        ("16, years=0.5", "4, years=0.02"),
    ):
        assert large in running
        running = running.replace(large, small)
    exec(running, {})
    printed = capsys.readouterr().out.splitlines()
    assert [line.split("(")[0] for line in printed[:3]] == [
        "NoAction",
        "WhileHigh",
        "HighAndRising",
    ]
    assert all("events in" in line for line in printed)
