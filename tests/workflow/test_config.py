"""The model of configs, its pages and its schema, and what YAML files say."""

import copy
import json
import os
import re

import jsonschema
import pytest
from helpers_configs import PRESETS, ROOT, TINY, paper_with, put, read, records_of, tiny_with
from snakemake.cli import parse_config

from burstcast.forecasters._options import SECTIONS
from burstcast_workflow.campaign.campaign import Campaign
from burstcast_workflow.campaign.loading import ConfigError, load, misread
from burstcast_workflow.config.model import Configuration
from burstcast_workflow.config.reference import schema_of, section_of, settings
from burstcast_workflow.figures.registry import figure_names
from snakemake_logger_plugin_burstcast.config_files import unreadable_config, unwieldy

CHOICE = re.compile(r"(statistics|control)\.forecasters\.")
SCHEMA = schema_of(Configuration)
PLACES = dict(settings(SCHEMA))
# sections themselves have no default
HEADS = {name for name in PLACES if any(place.startswith(f"{name}.") for place in PLACES)}
# sections of cases that nothing is said in
UNSAID = tuple(
    f"case_defaults.{name}." for name in ("data", "training.actuation", "sensors", "encoder")
)


@pytest.fixture
def config():
    return paper_with()


def problems(config):
    with pytest.raises(ConfigError) as caught:
        load(config)
    return caught.value.problems


# -- what is shipped -------------------------------------------------------------------------------


def test_every_setting_is_described():
    assert len(PLACES) > 90
    described = lambda node: "description" in {**section_of(SCHEMA, node), **node}  # noqa: E731
    assert [name for name, node in PLACES.items() if not described(node)] == []
    assert [name for name in PLACES if name.endswith("_lt") and "unit" not in PLACES[name]] == []


def test_bounds_that_are_other_settings_exist():
    names = {name.replace("[]", "") for name in PLACES}
    relations = {name: node["relations"] for name, node in PLACES.items() if "relations" in node}
    assert len(relations) > 15
    for name, others in relations.items():
        root = "case_defaults." if name.startswith("case_defaults.") else ""
        for other in others.values():
            assert {f"{root}{factor}" for factor in other.split(" * ")} <= names


def value_at(config, name):
    """Value of a setting, and whether there is one."""
    for part in name.split("."):
        if not isinstance(config, dict) or part not in config:
            return None, False
        config = config[part]
    return config, True


def test_every_setting_has_its_default_in_one_place(config):
    """What the model has no default for stands in config.yaml, which repeats no other."""
    of_the_paper = "forecasters.esn.connectivity"
    assert value_at(config, of_the_paper)[0] == SECTIONS["esn"]().connectivity
    needed, without = [], copy.deepcopy(config)
    for name, node in PLACES.items():
        if "[" in name or CHOICE.match(name) or name in HEADS:
            continue
        value, given = value_at(config, name)
        if name.startswith(UNSAID):
            assert not given
        elif "default" not in node:
            assert given, f"config.yaml lacks {name}"
            put(without, name, "...")
            needed.append(name)
        elif given and name != of_the_paper:
            assert value != node["default"], f"{name} has a default"
    messages = problems(without)
    assert len(needed) == len(messages) > 50
    assert all(f"{name}: missing" in text for name, text in zip(needed, messages, strict=True))


def test_kinds_are_a_list_or_a_mapping(config):
    expected = load(config)
    for index, block in enumerate(config["campaign"]):
        mapping = block["forecasters"]
        listed = [kind if not axes else {kind: axes} for kind, axes in mapping.items()]
        listed[listed.index("equations")] = {"equations": None}  # - equations:
        put(config, f"campaign.{index}.forecasters", listed)
    esn = config["control"]["forecasters"]["esn"]
    put(config, "control.forecasters", [{"esn": esn}, "equations"])
    assert load(config) == expected


def test_words_of_the_command_line_are_values(config):
    """Within a mapping of --config, Snakemake gives all values as text."""
    given = parse_config(["figures={published_overlay: true, fixed_neurons: null}", "cache_gb=3"])
    assert given["figures"] == {"published_overlay": "true", "fixed_neurons": "null"}
    loaded = load(paper_with(given))
    values = {"published_overlay": True, "fixed_neurons": None}
    assert loaded == load(paper_with({"figures": values, "cache_gb": 3}))
    assert loaded != load(paper_with({"figures": {**values, "published_overlay": False}}))
    words = parse_config(["campaign=[{reynolds: [400], forecasters: {equations: {}, esn: null}}]"])
    given = {"campaign": [{"reynolds": [400], "forecasters": {"equations": {}, "esn": None}}]}
    assert load(paper_with(words)) == load(paper_with(given))
    plan = "{strategy: reactive, settings: {level: [5e-2], decision_interval_lt: [0.25]}}"
    words = parse_config([f"control={{strategies: [{plan}]}}"])
    (block,) = load(paper_with(words))["control"]["strategies"]
    assert block["settings"] == {"level": [0.05], "decision_interval_lt": [0.25]}


@pytest.mark.parametrize("reynolds", [[400, 600, 800, 1000], [400, 450.5], [500]])
def test_tiny_takes_reynolds_numbers_in_its_one_line(reynolds):
    """It has defaults of its own for all of them, and the settings of Re = 400 stay."""
    block = read(TINY)["campaign"][0]
    records = records_of(load(tiny_with({"campaign": [{**block, "reynolds": reynolds}]})))
    assert list(records) == [f"Re{number}" for number in reynolds]
    assert {record["test_series"] for record in records.values()} == {12}
    if 400 in reynolds:
        assert records["Re400"] == records_of(load(tiny_with()))["Re400"]


# -- canonical form --------------------------------------------------------------------------------


def test_places_of_results_are_read_in_one_form(config):
    for given, kept in (("./results//paper/", "results/paper"), ("//tmp/paper", "/tmp/paper")):
        put(config, "results", given)
        assert load(config)["results"] == kept


def test_the_given_config_is_left_alone_and_blocks_may_overlap(config):
    config["campaign"].append(config["campaign"][0])
    before = copy.deepcopy(config)
    records = records_of(load(config))
    assert list(records) == ["Re400", "Re600", "Re800", "Re1000"]
    records["Re400"]["ensemble"]["series"] = 1
    assert config == before


MISTAKES = {
    # of types, and unknown and missing settings
    "horizon.events": "...",
    "searsh": {},
    "random_seed": -1,
    "cases.Re400.event_threshold": "high",
    "campaign.0.forecasters.esn.sedes": 3,
    # between settings of a section, and of several
    "search.input_scaling": [2, 1],
    "horizon.lead_time_step_lt": 11,
    "control.sweep.cases": ["Re40"],
    "cases.Re600.recycle_validation": {"series": 11},
    # of lengths: a Lyapunov time of Re = 1000 has 82 steps, a series 4001 samples
    "cases.Re1000.recycle_validation": {"intervals_per_series": 30},
}


def test_all_mistakes_are_reported_at_once(config):
    """Of types, between settings and of lengths; none is of what replaces an invalid setting."""
    for name, value in MISTAKES.items():
        put(config, name, value)
    messages = problems(config)
    assert len(messages) == len(MISTAKES), messages
    for name in MISTAKES:
        case, _, setting = name.removeprefix("cases.").partition(".")
        places = [name.replace("campaign.0", "campaign[0]")], [f"case {case}", setting]
        there = [any(all(part in text for part in parts) for parts in places) for text in messages]
        assert sum(there) == 1, (name, messages)
    with pytest.raises(ConfigError, match=r"has 10 mistakes:\n  1\. .*\n  2\. .*\n  3\. "):
        load(config)


# -- keys that are there twice ---------------------------------------------------------------------


def test_duplicated_keys(config, tmp_path):
    """YAML's reader keeps the last of them and says nothing."""
    path = tmp_path / "mine.yaml"
    path.write_text(
        "horizon:\n  events: 3\n  tolerance: 0.2\n  'events': 4\n"
        "campaign:\n  - seeds: 1\n  - {seeds: 1, seeds: 2}\n"
        "horizon: {}\ncases: &all\n  Re400: {}\nother: *all\n"
    )
    shown = os.path.relpath(path)
    messages = [
        f"{shown}, line 4: the key horizon.events is there already, in line 2",
        f"{shown}, line 7: the key campaign[1].seeds is there already, in line 7",
        f"{shown}, line 8: the key horizon is there already, in line 1",
    ]
    assert misread([path, str(path)]) == messages
    assert misread([ROOT / "config.yaml", *PRESETS]) == []
    put(config, "random_seed", -1)
    with pytest.raises(ConfigError) as caught:
        load(config, [path])
    assert caught.value.problems[:3] == messages
    assert len(caught.value.problems) == 4


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("# nothing\n", ""),
        ('{\n\t"horizon": {\n\t\t"events": 3}}\n', ""),  # JSON, but not YAML
        ('{\n\t"horizon": {},\n\t"horizon": {}}\n', "the key horizon is there already"),
        ("a: [0, -1, +20, 0.5, .5, 5., 1e+3, 1.5e-3, .inf, 007.5, '010', \"6:40\", 10.5]", ""),
        ("a: &all\n  b: true\nc:\n  <<: *all\n  b: false\n", ""),
        ("a: 0400", "line 1: a is 0400, which YAML reads as 256: write"),
        ("a:\n- b: 010", "line 2: a[0].b is 010, which YAML reads as 8: write"),
        ("a: 6:40", "a is 6:40, which YAML reads as 400: write"),
        ("a: -1_000", "a is -1_000, which YAML reads as -1000: write"),
        ("a: 0x10", "a is 0x10, which YAML reads as 16: write"),
        ("a: 1:30.5", "a is 1:30.5, which YAML reads as 90.5: write"),
        ("a: !!int '010'", "a is 010, which YAML reads as 8: write"),
        ("010: a", "the key 010 is 010, which YAML reads as 8: write"),
        ("a: 2026-11-23", "a is 2026-11-23, which YAML reads as a date: quote it"),
    ],
)
def test_what_yaml_reads_otherwise_than_it_looks(config, tmp_path, text, message):
    (tmp_path / "mine").write_text(text)
    messages = misread([tmp_path / "mine"])
    assert (message in messages[0]) if message else not messages
    if message:
        with pytest.raises(ConfigError, match="mine"):
            load(config, [tmp_path / "mine"])


# -- what would take for ever ----------------------------------------------------------------------

NINE = range(1, 10)
BOMB = "a0: &a0 [1,1,1,1,1,1,1,1,1]\n" + "".join(
    f"a{n}: &a{n} [{','.join([f'*a{n - 1}'] * 9)}]\n" for n in NINE
)
MAPS = "a0: &a0 {x: 1}\n" + "".join(
    f"a{n}: &a{n} {{{','.join(f'k{k}: *a{n - 1}' for k in NINE)}}}\n" for n in NINE
)
UNWIELDY = {
    "a bomb of lists": (BOMB, "line 6: with *a4, anchors repeat over 100000 values"),
    "a bomb of mappings": (MAPS, "line 6: with *a4, anchors repeat over 100000 values"),
    "within itself": ("search: &a {grid: *a}", "line 1: *a lies within &a, which never ends"),
    "in a list": ("a: &a\n- 1\n- [*a]", "line 3: *a lies within &a, which never ends"),
    "deep": (f"a: {'[' * 60}{']' * 60}", "line 1: more than 50 levels of settings"),
    "very deep": (f"a: {'[' * 10**6}", "line 1: more than 50 levels of settings"),
    "deep mappings": (
        "".join(f"{' ' * n}a:\n" for n in range(60)),
        "line 51: more than 50 levels of settings",
    ),
    "digits": (f"random_seed: {'9' * 5000}", "line 1: a number of 5000 digits"),
}


@pytest.mark.parametrize("name", UNWIELDY)
def test_a_file_that_would_never_be_read_is_told(config, tmp_path, monkeypatch, name):
    """Before Snakemake reads it, and where the program is another one."""
    text, problem = UNWIELDY[name]
    monkeypatch.chdir(tmp_path)
    (tmp_path / "mine.yaml").write_text(text)
    with pytest.raises(ConfigError) as caught:
        load(config, ["mine.yaml"])
    assert caught.value.problems == [f"mine.yaml, {problem}"]
    assert unreadable_config(["--configfile", "mine.yaml"]) == f"mine.yaml, {problem}"


def test_ordinary_anchors_are_read(config, tmp_path):
    """Also many of them, quoted digits, and a file of ten thousand names."""
    names = ", ".join(f"run_{n}.csv" for n in range(10_000))
    text = f"x: &x [{names}]\ny: &y {{a: *x}}\nz: [*x, *y, *y]\nw: '{'9' * 5000}'\nv: *none\n"
    assert unwieldy(text.replace("v: *none\n", "")) is None
    assert unwieldy(f"a: {'[' * 49}{']' * 49}") is None
    (tmp_path / "mine.yaml").write_text(text)
    assert load(config, [tmp_path / "mine.yaml"]) == load(config)


def test_a_pipe_is_no_config(config, tmp_path):
    os.mkfifo(tmp_path / "pipe")
    for path in (tmp_path / "pipe", "/dev/zero"):
        with pytest.raises(ConfigError, match="not a file, which jobs can read again"):
            load(config, [path])
        problem = unreadable_config(["--configfile", str(path)])
        assert (
            problem == f"--configfile {path}: a pipe or a device; jobs read it, too: write a file"
        )


# -- the JSON Schema of configs --------------------------------------------------------------------

VALIDATOR = jsonschema.Draft202012Validator(SCHEMA)


def test_the_kept_schema_is_that_of_the_model():
    VALIDATOR.check_schema(SCHEMA)
    kept = ROOT / "workflow" / "schemas" / "config.schema.json"
    assert json.loads(kept.read_text()) == SCHEMA, "run make pages"


OF_THE_METHOD = {
    *("observable_and_density", "validation_strategies", "network_schematic"),
    *("prediction_schematic", "prediction_examples", "classification_scores"),
    *("horizon_schematic", "horizon_evaluations", "horizon_by_size"),
    *("hyperparameter_search", "error_growth"),
}


@pytest.mark.parametrize("path", [ROOT / "config.yaml", *PRESETS], ids=lambda path: path.stem)
def test_what_ships_is_sound_and_has_the_figures_of_the_method(path):
    assert [error.message for error in VALIDATOR.iter_errors(read(path))] == []
    paper = path.parent == ROOT
    place = "workflow/" if paper else "../"
    first = path.read_text().partition("\n")[0]
    assert first == f"# yaml-language-server: $schema={place}schemas/config.schema.json"
    loaded = load(paper_with(read(path)))
    assert loaded["results"] == f"results/{'paper' if paper else path.stem}"
    campaign = Campaign(loaded)
    # hidden_modes has no networks, whose method the figures show
    assert set(figure_names(campaign)) >= (OF_THE_METHOD if campaign.networks else set())
    assert campaign.networks or path.stem == "hidden_modes"


def test_aliases_of_aliases_are_read_once(tmp_path):
    lists = ["a0: &a0 [1, 1, 1, 1, 1, 1, 1, 1, 1, 1]"]
    lists += [f"a{n}: &a{n} [{', '.join([f'*a{n - 1}'] * 10)}]" for n in range(1, 10)]
    (tmp_path / "mine").write_text("\n".join(lists))
    assert misread([tmp_path / "mine"]) == []
