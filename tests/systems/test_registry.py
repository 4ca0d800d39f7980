"""Systems by name, the check of a system, and the messages for what cannot be made."""

import math
import re
import sys
from dataclasses import dataclass, replace

import numpy as np
import pytest

from burstcast.base.discovery import UnsoundError
from burstcast.data.dataset import initial_states
from burstcast.systems.base import DynamicalSystem, has_own
from burstcast.systems.check import _initial_states, check_system, interface_problems
from burstcast.systems.compiled import hindrance
from burstcast.systems.fitzhugh_nagumo import FitzHughNagumoPair
from burstcast.systems.forced import ForcedSystem
from burstcast.systems.integration import integrate
from burstcast.systems.kuramoto_sivashinsky import KuramotoSivashinsky
from burstcast.systems.lorenz63 import Lorenz63
from burstcast.systems.lorenz96 import Lorenz96
from burstcast.systems.mfe import MoehlisFaisstEckhardt
from burstcast.systems.polynomials.system import PolynomialSystem
from burstcast.systems.registry import available_systems, make_system, parameters_of, system_module
from burstcast_workflow.commands.command_line import main
from kolmogorov_flow import KolmogorovFlow

OURS = ["fitzhugh_nagumo", "kuramoto_sivashinsky", "lorenz63", "lorenz96", "mfe"]


def test_systems_are_made_by_name_with_defaults_and_integers():
    assert available_systems() == [
        "fitzhugh_nagumo",
        "kuramoto_sivashinsky",
        "lorenz63",
        "lorenz96",
        "mfe",
    ]
    assert make_system("mfe", {"reynolds": 400}) == MoehlisFaisstEckhardt(400.0)
    assert make_system("lorenz63", {}) == Lorenz63()
    system = make_system("mfe", {"reynolds": 600.0, "length_x": 5.0})
    assert system == MoehlisFaisstEckhardt(600.0, length_x=5.0)


@pytest.mark.parametrize(
    ("name", "parameters", "message"),
    [
        *(
            (name, {}, "available systems are fitzhugh_nagumo, kur")
            for name in ("base", "registry", "mfe.x", "", "os")
        ),
        ("lorentz63", {}, "did you mean 'lorenz63'"),
        ("mfe", {"reynold": 400.0}, r"no parameter 'reynold' \(did you mean 'reynolds'\?\)"),
        ("mfe", {"length_x": 5.0}, "needs the parameter 'reynolds'"),
        ("mfe", {"reynolds": "400"}, "'reynolds' of system 'mfe' must be a finite number"),
        ("mfe", {"reynolds": -400.0}, "reynolds must be positive"),
    ],
)
def test_what_makes_no_system_is_told(name, parameters, message):
    with pytest.raises(ValueError, match=message):
        make_system(name, parameters)


@pytest.mark.parametrize("name", ["sigma", "rho", "beta"])
def test_bad_parameters_raise(name):
    with pytest.raises(ValueError, match=f"{name} must be finite"):
        Lorenz63(**{name: math.nan})


# -- systems of one's own --------------------------------------------------------------------------
OWN = """
from dataclasses import dataclass
from typing import ClassVar
from burstcast.systems.base import DynamicalSystem, has_own

@dataclass(frozen=True)
class Circle(DynamicalSystem):
    rate: float = 1.0
    dimension: ClassVar[int] = 2
    observable_name: ClassVar[str] = "x"
    observable_symbol: ClassVar[str] = "x"
    def right_hand_side(self, state):
        return self.rate * state
    def observable(self, state):
        return state[0]
"""


@pytest.fixture
def module(tmp_path, monkeypatch):
    """Write a module of one's own, and make it importable."""
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setattr(sys, "dont_write_bytecode", True)

    def write(text, name="own_circles"):
        path = tmp_path / f"{name}.py"
        path.parent.mkdir(exist_ok=True)
        path.write_text(text)

    before = set(sys.modules)
    yield write
    for name in set(sys.modules) - before:
        if name.startswith("own_"):
            del sys.modules[name]


def test_a_system_of_ones_own_may_be_in_a_package(module):
    module(OWN)
    system = make_system("own_circles:Circle", {"rate": 2})
    assert (system.dimension, system.rate) == (2, 2.0)
    with pytest.raises(ValueError, match=r"no parameter 'rat' \(did you mean 'rate'\?\)"):
        make_system("own_circles:Circle", {"rat": 2})
    module("", "own_flows/__init__")
    module("from own_flows.circles import *", "own_flows/other")
    module(OWN, "own_flows/circles")
    assert make_system("own_flows.circles:Circle", {}).dimension == 2
    assert system_module("own_flows.circles:Circle") == "own_flows.circles"
    assert system_module("lorenz63") == "burstcast.systems.lorenz63"


@pytest.mark.parametrize(
    ("old", "new", "name", "message"),
    [
        ("", "", "own_squares:Circle", r"there is no module own_squares here or among what is"),
        ("", "", "own_circles.deep:Circle", r"there is no module own_circles\.deep"),
        ("", "", "own_circles:Cirle", r"has no class Cirle \(did you mean 'Circle'\?\)"),
        ("", "", "own_circles:dataclass", r"dataclass of own_circles .* is no system"),
        ("self.rate *", "self.rate *)", "own_circles:Circle", r"circles\.py, line 13: SyntaxError"),
        ("import Cl", "import Kl", "own_circles:Circle", r"own_circles\.py, line 3: ImportError"),
        ("ClassVar[int]", "Clas[int]", "own_circles:Circle", r"line 9: NameError: .*'Clas'"),
        ("from typing", "import no_such\nfrom typing", "own_circles:Circle", r"line 3: .*no_such"),
        ("rate: float = 1.0", "rate: list = []", "own_circles:Circle", r"circles\.py, line 6: V"),
        ("observable(", "obsrvable(", "own_circles:Circle", r"Circle of own_circles lacks observ"),
        ("dimension:", "dimensions:", "own_circles:Circle", r"Circle of own_circles lacks dimens"),
        ("@dataclass(frozen=True)\n", "", "own_circles:Circle", r"must be a dataclass"),
        (
            "    def obs",
            "    def __post_init__(self):\n        self.x = self.y\n    def obs",
            "own_circles:Circle",
            r"own_circles:Circle cannot be made: AttributeError: .*'y'",
        ),
    ],
)
def test_a_mistake_in_a_module_is_told(module, old, new, name, message):
    assert old in OWN
    module(OWN.replace(old, new, 1) if old else OWN)
    with pytest.raises((ValueError, TypeError), match=message):
        make_system(name, {})


def test_one_broken_module_spoils_no_other(monkeypatch, tmp_path):
    """Modules of the package with a mistake, beside those that have none."""
    import burstcast.systems

    second = OWN[OWN.index("@dataclass") :].replace("Circle", "Square")
    unfinished = OWN.replace("def observable", "def observed")
    texts = {"several": OWN + second, "broken": "def right_hand_side(:", "unfinished": unfinished}
    for name, text in texts.items():
        (tmp_path / f"{name}.py").write_text(text)
    monkeypatch.setattr(burstcast.systems, "__path__", [*burstcast.systems.__path__, str(tmp_path)])
    assert make_system("lorenz63", {}) == Lorenz63()
    assert available_systems() == [*OURS, "several"]
    for name, error, message in (
        ("lorentz63", ValueError, r"did you mean 'lorenz63'\?\); the available systems are f"),
        ("broken", ValueError, r"broken\.py, line 1: SyntaxError"),
        ("unfinished", ValueError, r"class Circle of .*unfinished lacks observable"),
        ("several", TypeError, "must define one system, not several: Circle, Square"),
    ):
        with pytest.raises(error, match=message):
            make_system(name, {})


# -- what every system keeps to --------------------------------------------------------------------
TERMS = np.random.default_rng(6).normal(size=(20, 3)) * (np.arange(60).reshape(20, 3) % 2)
EVERY = {
    "lorenz": Lorenz63(),
    "other lorenz": Lorenz63(9.0, 20.0, 2.5),
    "pair": FitzHughNagumoPair(),
    "lorenz 96": Lorenz96(variables=9),
    "shear flow": MoehlisFaisstEckhardt(400.0),
    "narrow shear flow": MoehlisFaisstEckhardt(250.0, 3.0, 7.0),
    "polynomials": PolynomialSystem(TERMS, 3, Lorenz63()),
    "flow in a plane": KolmogorovFlow(),
    "flames": KuramotoSivashinsky(),
    "few flames": KuramotoSivashinsky(30.0, 5),
    "pushed shear flow": ForcedSystem(MoehlisFaisstEckhardt(800.0), [0.001, 0, -0.002, *[0] * 6]),
}


@pytest.fixture(params=EVERY, name="one_of_all")
def every(request):
    """A system, and states of it."""
    result = EVERY[request.param]
    return result, np.random.default_rng(2).uniform(-1, 1, (result.dimension, 37))


def test_the_interface_is_kept(one_of_all):
    system, states = one_of_all
    assert list(interface_problems(system, 0.3 * states[:, :16])) == []
    before = states.copy()
    system.observable(states)[:] = 0.0
    system.right_hand_side(states)
    np.testing.assert_array_equal(states, before)
    assert system.right_hand_side(states[:, :0]).shape == (system.dimension, 0)


def test_trajectories_are_independent_bit_for_bit(one_of_all):
    system, states = one_of_all
    together = integrate(system, 0.1 * states, 0.01, 4)
    for first, last in ((0, 1), (1, 8), (8, 37)):
        alone = integrate(system, 0.1 * states[:, first:last], 0.01, 4)
        np.testing.assert_array_equal(alone, together[..., first:last])
    names = ("right_hand_side", "observable", *["jacobian"] * has_own(system, "jacobian"))
    for method in (getattr(system, name) for name in names):
        whole = method(states)
        for index in (0, 11, 36):
            np.testing.assert_array_equal(method(states[:, index].copy()), whole[..., index])
            view = method(states.T.copy().T[:, index : index + 1])
            np.testing.assert_array_equal(view[..., 0], whole[..., index])
        further = method(states[:, :36].reshape(system.dimension, 2, 18))
        np.testing.assert_array_equal(further, whole[..., :36].reshape(further.shape))


def test_energy_budgets_are_closed_and_images_of_solutions_are_solutions(one_of_all):
    """A force adds its work to the input."""
    system, states = one_of_all
    rates, budget = system.right_hand_side(states), system.energy_budget(states)
    if budget is not None:
        change = (states * rates).sum(axis=0)
        np.testing.assert_allclose(budget.input - budget.dissipation, change, atol=1e-10)
    for symmetry in system.symmetries():
        image = symmetry.transform(states)
        assert not np.array_equal(image, states)
        moved = system.right_hand_side(image)
        np.testing.assert_allclose(moved, symmetry.transform(rates), atol=1e-10)


@pytest.mark.parametrize("name", sorted({*EVERY} - {"flow in a plane"}))  # it has an FFT
def test_the_jacobian_is_the_complex_step_derivative(name):
    system = EVERY[name]
    states = np.random.default_rng(1).normal(0, 3, (system.dimension, 8))
    for component in range(system.dimension):
        perturbed = states.astype(complex)
        perturbed[component] += 1e-30j
        expected = system.right_hand_side(perturbed).imag / 1e-30
        result = system.jacobian(states)[:, component]
        np.testing.assert_allclose(result, expected, rtol=1e-13, atol=1e-12)


# -- the Lorenz 96 model ---------------------------------------------------------------------------


def test_the_budget_is_of_the_forcing_and_the_damping():
    system, states = Lorenz96(7.5, 11), np.random.default_rng(4).normal(3.0, 4.0, (11, 6))
    budget = system.energy_budget(states)
    np.testing.assert_allclose(budget.input, 7.5 * states.sum(axis=0), rtol=1e-12)
    np.testing.assert_allclose(2 * 11 * system.observable(states), budget.dissipation, rtol=1e-12)
    # volumes shrink at the rate of the damping
    np.testing.assert_allclose(np.trace(system.jacobian(states)), -11.0)


def test_a_parameter_that_is_a_number_of_variables():
    assert make_system("lorenz96", {}) == Lorenz96(8.0, 40)
    system = make_system("lorenz96", {"variables": 10.0, "forcing": 9})
    assert parameters_of(system) == {"forcing": 9.0, "variables": 10}
    assert system.dimension == len(system.component_names) == 10
    assert [symmetry.order for symmetry in system.symmetries()] == [10]
    for name, value, message in (("variables", 3, "4 at least"), ("forcing", np.inf, "finite")):
        with pytest.raises(ValueError, match=f"{name} must be {message}"):
            replace(system, **{name: value})


# -- the check of a system -------------------------------------------------------------------------


def mistaken(**methods):
    return dataclass(frozen=True)(type("Mistaken", (Lorenz63,), methods))()


def wrong_jacobian(self, state):
    j = Lorenz63().jacobian(state)
    j[2, 1] = -state[0]
    return j


def mixing(self, state):
    return Lorenz63().right_hand_side(state) + 1e-3 * state.mean()


MISTAKES = [
    ("observable", lambda self, x: x[:1], r"observable returns the shape \(1, 16\)"),
    ("observable", lambda self, x: x[2] > 0, "observable returns numbers of type bool"),
    ("observable", lambda self, x: x[0] * np.nan, "observable is not finite for 16 of 16 states"),
    ("right_hand_side", lambda self, x: x[:2], r"right_hand_side returns the shape \(2, 16"),
    ("right_hand_side", lambda self, x: x[7], "right_hand_side fails .* IndexError"),
    ("right_hand_side", mixing, "differs from the same trajectory alone"),
    ("right_hand_side", lambda self, x: np.multiply(x, 2.0, out=x), "changes the states"),
    ("right_hand_side", lambda self, x: x * x, "do not stay finite"),
    ("jacobian", lambda self, x: x, r"jacobian returns the shape .* not \(3, 3, 16\)"),
    ("jacobian", wrong_jacobian, r"jacobian: the entry \[2, 1\] differs from differences"),
    ("sample_initial_states", lambda self, n, g: g.random((n, 3)), r"must .* \(3, 16\), not \(16"),
]


@pytest.mark.parametrize("number", [31, 32])
def test_sums_that_are_rounded_otherwise_alone_are_no_mistake(number):
    """NumPy sums the first axis of a lone trajectory in pairs, and of a batch row by row."""

    @dataclass(frozen=True)
    class Waves(KuramotoSivashinsky):
        wavenumbers: int = number

        def observable(self, state):
            k = np.arange(1.0, len(state) + 1).reshape((-1,) + (1,) * (state.ndim - 1))
            return (0.1 * k**2 * state**2).sum(axis=0)

    report = check_system(Waves(), np.random.default_rng(7))
    assert "observable: one trajectory alone is rounded" in report
    assert "rounded" not in check_system(KuramotoSivashinsky(), np.random.default_rng(7))


@pytest.mark.parametrize(("name", "method", "message"), MISTAKES)
def test_mistakes_are_told(name, method, message):
    jacobian = {"jacobian": DynamicalSystem.jacobian} if name == "right_hand_side" else {}
    system = mistaken(**jacobian, **{name: method}, case_defaults={})
    with pytest.raises(UnsoundError, match=message):
        check_system(system, np.random.default_rng(7))


@pytest.mark.parametrize("component", [None, 1, 3])
@pytest.mark.parametrize("perturbation", [None, 1e-3, 2.0])
def test_trajectories_begin_as_the_ensemble_of_the_system_does(component, perturbation):
    start = [1.0, -2.0, 20.0]
    begin = {"initial_state": start, "perturbed_component": component, "perturbation": perturbation}
    system = mistaken(case_defaults={"ensemble": begin})
    raised = (component or 1) - 1, perturbation or 0.01
    result, expected = (
        make(np.random.default_rng(7))
        for make in (
            lambda generator: _initial_states(system, generator),
            lambda generator: initial_states(np.array(start), *raised, 16, generator),
        )
    )
    np.testing.assert_array_equal(result, expected)


def test_the_command_line(capsys):
    assert main(["check-system", "lorenz63", "rho=28"]) == 0
    interface, integrator, derivatives = capsys.readouterr().out.splitlines()
    assert interface == "Lorenz63: keeps to the interface"
    assert integrator.endswith("Runge-Kutta scheme, compiled")
    assert "Jacobian given, within" in derivatives
    for arguments, message in (
        (["lorentz63"], "did you mean 'lorenz63'"),
        (["lorenz63", "rho"], "write NAME=VALUE"),
        (["lorenz63", "rho=28", "rho=1"], "rho is given twice: rho=28 rho=1"),
    ):
        assert main(["check-system", *arguments]) == 1
        assert message in capsys.readouterr().err


class Tempered(Lorenz63):
    """With an operation that cannot be compiled."""

    def right_hand_side(self, state):
        return super().right_hand_side(np.tanh(state / 10.0) * 10.0)


def test_what_hinders_compilation_is_named_with_its_line():
    reason = hindrance(Tempered(), 0.1)
    assert re.match(r".*test_registry.py:\d+, return super.*np.tanh.*_Symbol", reason)
    assert hindrance(Lorenz63(), 0.1) is None
