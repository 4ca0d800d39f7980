import re

import pytest
from hypothesis import given
from hypothesis import strategies as st

from burstcast.forecasters._names import ForecasterName, parsed
from burstcast.forecasters.registry import available_kinds
from burstcast_workflow.config.model import Configuration
from burstcast_workflow.config.places import Place

NAMES = st.builds(
    ForecasterName,
    st.from_regex(r"[a-z][a-z0-9_]*", fullmatch=True),
    st.none() | st.integers(0, 10**6),
    st.none() | st.from_regex(r"[A-Z]+", fullmatch=True),
    st.none() | st.integers(0, 10**6),
    st.sampled_from([None, "committee", "random"]),
)


@pytest.mark.parametrize(
    ("name", "identifier"),
    [
        (ForecasterName("equations"), "equations"),
        (ForecasterName("equations_noisy"), "equations_noisy"),
        (ForecasterName("esn", 2000, "RV", 3), "esn-N2000-RV-seed3"),
        (ForecasterName("esn", 2000, None, 0), "esn-N2000-seed0"),
        (ForecasterName("esn", 2000, "RV", 3, "random"), "esn-N2000-RV-seed3-random"),
        (ForecasterName("esn", 2000, "RV", role="committee"), "esn-N2000-RV-committee"),
    ],
)
def test_identifiers(name, identifier):
    assert name.identifier == identifier
    assert parsed(identifier) == name


@given(NAMES)
def test_identifiers_tell_everything(name):
    assert parsed(name.identifier) == name


@given(NAMES, NAMES)
def test_different_forecasters_have_different_identifiers(one, other):
    assert (one.identifier == other.identifier) == (one == other)


@pytest.mark.parametrize(
    "identifier",
    ["", "ESN", "esn-", "esn-RV-N20", "esn-N20-rv", "esn-N20-RV-seed", "esn-N20-RV-seed1x", "a/b"],
)
def test_what_is_no_identifier(identifier):
    with pytest.raises(ValueError, match=re.escape(f"{identifier!r} is no forecaster")):
        parsed(identifier)


def test_keys_of_tables():
    assert ForecasterName("esn", 20, "RV", 0).keys == {
        "forecaster": "esn",
        "neurons": 20,
        "validation": "RV",
        "seed": 0,
    }


@pytest.mark.parametrize("kind", available_kinds())
def test_every_kind_can_be_named(kind):
    assert parsed(kind) == ForecasterName(kind)


def test_the_example_of_the_config_is_an_identifier():
    place = next(
        place
        for place in Place(Configuration).settings()
        if place.name == "figures.example_forecaster"
    )
    (example,) = re.findall(r"esn-[\w-]+", place.allowed())
    assert parsed(example).identifier == example
