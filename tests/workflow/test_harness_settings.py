"""Settings of jobs: fields of classes, and equal when they are written differently."""

import json
from collections import OrderedDict
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from burstcast_workflow.harness.call import is_script, parameters
from burstcast_workflow.harness.canonical import canonical, canonical_json
from burstcast_workflow.harness.settings import (
    JobSettings,
    UndeclaredSettingError,
    at,
    concerning,
    names,
)


class Training(JobSettings):
    series: int = at("case.training", "series")
    kind: str = at("case.training", "noise", "kind")
    actuation: dict[str, float] = at("case.actuation.parameters")


class Search(Training):
    grid: int = at("search.grid")
    tikhonov: tuple[float, ...] = at("search.tikhonov", make=tuple)
    sensor: str | None = at("control.sensor", otherwise=None)


DECLARED = {
    "case.training": {"series": 10, "noise": {"level": 0.01, "kind": "white"}},
    "search.grid": 4,
    "case.actuation.parameters": {},
    "search.tikhonov": [1e-6, 1e-9],
}
IDENTITY = {"rule": "train", "case": "Re400", "forecaster": "esn-N30-RV-seed0"}


@pytest.fixture
def settings():
    return Search(DECLARED, IDENTITY)


def test_fields_have_the_values_at_their_paths_and_wildcards_their_names(settings):
    assert (settings.grid, settings.series, settings.kind) == (4, 10, "white")
    assert settings.tikhonov == (1e-6, 1e-9)
    assert settings.value_of("case.training.noise.level") == 0.01
    assert (settings.case, settings.rule) == ("Re400", "train")
    assert settings.forecaster == settings.value_of("forecaster") == "esn-N30-RV-seed0"
    # a class has the paths of its bases
    fields = ["search.grid", "search.tikhonov", "control.sensor"]
    assert Search.paths() == [*fields, "case.training", "case.actuation.parameters"]
    same = type("Same", (JobSettings,), {"grid": at("search.grid")})
    assert type("Both", (Search, same), {}).paths().count("search.grid") == 1


def test_messages_name_the_settings_as_the_config_does():
    assert names(Search.grid, Training.kind) == "search.grid, training.noise.kind"
    with pytest.raises(ValueError, match=r"^search\.grid: too fine"), concerning(Search.grid):
        raise ValueError("too fine")


def test_what_does_not_concern_a_job_is_an_error_unless_the_field_says_otherwise(settings):
    assert settings.sensor is None
    with pytest.raises(UndeclaredSettingError) as error:
        _ = Search({"search.tikhonov": [1]}, IDENTITY).grid
    assert str(error.value) == (
        "train reads the setting search.grid, which does not concern it; its settings are: "
        "search.tikhonov"
    )
    with pytest.raises(AttributeError, match=r"search\.grid is a setting"):
        settings.grid = 5  # a job changes none


@pytest.mark.parametrize(
    ("bases", "name", "value"),
    [
        ((JobSettings,), "reservoir", at("search.grid")),
        ((JobSettings,), "case", property(lambda settings: "Re400")),
        ((Search,), "grid", at("search.points")),
        ((Search,), "grid", property(lambda settings: 3)),
        ((Search, type("Other", (JobSettings,), {"grid": at("other.grid")})), "grid", None),
    ],
)
def test_a_name_means_one_thing(bases, name, value):
    with pytest.raises(TypeError, match=f"Wrong has the name {name} twice, or of a wildcard"):
        type("Wrong", bases, {name: value} if value else {})


def test_unread_names_what_nobody_has_read(settings):
    noise = ["case.training.noise.level", "case.training.noise.kind"]
    others = ["search.grid", "case.actuation.parameters", "search.tikhonov"]
    assert settings.unread() == ["case.training.series", *noise, *others]
    assert settings.case
    assert settings.value_of("case.training.noise")
    assert settings.unread() == ["case.training.series", *others]
    assert settings.series
    assert settings.grid
    assert settings.actuation == {}
    assert settings.unread() == ["search.tikhonov"]
    assert settings.tikhonov
    assert settings.unread() == []
    # a path is not read with one that begins alike
    settings = JobSettings({"a.b": 1, "a.bc": 2}, IDENTITY)
    assert settings.value_of("a.b") == 1
    assert settings.unread() == ["a.bc"]


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
def test_canonical_is_stable_and_the_same_however_content_is_written(value):
    form, other = canonical(value), shuffled(value)
    assert canonical_json(other) == canonical_json(value)
    assert repr(canonical(other)) == repr(canonical(form)) == repr(form)
    assert form == value
    assert json.loads(canonical_json(value)) == form


def test_different_content_has_different_text_and_shares_nothing():
    texts = {canonical_json(value) for value in (1, 1.5, "1", True, None, [1], {"1": 1}, [], {})}
    assert len(texts) == 9
    assert canonical_json([1.0, -0.0, 1e3, 0.1]) == "[1, 0, 1000, 0.1]"
    original = {"a": [1, {"b": 2}]}
    canonical(original)["a"][1]["b"] = 3
    assert original == {"a": [1, {"b": 2}]}


OTHER_TYPES = [np.int64(3), np.float64(0.5), np.zeros(2), Path("x"), {1, 2}, b"x", 1j]
NOT_FINITE = [float("nan"), float("inf"), float("-inf")]


@pytest.mark.parametrize(
    ("value", "error", "message"),
    [(value, TypeError, r"settings\.case\.list\[1\] is .*type") for value in OTHER_TYPES]
    + [(value, ValueError, r"settings\.case\.list\[1\] is") for value in NOT_FINITE]
    + [({400: 1}, TypeError, r"settings\.case\.list\[1\] has the key 400")],
)
def test_what_has_no_canonical_form_is_refused_with_its_place(value, error, message):
    with pytest.raises(error, match=message):
        canonical({"case": {"list": [0, value]}})
    with pytest.raises(error, match=r"^params\.a "):
        canonical({"a": value}, "params")


def test_entries_of_code_and_settings_are_told_apart_whatever_names_say():
    files = ["file:my:sub.py @12", "file:my:a = b.txt @1f"]
    texts = ['a = "b.py @12"', "scripts/x.py @3", *files, "burstcast.one @0a", "numpy ==2.0", ""]
    settings, code = parameters(texts)
    assert settings == {"a": "b.py @12"}
    assert code == sorted(["scripts/x.py @3", *files, "burstcast.one @0a"])
    assert [entry for entry in code if is_script(entry)] == ["scripts/x.py @3"]
