"""Systems by name, and the messages for what cannot be made."""

import math
import sys

import pytest

from burstcast.systems.lorenz63 import Lorenz63
from burstcast.systems.mfe import MoehlisFaisstEckhardt
from burstcast.systems.registry import available_systems, make_system, system_module


def test_available_systems_are_the_modules_that_define_one() -> None:
    assert available_systems() == ["fitzhugh_nagumo", "kolmogorov", "lorenz63", "mfe"]


def test_make_system_with_defaults_and_integers() -> None:
    assert make_system("mfe", {"reynolds": 400}) == MoehlisFaisstEckhardt(400.0)
    assert make_system("lorenz63", {}) == Lorenz63()
    system = make_system("mfe", {"reynolds": 600.0, "length_x": 5.0})
    assert system == MoehlisFaisstEckhardt(600.0, length_x=5.0)


@pytest.mark.parametrize("name", ["base", "registry", "integration", "mfe.x", "", "os"])
def test_unknown_system(name: str) -> None:
    with pytest.raises(ValueError, match="available systems are fitzhugh_nagumo, kol"):
        make_system(name, {})


def test_misspelt_names_are_answered_with_the_nearest() -> None:
    with pytest.raises(ValueError, match="did you mean 'lorenz63'"):
        make_system("lorentz63", {})
    with pytest.raises(ValueError, match=r"no parameter 'reynold' \(did you mean 'reynolds'\?\)"):
        make_system("mfe", {"reynold": 400.0})


def test_missing_parameter() -> None:
    with pytest.raises(ValueError, match="needs the parameter 'reynolds'"):
        make_system("mfe", {"length_x": 5.0})


@pytest.mark.parametrize("bad", [math.nan, math.inf, "400", True, None, [400.0]])
def test_values_that_are_no_finite_numbers(bad: object) -> None:
    with pytest.raises(ValueError, match="'reynolds' of system 'mfe' must be a finite number"):
        make_system("mfe", {"reynolds": bad})  # type: ignore[dict-item]


def test_the_system_itself_rejects_values() -> None:
    with pytest.raises(ValueError, match="reynolds must be positive"):
        make_system("mfe", {"reynolds": -400.0})


# -- systems of one's own --------------------------------------------------------------------------

OWN = """
from dataclasses import dataclass
from typing import ClassVar
from burstcast.systems.base import DynamicalSystem

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

    def write(text: str, name: str = "own_circles") -> None:
        path = tmp_path / f"{name}.py"
        path.parent.mkdir(exist_ok=True)
        path.write_text(text)

    before = set(sys.modules)
    yield write
    for name in set(sys.modules) - before:
        if name.startswith("own_"):
            del sys.modules[name]


def test_a_system_of_ones_own(module) -> None:
    module(OWN)
    system = make_system("own_circles:Circle", {"rate": 2})
    assert (system.dimension, system.rate) == (2, 2.0)  # type: ignore[attr-defined]
    with pytest.raises(ValueError, match=r"no parameter 'rat' \(did you mean 'rate'\?\)"):
        make_system("own_circles:Circle", {"rat": 2})


def test_a_system_in_a_package_of_ones_own(module) -> None:
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
        (
            "rate: float = 1.0",
            "rate: list = []",
            "own_circles:Circle",
            r"circles\.py, line 6: V",
        ),
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
def test_a_mistake_in_a_module_is_told(module, old, new, name, message) -> None:
    assert old in OWN
    module(OWN.replace(old, new, 1) if old else OWN)
    with pytest.raises((ValueError, TypeError), match=message):
        make_system(name, {})


def test_one_broken_module_spoils_no_other(monkeypatch, tmp_path) -> None:
    """A module of the package with a mistake, beside those that have none."""
    import burstcast.systems

    (tmp_path / "broken.py").write_text("def right_hand_side(:")
    (tmp_path / "unfinished.py").write_text(OWN.replace("def observable", "def observed"))
    monkeypatch.setattr(burstcast.systems, "__path__", [*burstcast.systems.__path__, str(tmp_path)])
    assert make_system("lorenz63", {}) == Lorenz63()
    assert available_systems() == ["fitzhugh_nagumo", "kolmogorov", "lorenz63", "mfe"]
    with pytest.raises(
        ValueError, match=r"did you mean 'lorenz63'\?\); the available systems are f"
    ):
        make_system("lorenz36", {})
    with pytest.raises(ValueError, match=r"broken\.py, line 1: SyntaxError"):
        make_system("broken", {})
    with pytest.raises(ValueError, match=r"class Circle of .*unfinished lacks observable"):
        make_system("unfinished", {})


def test_a_module_of_the_package_defines_one_system(monkeypatch, tmp_path) -> None:
    import burstcast.systems

    second = OWN[OWN.index("@dataclass") :].replace("Circle", "Square")
    (tmp_path / "several.py").write_text(OWN + second)
    monkeypatch.setattr(burstcast.systems, "__path__", [*burstcast.systems.__path__, str(tmp_path)])
    with pytest.raises(TypeError, match="must define one system, not several: Circle, Square"):
        make_system("several", {})
