"""Settings of jobs: fields of classes, and equal when they are written differently."""

import json
from collections import OrderedDict
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from burstcast_workflow.harness.call import is_script
from burstcast_workflow.harness.canonical import canonical, canonical_json
from burstcast_workflow.harness.settings import (
    JobSettings,
    UndeclaredSettingError,
    at,
    computed,
    concerning,
    names,
    undeclared,
)


class Training(JobSettings):
    series: int = at("case.training.series")
    kind: str = at("case.training.noise.kind")
    actuation: dict[str, float] = at("case.actuation.parameters")


class Clock(JobSettings):
    steps: int = computed("time_unit.steps_per_lyapunov_time")


class Search(JobSettings):
    training: Training
    clock: Clock
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
    assert (settings.grid, settings.training.series, settings.training.kind) == (4, 10, "white")
    assert settings.tikhonov == (1e-6, 1e-9)
    assert settings.value_of("case.training.noise.level") == 0.01
    assert (settings.case, settings.rule) == ("Re400", "train")
    assert settings.forecaster == settings.value_of("forecaster") == "esn-N30-RV-seed0"
    # a class has the paths of its parts, each once
    fields = ["search.grid", "search.tikhonov", "control.sensor"]
    assert {*Search.paths()} == {*fields, *Training.paths()}
    assert {*Training.paths()} == {
        *("case.training.series", "case.training.noise.kind", "case.actuation.parameters")
    }

    class Both(JobSettings):
        search: Search
        training: Training

    assert sorted(Both.paths()) == sorted(Search.paths())
    assert Both(DECLARED, IDENTITY).training.case == "Re400"


def test_computed_values_are_read_from_the_inputs_of_the_rule(tmp_path):
    file = tmp_path / "time_unit.json"
    file.write_text('{"steps_per_lyapunov_time": 61}')
    settings = Search(DECLARED, IDENTITY, files={"time_unit": str(file)})
    assert (settings.clock.steps, Search.files(), Training.files()) == (61, ["time_unit"], [])
    lacking = r"train reads time_unit\.steps_per_lyapunov_time, and no input is called time_unit"
    with pytest.raises(UndeclaredSettingError, match=lacking):
        _ = Search(DECLARED, IDENTITY).clock.steps


def test_a_section_covers_what_lies_in_it_and_nothing_that_begins_alike():
    assert undeclared(["a", "b.c"], ["a.x", "b.c", "b.c.d", "a"]) == []
    assert undeclared(["a", "b.c"], ["ab", "b", "b.cd"]) == ["ab", "b", "b.cd"]


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


@pytest.mark.parametrize("name", ["case", "reservoir", "provenance", "paths"])
def test_no_field_has_the_name_of_a_wildcard_or_of_what_all_settings_have(name):
    message = rf"Wrong\.{name} has a name of all settings of jobs"
    for fields in ({"__annotations__": {name: str}}, {name: at("search.grid")}):
        with pytest.raises(TypeError, match=message):
            type("Wrong", (JobSettings,), fields)


def test_parts_may_be_annotated_by_their_names_and_a_field_replaces_one_of_its_name():
    named = type(
        "Named", (JobSettings,), {"__annotations__": {"clock": "Clock"}, "__module__": __name__}
    )
    assert named.files() == ["time_unit"]
    other = type("Other", (Training,), {"kind": at("case.kind")})
    assert {*other.paths()} == {*Training.paths(), "case.kind"} - {"case.training.noise.kind"}


def test_fields_of_jobs_are_not_set(settings):
    for change, message in (
        (lambda: setattr(settings.clock, "steps", 3), "computed by another job"),
        (lambda: setattr(settings, "clock", 3), "Clock is a part"),
    ):
        with pytest.raises(AttributeError, match=message):
            change()
    with pytest.raises(UndeclaredSettingError, match=r"case\.training has no length"):
        settings.value_of("case.training.length")


def test_unread_names_what_nobody_has_read(settings):
    noise = ["case.training.noise.level", "case.training.noise.kind"]
    others = ["search.grid", "case.actuation.parameters", "search.tikhonov"]
    assert settings.unread() == ["case.training.series", *noise, *others]
    assert settings.case
    assert settings.value_of("case.training.noise")
    assert settings.unread() == ["case.training.series", *others]
    assert settings.training.series
    assert settings.grid
    assert settings.training.actuation == {}
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


def test_a_script_is_told_from_modules_and_from_files_that_these_read():
    code = ["scripts/x.py", "file:my:sub.py", "burstcast.one", "library:numpy"]
    assert [name for name in code if is_script(name)] == ["scripts/x.py"]
