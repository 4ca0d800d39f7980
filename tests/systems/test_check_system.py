"""Looking at a system: what is found, what is proposed, and messages about mistakes."""

import copy
import math
import re
from dataclasses import dataclass, replace
from pathlib import Path
from typing import ClassVar

import numpy as np
import pytest
import yaml

from burstcast.arrays import FloatArray
from burstcast.data.dataset import initial_states
from burstcast.systems.base import DynamicalSystem
from burstcast.systems.check import (
    UnsoundSystemError,
    _case,
    _initial_states,
    _outwards,
    _round,
    _stride,
    _whole,
    check_system,
    interface_problems,
)
from burstcast.systems.compiled import hindrance
from burstcast.systems.fitzhugh_nagumo import FitzHughNagumoPair
from burstcast.systems.flow_map import FlowMap
from burstcast.systems.lorenz63 import Lorenz63
from burstcast.systems.lyapunov import Estimate
from burstcast.systems.mfe import MoehlisFaisstEckhardt
from burstcast_workflow.campaign.campaign import Campaign
from burstcast_workflow.commands.check_system import case_text, report
from burstcast_workflow.commands.command_line import main
from burstcast_workflow.config.loading import load

ROOT = Path(__file__).parents[2]
STATES = np.random.default_rng(1).normal(0.0, 5.0, (3, 16))


@dataclass(frozen=True)
class Mistaken(Lorenz63):
    """A Lorenz system, parts of which are overridden by what has a mistake."""


def mistaken(**methods) -> DynamicalSystem:
    return dataclass(frozen=True)(type("Mistaken", (Lorenz63,), methods))()  # type: ignore[no-any-return]


def generator() -> np.random.Generator:
    return np.random.default_rng(7)


@pytest.mark.parametrize(
    "system", [Lorenz63(), FitzHughNagumoPair(), MoehlisFaisstEckhardt(400.0)], ids=str
)
def test_the_systems_that_ship_keep_to_the_interface(system) -> None:
    states = np.random.default_rng(2).normal(0.0, 0.3, (system.dimension, 16))
    assert list(interface_problems(system, states)) == []


def wrong_jacobian(self, state):
    j = Lorenz63().jacobian(state)
    j[2, 1] = -state[0]
    return j


def mixing(self, state):
    return Lorenz63().right_hand_side(state) + 1e-3 * state.mean()


@pytest.mark.parametrize(
    ("methods", "message"),
    [
        ({"observable": lambda self, x: x[:1]}, r"observable returns the shape \(1, 16\)"),
        ({"observable": lambda self, x: x[2] > 0}, "observable returns numbers of type bool"),
        ({"right_hand_side": lambda self, x: x[:2]}, r"right_hand_side returns the shape \(2, 16"),
        ({"right_hand_side": lambda self, x: x[7]}, "right_hand_side fails .* IndexError"),
        ({"jacobian": lambda self, x: x}, r"jacobian returns the shape .* not \(3, 3, 16\)"),
        ({"jacobian": wrong_jacobian}, r"jacobian: the entry \[2, 1\] differs from differences"),
        ({"right_hand_side": mixing}, "differs from the same trajectory alone"),
        (
            {"right_hand_side": lambda self, x: np.multiply(x, 2.0, out=x)},
            "right_hand_side changes the states",
        ),
        (
            {"sample_initial_states": lambda self, n, g: g.random((n, 3))},
            r"must return the shape \(3, 16\), not \(16, 3\)",
        ),
    ],
)
def test_mistakes_are_told(methods, message) -> None:
    system = mistaken(**methods, case_defaults={})
    with pytest.raises(UnsoundSystemError, match=message):
        check_system(system, generator())


@pytest.mark.parametrize("component", [None, 1, 3])
@pytest.mark.parametrize("perturbation", [None, 1e-3, 2.0])
def test_trajectories_begin_as_the_ensemble_of_the_system_does(component, perturbation) -> None:
    begin = {"initial_state": [1.0, -2.0, 20.0], "perturbed_component": component}
    system = mistaken(case_defaults={"ensemble": {**begin, "perturbation": perturbation}})
    found = _initial_states(system, generator())
    raised = (component or 1) - 1, perturbation or 0.01
    expected = initial_states(np.array([1.0, -2.0, 20.0]), *raised, 16, generator())
    np.testing.assert_array_equal(found, expected)


def test_systems_that_explode_and_that_come_to_rest_are_told() -> None:
    growing = mistaken(right_hand_side=lambda self, x: x * x, jacobian=DynamicalSystem.jacobian)
    with pytest.raises(UnsoundSystemError, match="do not stay finite"):
        check_system(growing, generator())
    with pytest.raises(UnsoundSystemError, match="come to rest"):
        check_system(Lorenz63(rho=0.5), generator())


@pytest.mark.parametrize("says", [True, False])
def test_what_is_found_of_the_lorenz_system(monkeypatch, says) -> None:
    if not says:
        monkeypatch.setattr(Lorenz63, "case_defaults", {})
    check = check_system(Lorenz63(), generator())
    assert check.verdict == "chaotic"
    assert check.by_qr.mean == pytest.approx(0.9056, rel=0.05)
    assert check.by_qr.low < check.by_qr.mean < check.by_qr.high  # trajectories are different ones
    assert check.by_growth.mean == pytest.approx(0.9056, rel=0.05)
    assert check.spectrum.sum() == pytest.approx(-(10 + 1 + 8 / 3), rel=1e-3)
    assert 0.5 < check.fastest_period < 1.0  # a turn around a wing takes 0.75
    assert 0.005 <= check.time_step * check.sampling_stride <= 0.03
    assert check.observable_quantiles[0.95] == pytest.approx(38.0, abs=1.0)
    # 0.7246 in 20 trajectories of 580 time units, counted apart
    assert check.events_per_lyapunov_time == pytest.approx(0.725, rel=0.05)
    assert "compiled" in check.integrator


@pytest.mark.parametrize("says", [True, False])
@pytest.mark.parametrize(
    ("name", "system"), [("lorenz63", Lorenz63()), ("fitzhugh_nagumo", FitzHughNagumoPair())]
)
def test_the_proposed_case_can_be_pasted_into_a_config(monkeypatch, name, system, says) -> None:
    if not says:
        monkeypatch.setattr(type(system), "case_defaults", {})
    check = check_system(system, generator())
    config = yaml.safe_load((ROOT / "config.yaml").read_text())
    pasted = yaml.safe_load(case_text(name, {}, check))
    network = {"esn": {"neurons": [100], "validation": ["RV"], "seeds": 1}}
    config["campaign"].append({"cases": [name], "forecasters": network})
    config["cases"].update(copy.deepcopy(pasted["cases"]))
    # as if the exponent were published: what has to fit into a series is checked, too
    exponent = float(check.by_qr.mean)
    config["cases"][name].setdefault("lyapunov", {})["published_exponent"] = exponent
    record = Campaign(load(config)).cases[name].dump()
    low, high = record["density"]["range"]
    assert low <= check.observable_quantiles[0.0] < check.observable_quantiles[1.0] <= high
    assert record["event_threshold"] == (
        type(system).case_defaults["event_threshold"] if says else {"quantile": 0.95}
    )


def test_a_map_is_checked_like_everything_else() -> None:
    @dataclass(frozen=True)
    class Henon(FlowMap):
        dimension: ClassVar[int] = 2
        observable_name: ClassVar[str] = "x"
        observable_symbol: ClassVar[str] = "x"

        def flow_map(self, state: FloatArray, time_step: float) -> FloatArray:
            return np.stack([1.0 - 1.4 * state[0] * state[0] + state[1], 0.3 * state[0]])

        def observable(self, state: FloatArray) -> FloatArray:
            return np.array(state[0])

        def sample_initial_states(self, series: int, generator) -> FloatArray:
            return np.asarray(generator.uniform(-0.1, 0.1, (2, series)))

    check = check_system(Henon(), generator())
    assert (check.time_step, check.sampling_stride) == (1.0, 1)
    assert check.by_qr.mean == pytest.approx(0.419, rel=0.05)
    assert "own integrator" in check.integrator
    assert "ensemble" in check.case
    assert "initial_state" not in check.case["ensemble"]


@pytest.mark.parametrize("unit", [1e-3, 1e3])
def test_the_integration_step_does_not_depend_on_the_unit_of_a_state(unit) -> None:
    scaled = mistaken(
        right_hand_side=lambda self, x: unit * Lorenz63().right_hand_side(x / unit),
        jacobian=DynamicalSystem.jacobian,
    )
    assert _stride(scaled, unit * STATES, 0.02) == _stride(Lorenz63(), STATES, 0.02) > 1


def test_the_command_line(capsys) -> None:
    assert main(["check-system", "lorenz63", "rho=28"]) == 0
    said = capsys.readouterr().out
    assert "Lorenz63: keeps to the interface" in said
    assert "leading exponent       0.9" in said
    assert yaml.safe_load(said[said.index("cases:") :])["cases"]["lorenz63"]["parameters"] == {
        "rho": 28
    }
    for arguments, message in (
        (["lorentz63"], "did you mean 'lorenz63'"),
        (["lorenz63", "rho"], "write NAME=VALUE"),
        (["lorenz63", "rho=0.5"], "lorenz63 has mistakes:\n  all trajectories come to rest"),
    ):
        assert main(["check-system", *arguments]) == 1
        assert message in capsys.readouterr().err


@pytest.mark.parametrize(
    ("value", "rounded"),
    [(1.0, 1), (1.89, 1), (1.95, 2), (4.7, 2), (4.8, 5), (9.9, 5), (0.0021, 0.002), (730.0, 500)],
)
def test_one_two_or_five_that_is_not_much_larger(value, rounded) -> None:
    assert _round(value) == rounded


@pytest.mark.parametrize(
    ("duration", "unit", "whole"),
    [
        (12.34, 0.01, 13.0),
        (12.0, 0.01, 12.0),
        (0.974, 0.01, 0.97),
        (0.001, 0.5, 0.5),
        (730, 1, 730),
    ],
)
def test_durations_are_whole_and_have_two_digits(duration, unit, whole) -> None:
    assert _whole(duration, unit) == pytest.approx(whole, rel=1e-12)


def test_ranges_hold_what_lies_inside() -> None:
    assert (_outwards(-1.234, math.floor), _outwards(1.234, math.ceil)) == (-1.3, 1.3)
    assert (_outwards(0.0451, math.floor), _outwards(-45.1, math.ceil)) == (0.045, -45.0)
    assert _outwards(0.0, math.floor) == 0.0


@pytest.mark.parametrize(("exponent", "unit"), [(0.5, 2.0), (0.0, 100 * 0.2), (-1.0, 100 * 0.2)])
def test_a_proposal_begins_where_the_runs_have_ended(exponent, unit) -> None:
    samples = np.random.default_rng(5).normal(0.0, [[1.0], [30.0], [2.0]], (50, 3, 4))
    system = mistaken(case_defaults={})
    ensemble = _case(system, 0.1, 2, exponent, samples, {0.0: -1.0, 1.0: 1.0})["ensemble"]
    np.testing.assert_allclose(ensemble["initial_state"], samples[-1, :, 0], rtol=1e-3)
    # of the component that varies most, a tenth of what it varies by
    assert ensemble["perturbed_component"] == 2
    assert ensemble["perturbation"] == pytest.approx(3.0, rel=0.2)
    # in Lyapunov times, or hundreds of samples where there is none
    assert ensemble["transient"] == pytest.approx(20 * unit, rel=0.02)
    assert ensemble["duration"] == pytest.approx(70 * unit, rel=0.02)


def test_a_limit_cycle_has_no_lyapunov_time() -> None:
    check = check_system(Lorenz63(rho=160.0), generator(), longest=1.0)
    assert check.verdict == "regular"
    assert "no Lyapunov time" in report("lorenz63", {"rho": 160.0}, check)


def test_where_an_interval_holds_zero_nothing_is_said_about_chaos() -> None:
    check = check_system(Lorenz63(), generator())
    zero = Estimate(*(np.array(value) for value in (0.001, 0.002, -0.003, 0.005)))
    for unsure in (replace(check, by_qr=zero), replace(check, by_growth=zero)):
        assert unsure.verdict == "undecided"
        text = report("lorenz63", {}, unsure)
        assert "chaos undecided" in text
        assert "no Lyapunov time" not in text
    both = replace(check, by_qr=zero, by_growth=zero)
    assert "longer than 200" in report("lorenz63", {}, both)


@dataclass(frozen=True)
class HindmarshRose(DynamicalSystem):
    """A bursting neuron (Proc. R. Soc. B 221 (1984) 87), whose exponent is a hundredth."""

    current: float = 3.25

    dimension: ClassVar[int] = 3
    observable_name: ClassVar[str] = "membrane potential"
    observable_symbol: ClassVar[str] = "x"

    def right_hand_side(self, state):
        x, y, z = state
        derivative = np.empty_like(state)
        derivative[0] = y - x**3 + 3.0 * x**2 - z + self.current
        derivative[1] = 1.0 - 5.0 * x**2 - y
        derivative[2] = 0.006 * (4.0 * (x + 1.6) - z)
        return derivative

    def observable(self, state):
        return np.array(state[0])


class Tempered(HindmarshRose):
    """The same with an operation that cannot be compiled."""

    def right_hand_side(self, state):
        return super().right_hand_side(np.tanh(state / 10.0) * 10.0)


@pytest.mark.long
def test_cubes_compile_and_chaos_of_a_small_exponent_is_found() -> None:
    check = check_system(HindmarshRose(), generator())
    assert check.integrator == "Runge-Kutta scheme, compiled"
    assert check.verdict == "chaotic"
    assert check.by_qr.mean == pytest.approx(0.0133, rel=0.1)
    assert 50 < check.steps_per_lyapunov_time < 500
    assert check.fastest_period / (check.time_step * check.sampling_stride) > 9.0


def test_what_hinders_compilation_is_named_with_its_line() -> None:
    reason = hindrance(Tempered(), 0.1)
    assert reason is not None
    assert re.match(r".*test_check_system.py:\d+, return super.*np.tanh.*_Symbol", reason)
    assert hindrance(HindmarshRose(), 0.1) is None
