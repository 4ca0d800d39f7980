"""Check of a system: what is found, and messages about mistakes."""

import re
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

import numpy as np
import pytest

from burstcast.arrays import FloatArray
from burstcast.data.dataset import initial_states
from burstcast.systems.base import DynamicalSystem
from burstcast.systems.check import (
    UnsoundSystemError,
    _initial_states,
    check_system,
    interface_problems,
)
from burstcast.systems.compiled import hindrance
from burstcast.systems.fitzhugh_nagumo import FitzHughNagumoPair
from burstcast.systems.flow_map import FlowMap
from burstcast.systems.lorenz63 import Lorenz63
from burstcast.systems.mfe import MoehlisFaisstEckhardt
from burstcast_workflow.commands.command_line import main

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


def test_a_system_that_explodes_is_refused() -> None:
    growing = mistaken(right_hand_side=lambda self, x: x * x, jacobian=DynamicalSystem.jacobian)
    with pytest.raises(UnsoundSystemError, match="do not stay finite"):
        check_system(growing, generator())


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

    assert "its own integrator" in check_system(Henon(), generator())


def test_the_command_line(capsys) -> None:
    assert main(["check-system", "lorenz63", "rho=28"]) == 0
    interface, integrator, derivatives = capsys.readouterr().out.splitlines()
    assert interface == "Lorenz63: keeps to the interface"
    assert integrator.endswith("Runge-Kutta scheme, compiled")
    assert "Jacobian given, within" in derivatives
    for arguments, message in (
        (["lorentz63"], "did you mean 'lorenz63'"),
        (["lorenz63", "rho"], "write NAME=VALUE"),
    ):
        assert main(["check-system", *arguments]) == 1
        assert message in capsys.readouterr().err


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


def test_what_hinders_compilation_is_named_with_its_line() -> None:
    reason = hindrance(Tempered(), 0.1)
    assert reason is not None
    assert re.match(r".*test_check_system.py:\d+, return super.*np.tanh.*_Symbol", reason)
    assert hindrance(HindmarshRose(), 0.1) is None
