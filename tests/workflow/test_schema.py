"""The JSON Schema of configurations takes all that ship, and no other settings."""

import json
from pathlib import Path

import jsonschema
import pytest
import yaml

from burstcast_workflow.config.schema import schema

ROOT = Path(__file__).parents[2]
KEPT = ROOT / "workflow" / "schemas" / "config.schema.json"
CONFIGS = [ROOT / "config.yaml", *sorted((ROOT / "workflow" / "presets").glob("*.yaml"))]
VALIDATOR = jsonschema.Draft202012Validator(schema())


def test_the_kept_schema_is_that_of_the_model():
    VALIDATOR.check_schema(schema())
    assert json.loads(KEPT.read_text()) == schema(), "run make pages"


@pytest.mark.parametrize("path", CONFIGS, ids=lambda path: path.stem)
def test_what_ships_is_valid(path):
    found = [error.message for error in VALIDATOR.iter_errors(yaml.safe_load(path.read_text()))]
    assert found == []
    place = "workflow/" if path.parent == ROOT else "../"
    first = path.read_text().partition("\n")[0]
    assert first == f"# yaml-language-server: $schema={place}schemas/config.schema.json"


@pytest.mark.parametrize(
    "overlay",
    [
        {"horizon": {"evnts": 3}},
        {"search": {"grid": 0}},
        {"random_seed": "many"},
        {"campaign": [{"reynolds": [400], "forecasters": {"esn": {"seeds": 0}}}]},
    ],
)
def test_mistakes_are_found(overlay):
    assert not VALIDATOR.is_valid(overlay)


def test_kinds_are_a_list_or_a_mapping():
    axes = {"esn": {"neurons": [500], "validation": ["RV"], "seeds": 3}}
    for kinds, valid in [
        (["equations", axes], True),
        ({"equations": {}, **axes}, True),
        (["equatoins"], False),
        ([{"esn": {"seeds": 0}}], False),
    ]:
        assert VALIDATOR.is_valid({"campaign": [{"forecasters": kinds}]}) == valid


def test_meanings_have_units():
    search = schema()["$defs"]["Search"]["properties"]
    assert search["interval_lt"]["description"].endswith("[Lyapunov times]")
    assert "title" not in search["interval_lt"]
