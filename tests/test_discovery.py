"""Classes of one's own, found by their module and class for any interface."""

import sys

import pytest

import burstcast.encoders
from burstcast.discovery import module_of, own_class
from burstcast.encoders.base import Encoder
from burstcast.encoders.identity import IdentityEncoder
from burstcast.encoders.registry import available_encoders, encoder_class
from burstcast.systems.base import DynamicalSystem

OWN = """
from dataclasses import dataclass

import numpy as np
from burstcast.encoders.base import Encoder
from burstcast.encoders.identity import IdentityEncoder


@dataclass(frozen=True)
class Moduli(Encoder):
    @classmethod
    def fit(cls, training, case):
        return cls()

    @classmethod
    def channel_names(cls, case):
        return tuple(f"modulus_{name}" for name in case.components)

    def encode(self, observed):
        return np.abs(observed)


class Begun(Encoder):
    def encode(self, observed):
        return observed


LARGEST = 3
"""


@pytest.fixture
def own_moduli(tmp_path, monkeypatch):
    """The name of a module that Python finds."""
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setattr(sys, "dont_write_bytecode", True)
    (tmp_path / "own_moduli.py").write_text(OWN)
    yield "own_moduli"
    sys.modules.pop("own_moduli", None)


def test_a_class_of_ones_own_is_found_by_module_and_class(own_moduli):
    found = own_class(f"{own_moduli}:Moduli", Encoder, "encoder")
    assert found is sys.modules["own_moduli"].Moduli
    assert encoder_class(f"{own_moduli}:Moduli") is found
    # a class that the module imports has its name there, too
    assert encoder_class(f"{own_moduli}:IdentityEncoder") is IdentityEncoder
    assert "own_moduli:Moduli" not in available_encoders()


@pytest.mark.parametrize(
    ("name", "base", "noun", "message"),
    [
        ("own_modul:Moduli", Encoder, "encoder", "there is no module own_modul here or among"),
        ("own_moduli.deep:Moduli", Encoder, "encoder", r"there is no module own_moduli\.deep"),
        ("own_moduli:Modul", Encoder, "encoder", r"mean 'Moduli'\?\); its encoders are Moduli, Be"),
        ("own_moduli:Modul", DynamicalSystem, "system", "has no class Modul; its systems are none"),
        (
            "own_moduli:Moduli",
            DynamicalSystem,
            "system",
            r"own_moduli.py\) is no system: it must be a subclass of "
            r"burstcast\.systems\.base\.DynamicalSystem",
        ),
        ("own_moduli:LARGEST", Encoder, "encoder", "LARGEST of own_moduli .* is no encoder"),
        ("own_moduli:", Encoder, "encoder", "own_moduli .* has no class"),
        ("own_moduli:Begun", Encoder, "encoder", "Begun of own_moduli lacks channel_names, fit"),
    ],
)
def test_what_is_no_such_class_is_told(own_moduli, name, base, noun, message):
    with pytest.raises(ValueError, match=message):
        own_class(name, base, noun)


def test_an_unknown_kind_says_how_ones_own_are_named():
    with pytest.raises(ValueError, match=r"mean 'pod'\?\); .* is named <module>:<class>"):
        encoder_class("podd")


def test_names_of_modules():
    assert module_of("pod", burstcast.encoders) == "burstcast.encoders.pod"
    assert module_of("own_flows.encoders:Moduli", burstcast.encoders) == "own_flows.encoders"
