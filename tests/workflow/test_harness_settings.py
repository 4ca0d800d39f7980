"""Settings of jobs: read by their paths, and equal when they are written differently."""

import json
from collections import OrderedDict
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from burstcast_workflow.harness.canonical import canonical, canonical_json
from burstcast_workflow.harness.settings import Settings, UndeclaredSettingError

DECLARED = {
    "case.training": {"series": 10, "noise": {"level": 0.01, "kind": "white"}},
    "search.grid": 4,
    "case.actuation.parameters": {},
    "search.tikhonov": [1e-6, 1e-9],
}
IDENTITY = {"rule": "train", "case": "Re400", "forecaster": "esn-N30-RV-seed0"}


@pytest.fixture
def settings():
    return Settings(DECLARED, IDENTITY)


def test_settings_are_read_by_their_path(settings):
    assert settings["search.grid"] == 4
    assert settings["case.training"] == DECLARED["case.training"]
    assert settings["case.training.series"] == 10
    assert settings["case.training.noise.kind"] == "white"


def test_wildcards_are_there_by_their_names(settings):
    assert (settings["case"], settings["rule"]) == ("Re400", "train")
    assert settings["forecaster"] == "esn-N30-RV-seed0"


@pytest.mark.parametrize("path", ["search", "search.gri", "search.tikhonov_", "seed", "training"])
def test_what_is_not_declared_is_an_error_that_names_rule_path_and_what_is(settings, path):
    with pytest.raises(UndeclaredSettingError) as error:
        settings[path]
    assert str(error.value) == (
        f"train reads the setting {path}, which its rule does not declare; it declares: "
        "case.actuation.parameters, case.training, search.grid, search.tikhonov"
    )


def test_a_rule_that_declares_nothing():
    with pytest.raises(UndeclaredSettingError, match="it declares: none"):
        Settings({}, IDENTITY)["search.grid"]


@pytest.mark.parametrize("path", ["case.training.sereis", "case.training.noise.sigma"])
def test_what_a_declared_section_does_not_have_is_an_error(settings, path):
    with pytest.raises(KeyError):
        settings[path]


def test_what_nobody_has_read(settings):
    leaves = [
        "case.training.series",
        "case.training.noise.level",
        "case.training.noise.kind",
        "search.grid",
        "case.actuation.parameters",
        "search.tikhonov",
    ]
    assert settings.unread() == leaves
    settings["case.training.noise"]
    settings["case"]
    assert settings.unread() == [leaves[0], *leaves[3:]]
    settings["case.training.series"]
    settings["search.grid"]
    settings["case.actuation.parameters"]
    assert settings.unread() == ["search.tikhonov"]
    settings["search.tikhonov"]
    assert settings.unread() == []


def test_a_path_is_not_read_with_one_that_begins_alike():
    settings = Settings({"a.b": 1, "a.bc": 2}, IDENTITY)
    settings["a.b"]
    assert settings.unread() == ["a.bc"]


def test_what_could_not_be_read_counts_as_unread(settings):
    with pytest.raises(UndeclaredSettingError):
        settings["search"]
    assert "search.grid" in settings.unread()


def test_they_are_a_mapping_of_what_is_declared(settings):
    assert list(settings) == list(DECLARED)
    assert len(settings) == 4
    assert dict(settings) == DECLARED
    assert settings.unread() == []


# -- canonical form --------------------------------------------------------------------------------

PLAIN = st.recursive(
    st.none()
    | st.booleans()
    | st.integers(-(10**20), 10**20)
    | st.floats(allow_nan=False, allow_infinity=False)
    | st.text(max_size=5),
    lambda children: (
        st.lists(children, max_size=4) | st.dictionaries(st.text(max_size=4), children, max_size=4)
    ),
    max_leaves=15,
)


def shuffled(value):
    """The same content, written differently."""
    if isinstance(value, dict):
        return OrderedDict((key, shuffled(value[key])) for key in reversed(list(value)))
    if isinstance(value, list):
        return tuple(shuffled(item) for item in value)
    if type(value) is int and float(value) == value and abs(value) < 2**53:
        return float(value)
    return value


@given(PLAIN)
def test_same_content_has_the_same_form_text_and_representation(value):
    other = shuffled(value)
    assert canonical_json(other) == canonical_json(value)
    assert repr(canonical(other)) == repr(canonical(value))


@given(PLAIN)
def test_form_is_equal_to_the_original_and_stable(value):
    form = canonical(value)
    assert form == value
    assert repr(canonical(form)) == repr(form)
    assert json.loads(canonical_json(value)) == form


def test_different_content_has_different_text():
    texts = {canonical_json(value) for value in (1, 1.5, "1", True, None, [1], {"1": 1}, [], {})}
    assert len(texts) == 9


def test_whole_floats_become_integers_and_minus_zero_is_zero():
    assert canonical_json([1.0, -0.0, 1e3, 0.1]) == "[1, 0, 1000, 0.1]"


def test_original_is_not_shared():
    original = {"a": [1, {"b": 2}]}
    form = canonical(original)
    form["a"][1]["b"] = 3
    assert original == {"a": [1, {"b": 2}]}


@pytest.mark.parametrize(
    "value", [np.int64(3), np.float64(0.5), np.zeros(2), Path("x"), {1, 2}, b"x", 1j]
)
def test_other_types_are_refused_with_their_place(value):
    with pytest.raises(TypeError, match=r"settings\.case\.list\[1\] is .*type"):
        canonical({"case": {"list": [0, value]}})


def test_keys_must_be_text():
    with pytest.raises(TypeError, match=r"settings\.case has the key 400"):
        canonical({"case": {400: 1}})


@pytest.mark.parametrize("value", [float("nan"), float("inf"), float("-inf")])
def test_numbers_must_be_finite(value):
    with pytest.raises(ValueError, match=r"params\.a is"):
        canonical({"a": value}, "params")
