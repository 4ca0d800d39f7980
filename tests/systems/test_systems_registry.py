"""Systems by name, and the messages for what cannot be made."""

import math

import pytest

from burstcast.systems.lorenz63 import Lorenz63
from burstcast.systems.mfe import MoehlisFaisstEckhardt
from burstcast.systems.registry import available_systems, make_system


def test_available_systems_are_the_modules_that_define_one() -> None:
    assert available_systems() == ["lorenz63", "mfe"]


def test_make_system_with_defaults_and_integers() -> None:
    assert make_system("mfe", {"reynolds": 400}) == MoehlisFaisstEckhardt(400.0)
    assert make_system("lorenz63", {}) == Lorenz63()
    system = make_system("mfe", {"reynolds": 600.0, "length_x": 5.0})
    assert system == MoehlisFaisstEckhardt(600.0, length_x=5.0)


@pytest.mark.parametrize("name", ["base", "registry", "integration", "mfe.x", "", "os"])
def test_unknown_system(name: str) -> None:
    with pytest.raises(ValueError, match=r"unknown system .* available systems are lorenz63, mfe"):
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
