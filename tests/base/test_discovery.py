"""Classes of one's own, found by their module and class for any interface."""

import importlib
import math
import sys
from dataclasses import dataclass, field
from typing import Literal, Optional

import pytest

from burstcast.base.discovery import checked_values, own_class
from burstcast.forecasters.base import Forecaster, fitted
from burstcast.forecasters.nvar import NVAR
from burstcast.forecasters.registry import all_kinds, kind_class, kind_module, kind_name, make_kind
from burstcast.systems.base import DynamicalSystem

# -- forecasters -----------------------------------------------------------------------------------

MODELS = """
from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from burstcast.forecasters.base import fitted
from burstcast.forecasters.nvar import NVAR


@dataclass(frozen=True)
class Damped(NVAR):
    rates: tuple[float, ...] = (0.5,)
    shape: Literal["round", "flat"] = "round"
    depth: int | None = None
    spare: np.ndarray = fitted()
"""


@pytest.fixture
def own_models(tmp_path, monkeypatch):
    """A module of forecasters that Python finds."""
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setattr(sys, "dont_write_bytecode", True)
    (tmp_path / "own_models.py").write_text(MODELS)
    yield importlib.import_module("own_models")
    sys.modules.pop("own_models")


def test_a_forecaster_of_ones_own_is_made_with_its_options(own_models):
    assert kind_class("own_models:Damped") is own_models.Damped
    assert kind_class(kind_name(own_models.Damped)) is own_models.Damped
    assert kind_class(kind_name(NVAR)) is NVAR
    assert (kind_module("own_models:Damped"), kind_module("nvar")) == (
        "own_models",
        "burstcast.forecasters.nvar",
    )
    assert "own_models:Damped" not in all_kinds()
    # a class that the module imports has its name there, too
    assert own_class("own_models:NVAR", Forecaster, "forecaster") is NVAR
    with pytest.raises(ValueError, match="has no class Damed; its systems are none"):
        own_class("own_models:Damed", DynamicalSystem, "system")
    options = {"lags": 3.0, "rates": [1, 2], "shape": "flat", "depth": 4}
    made = make_kind("own_models:Damped", options)
    assert made == own_models.Damped(lags=3, rates=(1.0, 2.0), shape="flat", depth=4)
    assert made.options == {**options, "ridge": 1e-6, "rates": (1.0, 2.0)}


@pytest.mark.parametrize(
    ("name", "options", "message"),
    [
        (
            "own_models:Dampd",
            {},
            r"no class Dampd \(did you mean 'Damped'\?\); its forecasters are",
        ),
        ("own_models:np", {}, r"subclass of burstcast\.forecasters\.base\.ForecasterKind"),
        ("own_models:", {}, "own_models .* has no class"),
        ("own_models:Damped", {"lags": 0}, "lags must be 1 at least, not 0"),
        (
            "own_models:Damped",
            {"rate": 1},
            r"'own_models:Damped' has no option 'rate' \(did you me",
        ),
        ("nvr", {}, r"mean 'nvar'\?\); .*; a class in a module of yours is named <module>:<class>"),
    ],
)
def test_what_is_no_forecaster_is_told(own_models, name, options, message):
    with pytest.raises(ValueError, match=message):
        make_kind(name, options)


# -- values of options -----------------------------------------------------------------------------


@dataclass(frozen=True)
class Options:
    """One option of each type."""

    count: int
    rate: float = 1.0
    bound: Optional[float] = None  # noqa: UP045
    steps: int | None = 3
    shape: Literal["round", "flat", 2] = "round"
    names: tuple[str, ...] = ()
    knots: tuple[float, ...] = field(default_factory=tuple)
    whole: bool = False
    learnt: float = fitted()


def checked(**values):
    return checked_values("kind 'a'", "option", Options, {"count": 1, **values})


@pytest.mark.parametrize(
    ("name", "given", "expected"),
    [
        ("count", 3.0, 3),
        ("rate", 2, 2.0),
        ("bound", None, None),
        ("bound", 2, 2.0),
        ("steps", None, None),
        ("steps", 4.0, 4),
        ("shape", "flat", "flat"),
        ("shape", 2, 2),
        ("names", ["x", "y"], ("x", "y")),
        ("knots", [1, 2.5], (1.0, 2.5)),
        ("whole", True, True),
    ],
)
def test_values_have_the_types_of_their_options(name, given, expected):
    value = checked(**{name: given})[name]
    assert value == expected
    assert type(value) is type(expected)
    if isinstance(expected, tuple):
        assert [type(entry) for entry in value] == [type(entry) for entry in expected]


@pytest.mark.parametrize(
    ("name", "given", "message"),
    [
        ("count", 2.5, "option 'count' of kind 'a' must be a whole number, not 2.5"),
        ("count", True, "'count' of kind 'a' must be a finite number, not True"),
        ("count", math.inf, "'count' of kind 'a' must be a finite number, not inf"),
        ("count", None, "'count' of kind 'a' must be a finite number, not None"),
        ("rate", "1", "'rate' of kind 'a' must be a finite number, not '1'"),
        ("bound", math.nan, "'bound' of kind 'a' must be a finite number, not nan"),
        ("steps", 0.5, "'steps' of kind 'a' must be a whole number, not 0.5"),
        ("shape", "square", "'shape' of kind 'a' must be round or flat or 2, not 'square'"),
        ("shape", None, "'shape' of kind 'a' must be round or flat or 2, not None"),
        ("names", "xy", "'names' of kind 'a' must be a list of texts, not 'xy'"),
        ("names", ["x", 1], "an entry of option 'names' of kind 'a' must be a text, not 1"),
        ("knots", 1.0, "'knots' of kind 'a' must be a list of numbers, not 1.0"),
        ("knots", [1, None], "an entry of option 'knots' .* must be a finite number, not None"),
        ("whole", 1, "'whole' of kind 'a' must be true or false, not 1"),
        ("learnt", 1.0, "kind 'a' has no option 'learnt'; its options are count, .*, whole$"),
    ],
)
def test_values_of_other_types_are_refused(name, given, message):
    with pytest.raises(ValueError, match=message):
        checked(**{name: given})


def test_what_has_no_default_must_be_given():
    with pytest.raises(ValueError, match="kind 'a' needs the option 'count'"):
        checked_values("kind 'a'", "option", Options, {})
    with pytest.raises(TypeError, match="dict must be a dataclass of its options"):
        checked_values("kind 'a'", "option", dict, {})
