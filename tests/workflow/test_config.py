import copy
import os
import re
from pathlib import Path

import numpy as np
import pytest
import yaml
from pydantic_core import PydanticUndefined
from snakemake.utils import update_config

from burstcast.forecasters._options import DEFAULTS
from burstcast.systems.lorenz63 import Lorenz63
from burstcast_workflow.campaign.campaign import Campaign
from burstcast_workflow.config import reference
from burstcast_workflow.config.cases import block_cases, case_name, case_of
from burstcast_workflow.config.lengths import few_points
from burstcast_workflow.config.loading import ConfigError, load, misread
from burstcast_workflow.config.model import Block, Configuration
from burstcast_workflow.config.places import Place
from burstcast_workflow.harness.canonical import canonical, canonical_json
from burstcast_workflow.jobs.data import check_kept_series

ROOT = Path(__file__).parents[2]
CHOICE = re.compile(r"(statistics|control)\.forecasters\.")
WINDOWS = {"prediction_time_lt": [1], "window_lt": [1]}
SEVEN = {"esn": {"neurons": [7]}}
FREE = {"trained_on": [], "actuation": None}
PRESETS = sorted((ROOT / "workflow" / "presets").glob("*.yaml"))


def read(path: Path) -> dict:
    return yaml.safe_load(path.read_text(encoding="utf-8"))


@pytest.fixture
def config():
    """The campaign of the paper, as Snakemake reads it."""
    return read(ROOT / "config.yaml")


def case_records(loaded):
    """All settings of each case, as plain data."""
    return {name: case.dump() for name, case in Campaign(loaded).cases.items()}


def put(config, name, value):
    """Change one setting, ``campaign.0.reynolds``."""
    *parents, last = [int(part) if part.isdigit() else part for part in name.split(".")]
    place = config
    for parent in parents:
        place = place[parent] if isinstance(place, list) else place.setdefault(parent, {})
    place[last] = value


def networks(neurons):
    """Forecasters of a block: one network."""
    return {"esn": {"neurons": [neurons], "validation": ["RV"], "seeds": 1}}


def problems(config):
    with pytest.raises(ConfigError) as caught:
        load(config)
    return caught.value.problems


def reactive(**changes):
    """A block of strategies of control."""
    settings = {"level": [0.05], "decision_interval_lt": [0.25]}
    return {"strategy": "reactive", "settings": settings, **changes}


def voting(vote_share=(), **changes):
    """A block of strategies of control in which networks vote."""
    shares = {"vote_share": list(vote_share)} if vote_share else {}
    settings = {"horizon_lt": [2], "decision_interval_lt": [0.25], **shares}
    block = {"strategy": "receding_horizon", "settings": settings, "forecasters": {"esn": {}}}
    return {**block, **changes}


def only_problem(config):
    (problem,) = problems(config)
    return problem


# -- what is shipped -------------------------------------------------------------------------------


def test_every_setting_is_described():
    places = list(Place(Configuration).settings())
    assert len(places) > 90
    assert [place.name for place in places if not place.meaning] == []
    undescribed = [place.name for place in places if place.name.endswith("_lt") and not place.unit]
    assert undescribed == []


def test_bounds_that_are_other_settings_exist():
    names = {place.name.replace("[]", "") for place in Place(Configuration).settings()}
    for place in Place(Configuration).settings():
        in_case = place.name.startswith("case_defaults.") and place.relations
        root = "case_defaults." if in_case else ""
        for others in place.relations.values():
            assert {f"{root}{other}" for other in others.split(" * ")} <= names


def value_at(config, name):
    """Value of a setting, and whether there is one."""
    for part in name.split("."):
        if not isinstance(config, dict) or part not in config:
            return None, False
        config = config[part]
    return config, True


def test_every_setting_has_its_default_in_one_place(config):
    """What the model has no default for stands in config.yaml, which repeats no other."""
    of_the_paper = {"forecasters.esn.connectivity", "forecasters.esn.input_bias"}
    for place in Place(Configuration).settings():
        if "[" in place.name or CHOICE.match(place.name) or place.fields:
            continue
        value, said = value_at(config, place.name)
        unsaid = tuple(
            f"case_defaults.{one}." for one in ("data", "training.actuation", "sensors", "encoder")
        )
        if place.name.startswith(unsaid):  # sections that nothing is said in
            assert not said
        elif place.default is PydanticUndefined:
            assert said, f"config.yaml lacks {place.name}"
            changed = copy.deepcopy(config)
            parent, last = place.name.rpartition(".")[::2]
            del (value_at(changed, parent)[0] if parent else changed)[last]
            assert f"{place.name} is missing" in only_problem(changed)
        elif said and place.name not in of_the_paper:
            assert value != place.default, f"{place.name} has a default"
    for name in of_the_paper:
        section, key = name.split(".")[1:]
        assert value_at(config, name)[0] == DEFAULTS[section][key]


def test_choices_of_forecasters_may_leave_kinds_and_axes_out(config):
    for section in ("statistics", "control"):
        put(config, f"{section}.forecasters", {})
    load(config)
    for section in ("statistics", "control"):
        put(config, f"{section}.forecasters", {"esn": {}})
    load(config)


def test_kinds_are_a_list_or_a_mapping(config):
    expected = load(config)
    for index, block in enumerate(config["campaign"]):
        mapping = block["forecasters"]
        listed = [kind if not axes else {kind: axes} for kind, axes in mapping.items()]
        listed[listed.index("equations")] = {"equations": None}  # - equations:
        put(config, f"campaign.{index}.forecasters", listed)
    put(
        config,
        "control.forecasters",
        [{"esn": config["control"]["forecasters"]["esn"]}, "equations"],
    )
    assert load(config) == expected
    for wrong, words in [
        (["equations", "equatoins"], "campaign[0].forecasters.equatoins; did you mean equations"),
        (["equations", {"equations": {}}], "campaign[0].forecasters has equations twice"),
        ([["equations"]], "campaign[0].forecasters has ['equations']; each kind is a name"),
        (["esn"], "campaign[0].forecasters.esn.neurons is missing"),
        ("esn", "campaign[0].forecasters is the text 'esn'; it must be a list of kinds, or a map"),
    ]:
        put(config, "campaign.0.forecasters", wrong)
        with pytest.raises(ConfigError) as error:
            load(config)
        assert words in str(error.value)


def test_the_reference_tells_what_holds_where_config_yaml_says_nothing(config):
    defaults = {
        "statistics.forecasters.esn.neurons": "`[]`",
        "control.strategies[].starts": '`"quiet"`',
        "control.strategies[].strategy": "required",
        "campaign": "see config.yaml",
        "random_seed": "`2022`",
    }
    lines = reference.text(config).splitlines()
    for name, default in defaults.items():
        (line,) = (line for line in lines if line.startswith(f"| `{name}` |"))
        assert line.split(" | ")[3] == default


def test_the_reference_keeps_code_as_it_is(config):
    text = reference.text(config)
    assert "`<case>-training<k>`" in text
    assert "the case Re&lt;value> of" in text


def test_the_reference_of_all_settings_is_up_to_date():
    """Made by: burstcast settings > docs/settings.md."""
    written = (ROOT / "docs" / "settings.md").read_text(encoding="utf-8")
    assert written == reference.text(read(ROOT / "config.yaml"))


def test_campaign_of_the_paper(config):
    loaded = load(config)
    records = case_records(loaded)
    assert list(records) == ["Re400", "Re600", "Re800", "Re1000"]
    for reynolds, exponent, series in (
        (400, 0.0163, 150),
        (600, 0.0135, 300),
        (800, 0.0126, 300),
        (1000, 0.0121, 300),
    ):
        record = records[f"Re{reynolds}"]
        assert record["parameters"]["reynolds"] == reynolds
        assert record["lyapunov"]["published_exponent"] == exponent
        assert record["lyapunov"]["time_unit"] == "published"
        assert record["test_series"] == series
        assert record["training"] == {**FREE, "series": 10, "noise": 0.01}
    assert records["Re400"]["recycle_validation"] == {"series": 3, "intervals_per_series": 30}
    assert records["Re800"]["recycle_validation"] == {"series": 4, "intervals_per_series": 22}


@pytest.mark.parametrize("path", PRESETS, ids=lambda path: path.stem)
def test_presets_are_sound(config, path):
    update_config(config, read(path))  # as Snakemake does
    assert load(config)["results"] == f"results/{path.stem}"


# -- canonical form --------------------------------------------------------------------------------


def test_writing_a_config_differently_changes_nothing(config):
    other = copy.deepcopy(config)
    other = dict(reversed(other.items()))
    put(other, "random_seed", 2022.0)
    put(other, "horizon.longest_lead_time_lt", 10.0)
    put(other, "results", "./results//paper/")
    assert canonical_json(load(other)) == canonical_json(load(config))
    put(other, "results", "//tmp/paper")
    assert load(other)["results"] == "/tmp/paper"


def test_the_given_config_is_left_alone(config):
    before = copy.deepcopy(config)
    case_records(load(config))["Re400"]["ensemble"]["series"] = 1
    assert config == before


# -- cases -----------------------------------------------------------------------------------------


def test_reynolds_numbers_name_their_cases():
    assert [case_name(value) for value in (400, 400.0, 412.5, 1234567)] == [
        "Re400",
        "Re400",
        "Re412.5",
        "Re1234567",
    ]
    block = {"reynolds": [400, 600], "cases": ["mine", "Re400"], "forecasters": {}}
    assert block_cases(Block.model_validate(block)) == ["Re400", "Re600", "mine"]


def test_a_reynolds_number_needs_no_entry(config):
    put(config, "campaign.1.reynolds", [412.5, 600])
    records = case_records(load(config))
    assert records["Re412.5"]["parameters"]["reynolds"] == 412.5
    assert records["Re412.5"]["test_series"] == 300


def test_records_merge_mappings_and_replace_the_rest(config):
    config["cases"]["Re400"] = {
        "ensemble": {"series": 1000, "initial_state": [0, 1, 2]},
        "parameters": {"length_x": 1},
    }
    record = case_of(Configuration.model_validate(config), "Re400").dump()
    assert record["ensemble"]["series"] == 1000
    assert record["ensemble"]["initial_state"] == [0, 1, 2]
    assert record["ensemble"]["time_step"] == 0.25
    assert record["parameters"] == {"length_x": 1, "length_z": 6.283185307179586, "reynolds": 400}


def lorenz() -> dict:
    return {
        "system": "lorenz63",
        "parameters": {"rho": 28},
        "event_threshold": 40,
        "laminarisation_threshold": None,
        "ensemble": {
            "initial_state": [1, 1, 20],
            "perturbed_component": 1,
            "time_step": 0.01,
            "sampling_stride": 2,
            "transient": 20,
            "duration": 80,
        },
        "lyapunov": {"published_exponent": 0.9, "orthonormalisation_interval": 0.1},
        "density": {"range": [0, 50]},
        "actuation": None,
        "recycle_validation": {"intervals_per_series": 10},
    }


def laid_over(base, overlay):
    """Mappings merged, all else replaced, as Snakemake does with configs."""
    merged = copy.deepcopy(base)
    update_config(merged, overlay)
    return merged


@pytest.mark.parametrize("path", [None, *PRESETS], ids=lambda path: path.stem if path else "paper")
def test_cases_of_the_shear_flow_are_case_defaults_and_their_entry(config, path):
    if path is not None:
        update_config(config, read(path))
    for name, record in case_records(load(config)).items():
        if record["system"] != "mfe":
            continue
        # those of other training series have the record of the case they are chosen for
        name = name.partition("-training")[0]
        unsaid = {
            "files": None,
            "data": None,
            "sensors": None,
            "encoder": None,
            "lyapunov": {"published_exponent": None},
            "actuation": {"force": None},
            "training": {"trained_on": [], "actuation": None},
        }
        expected = laid_over(unsaid, config["case_defaults"])
        expected = laid_over(expected, config["cases"].get(name, {}))
        if re.fullmatch(r"Re[0-9.]+", name):
            expected["parameters"]["reynolds"] = float(name.removeprefix("Re"))
        if expected["training"]["actuation"] is not None:
            defaults = {"strength": 1, "tested": False}
            expected["training"]["actuation"] = {**defaults, **expected["training"]["actuation"]}
        assert record == canonical(expected)


def test_a_case_of_another_system_starts_from_what_its_class_says(config):
    """Independent of the code: all that a Lorenz case has, written down by hand."""
    config["cases"]["lorenz"] = {"system": "lorenz63", "training": {"series": 7}}
    config["campaign"].append({"cases": ["lorenz"], "forecasters": networks(100)})
    assert case_records(load(config))["lorenz"] == {
        "system": "lorenz63",
        "files": None,
        "parameters": {},
        "event_threshold": 40,
        "laminarisation_threshold": None,
        "ensemble": {
            "series": 2000,
            "initial_state": [1, 1, 20],
            "perturbed_component": 3,
            "perturbation": 5,
            "time_step": 0.01,
            "sampling_stride": 2,
            "transient": 20,
            "duration": 80,
        },
        "lyapunov": {
            "time_unit": "published",
            "published_exponent": None,
            "series": 400,
            "orthonormalisation_interval": 0.2,
            "perturbation": 1e-8,
            "saturation": 0.01,
        },
        "training": {**FREE, "series": 7, "noise": 0.01},
        "density": {"bins": 200, "range": [0, 50]},
        "fixed_point": {"variation": 0.1, "above": 0},
        "controlled_density": {"bins": 100, "range": [0, 50]},
        "actuation": None,
        "test_series": 300,
        "recycle_validation": {"series": 4, "intervals_per_series": 22},
        "data": None,
        "sensors": None,
        "encoder": None,
    }


def silent_lorenz(monkeypatch, **said):
    """Let the Lorenz system say this of its cases, and nothing else."""
    monkeypatch.setattr(Lorenz63, "case_defaults", said)


def test_what_nobody_says_is_asked_for_in_one_message(config, monkeypatch):
    silent_lorenz(monkeypatch, event_threshold=40, ensemble={"time_step": 0.01})
    config["cases"]["mine"] = {"system": "lorenz63", "ensemble": {"sampling_stride": 2}}
    config["campaign"].append({"cases": ["mine"], "forecasters": networks(100)})
    assert only_problem(config) == (
        "case mine: ensemble.initial_state, ensemble.perturbed_component, ensemble.perturbation, "
        "ensemble.transient, ensemble.duration, density.range, fixed_point, "
        "controlled_density.range are missing: the class Lorenz63 says nothing of them in its "
        "case_defaults, and config.yaml's are in units of another system; say them in "
        "cases.mine"
    )


def test_what_follows_from_other_settings_need_not_be_said(config, monkeypatch):
    silent_lorenz(monkeypatch)
    entry = lorenz()
    entry["density"]["range"] = [-20, 30]
    entry["ensemble"]["perturbation"] = 0.5
    for name in ("laminarisation_threshold", "actuation"):
        del entry[name]
    del entry["lyapunov"]["orthonormalisation_interval"]
    config["cases"]["lorenz"] = entry
    config["campaign"].append({"cases": ["lorenz"], "forecasters": networks(100)})
    record = case_records(load(config))["lorenz"]
    assert record["fixed_point"] == {"variation": 0.5, "above": -20}
    assert record["controlled_density"] == {"bins": 100, "range": [-20, 30]}
    assert record["lyapunov"]["orthonormalisation_interval"] == pytest.approx(0.1)
    assert (record["laminarisation_threshold"], record["actuation"]) == (None, None)


def test_an_actuation_of_another_system_has_the_lyapunov_times_of_config_yaml(config):
    config["cases"]["lorenz"] = {"system": "lorenz63", "actuation": {"parameters": {"rho": 20}}}
    config["campaign"].append({"cases": ["lorenz"], "forecasters": networks(100)})
    assert case_records(load(config))["lorenz"]["actuation"] == {
        "parameters": {"rho": 20},
        "force": None,
        "start_lt": -1,
        "duration_lt": 1.5,
    }


def a_lorenz_case(config, **entry):
    config["cases"]["lorenz"] = {"system": "lorenz63", **entry}
    config["campaign"].append({"cases": ["lorenz"], "forecasters": networks(100)})


def test_a_system_that_draws_initial_states_needs_none(config, monkeypatch):
    said = {**Lorenz63.case_defaults}
    said["ensemble"] = {
        key: value
        for key, value in said["ensemble"].items()
        if key not in ("initial_state", "perturbed_component", "perturbation")
    }
    silent_lorenz(monkeypatch, **said)
    draw = lambda self, series, generator: generator.random((3, series))  # noqa: E731
    monkeypatch.setattr(Lorenz63, "sample_initial_states", draw)
    a_lorenz_case(config)
    ensemble = case_records(load(config))["lorenz"]["ensemble"]
    names = ("initial_state", "perturbed_component", "perturbation")
    assert [ensemble[name] for name in names] == [None, None, None]


@pytest.mark.parametrize(
    ("ensemble", "part"),
    [
        ({"initial_state": None}, "the system lorenz63 draws no initial states: give one"),
        ({"perturbation": None}, "are needed beside ensemble.initial_state"),
        ({"initial_state": []}, "ensemble.initial_state has 0 numbers"),
    ],
)
def test_initial_states_that_are_incomplete(config, ensemble, part):
    a_lorenz_case(config, ensemble=ensemble)
    assert part in only_problem(config)


def test_files_belong_to_a_system_of_ones_own(config):
    a_lorenz_case(config, files=["table.csv"])
    assert only_problem(config) == (
        "case lorenz: files belong to a system of your own (<module>:<class>): leave them out"
    )


def test_a_force_needs_a_right_hand_side(config, monkeypatch):
    monkeypatch.setattr(Lorenz63, "flow_map", lambda self, state, time_step: state)
    a_lorenz_case(config, actuation={"force": [1, 0, 0]})
    assert only_problem(config) == (
        "case lorenz: actuation: a force is added to a right-hand side, but Lorenz63 has an "
        "integrator of its own: let the actuation change a parameter"
    )


def test_mistakes_in_what_a_class_says(config, monkeypatch):
    silent_lorenz(monkeypatch, event_treshold=40, density={"range": [5, 1]})
    config["cases"]["lorenz"] = {"system": "lorenz63"}
    config["campaign"].append({"cases": ["lorenz"], "forecasters": networks(100)})
    problem = only_problem(config)
    assert problem.startswith("case_defaults of the class Lorenz63 (system lorenz63): ")
    assert "unknown setting event_treshold; did you mean event_threshold?" in problem
    assert "density.range is [5, 1]; the first number must be below the second" in problem
    silent_lorenz(monkeypatch, event_threshold=np.float64(40))
    assert "event_threshold is np.float64(40.0) of type numpy.float64" in only_problem(config)


@pytest.mark.parametrize(
    ("value", "part"),
    [
        ("high", "is the text 'high'; it must be a number, or {quantile:"),
        ({"quantile": 1}, "is the quantile 1; a quantile lies between 0 and 1"),
        ({"quantil": 0.9}, "it must be a number, or {quantile:"),
        ({"quantile": 0.9, "of": 1}, "it must be a number, or {quantile:"),
        (None, "it must be a number, or {quantile:"),
        (True, "it must be a number, or {quantile:"),
        (float("inf"), "must be a finite number"),
    ],
)
def test_event_thresholds_are_numbers_or_quantiles(config, value, part):
    put(config, "cases.Re400.event_threshold", value)
    problem = only_problem(config)
    assert problem.startswith("cases.Re400.event_threshold is ")
    assert part in problem


def test_another_system_is_one_more_case(config):
    config["cases"]["lorenz"] = lorenz()
    config["campaign"].append({"cases": ["lorenz"], "forecasters": networks(100)})
    record = case_records(load(config))["lorenz"]
    assert record["parameters"] == {"rho": 28}  # nothing of the shear flow's
    assert record["laminarisation_threshold"] is None


def test_a_case_without_published_exponent_is_checked_later(config):
    config["cases"]["lorenz"] = lorenz()
    put(config, "cases.lorenz.lyapunov.published_exponent", None)
    put(config, "cases.lorenz.recycle_validation.intervals_per_series", 10**6)
    config["campaign"].append({"cases": ["lorenz"], "forecasters": networks(100)})
    load(config)


def test_cases_that_the_campaign_leaves_out_are_not_looked_at(config):
    put(config, "cases.Re1000.recycle_validation", {"intervals_per_series": 10**6})
    assert "case Re1000: recycle_validation.intervals_per_series" in only_problem(config)
    put(config, "campaign.1.reynolds", [600])
    load(config)


# -- mistakes that the model finds -----------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "value", "parts"),
    [
        ("horizon.evnts", 3, ["unknown setting horizon.evnts", "did you mean events?"]),
        (
            "seeds",
            1,
            [
                "unknown setting seeds",
                "campaign[].forecasters.esn.seeds or ",
                "campaign[].forecasters.esn_true_washout.seeds or ",
                "campaign[].forecasters.esn_aware.seeds or ",
                "control.sweep.seeds or ",
                "control.strategies[].seeds?",
            ],
        ),
        ("search.washout_lt", 1, ["unknown setting search.washout_lt", "did you mean washout_lt?"]),
        ("network", {}, ["unknown setting network"]),
        ("cases.Re400.lyapunov.xyz", 1, ["cases.Re400.lyapunov.xyz", "known are time_unit"]),
        ("horizon.events", 0, ["horizon.events is 0", "whole number not below 1", "(number of"]),
        ("horizon.events", 1.5, ["horizon.events is 1.5", "a whole number"]),
        ("horizon.events", True, ["horizon.events is true", "a whole number"]),
        ("horizon.events", None, ["horizon.events is empty", "a whole number"]),
        ("search.grid", "4", ["search.grid is the text '4'", "write 4 without quotes"]),
        ("search.tikhonov", ["1e-6"], ["search.tikhonov[0]", "write 1.0e-6"]),
        ("horizon.tolerance", "2.5e3", ["horizon.tolerance", "write 2.5e+3"]),
        ("horizon.tolerance", "none", ["horizon.tolerance is the text 'none'", "above 0"]),
        ("forecasters.esn.backend", "fortran", ["forecasters.esn.backend", "compiled or scipy"]),
        ("washout_lt", -1, ["washout_lt is -1", "[Lyapunov times]"]),
        ("search.input_scaling", [1], ["search.input_scaling is [1]", "[low, high]"]),
        ("campaign.0.forecasters.esn.neurons", [500, 500], ["esn.neurons has 500 twice"]),
        (
            "campaign.0.forecasters.esn.neurons",
            [],
            ["[0].forecasters.esn.neurons is []", "least 1"],
        ),
        ("campaign.0.forecasters.esn.validation", ["XV"], ["esn.validation[0]", "RV", "SSV"]),
        ("campaign.0.forecasters.esn.seeds", 0, ["campaign[0].forecasters.esn.seeds is 0"]),
        ("campaign.0.forecasters.ens", {}, ["campaign[0].forecasters.ens", "did you mean esn?"]),
        ("campaign.0.forecasters.equations", {"seeds": 2}, ["forecasters.equations.seeds"]),
        ("control.forecasters.network", {}, ["unknown setting control.forecasters.network"]),
        ("statistics.forecasters", None, ["statistics.forecasters is empty", "a mapping"]),
        ("control.random_alarms", 1, ["control.random_alarms is 1", "true or false"]),
        ("figures.example_forecaster", "RV-seed0", ["example_forecaster", "esn-N2000-RV-seed0"]),
        ("figures.example_forecaster", "equations", ["example_forecaster", "name of a network"]),
        ("case_defaults.parameters", {"reynolds": "x"}, ["case_defaults.parameters.reynolds"]),
        ("case_defaults.ensemble", [], ["case_defaults.ensemble is []", "a mapping"]),
        ("forecasters.esn", None, ["forecasters.esn is empty", "a mapping of settings"]),
        ("results", "", ["results is the text ''", "path of a directory"]),
        ("results", "README.md", ["results is README.md, which is a file"]),
        ("campaign.0.forecasters.esn.seeds", 10**8, ["seeds is 100000000", "not above 10000"]),
        ("case_defaults.ensemble.series", 10**10, ["series is 10000000000", "not above 1000000"]),
        ("results", "a{b}", ["results is the text 'a{b}'", "without braces"]),
        *(("results", path, ["of their own"]) for path in (".", "..", "/", "a/..", "./", "../../")),
        ("results", False, ["results is false", "YAML reads yes, no, on and off as"]),
        ("results", "~/x", ["results is the text '~/x'", "a leading ~"]),
        ("cases.tables", {}, ["cases.tables: the name must be"]),
        ("cases.nan", {}, ["cases.nan: the name must be"]),
        ("cases.1a", {}, ["cases.1a: the name must be"]),
        (
            "random_seed",
            2**64,
            ["random_seed is 18446744073709551616", "below 18446744073709551616"],
        ),
        ("random_seed", float("nan"), ["random_seed is nan", "finite"]),
        ("search.tikhonov", [float("inf")], ["search.tikhonov[0] is inf", "finite"]),
        ("figures.published_overlay", "no", ["figures.published_overlay", "true or false"]),
    ],
)
def test_mistake_in_one_setting(config, name, value, parts):
    put(config, name, value)
    message = only_problem(config)
    assert [part for part in parts if part not in message] == []


def test_yaml_keys_that_are_not_text(config):
    config["search"][5] = None  # of {interval_lt: 1,5}
    told = "search.5: the key 5 must be text; in braces a comma ends a value"
    assert told in only_problem(config)


def test_a_threshold_above_the_laminar_flow_is_one_mistake(config):
    config["case_defaults"]["event_threshold"] = 0.6
    assert "below laminarisation_threshold" in only_problem(config)


def test_all_mistakes_are_told_at_once(config):
    del config["horizon"]["events"]
    put(config, "searsh", {})
    put(config, "random_seed", -1)
    assert len(problems(config)) == 3
    with pytest.raises(ConfigError, match=r"has 3 mistakes:\n  1\. .*\n  2\. .*\n  3\. "):
        load(config)


# -- mistakes between settings ---------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "value", "parts"),
    [
        ("search.spectral_radius", [1, 0.1], ["search.spectral_radius is [1, 0.1]", "below"]),
        ("search.input_scaling", [1, 1], ["search.input_scaling", "below"]),
        ("case_defaults.density.range", [1, 0], ["density.range is [1, 0]", "below"]),
        ("classification.window_lt", 0.7, ["classification.window_lt is 0.7", "multiple"]),
        ("classification.longest_prediction_time_lt", 5.2, ["is 5.2", "multiple"]),
        (
            "classification.prediction_times_lt",
            [2, 2.2, 3],
            ["prediction_times_lt has 2.2", "multiple"],
        ),
        (
            "classification.prediction_times_lt",
            [2, 3, 6],
            ["prediction_times_lt has 6", "beyond", "longest_prediction_time_lt, 5"],
        ),
        ("forecasters.filter.members", 41, ["is 41; it must be an even number above 0"]),
        ("horizon.lead_time_step_lt", 11, ["horizon.lead_time_step_lt is 11", "at most"]),
        ("horizon.longest_lead_time_lt", 66, ["case Re400:", "4026 steps", "ensemble.duration"]),
        ("search.interval_lt", 0.001, ["case Re400:", "search.interval_lt is 0.001"]),
        (
            "figures.example_forecaster",
            "esn-N100-RV-seed0",
            ["(Re400, esn-N100-RV-seed0)", "not part"],
        ),
        ("figures.example_case", "Re401", ["figures.example_case", "not part of the campaign"]),
        (
            "figures.example_forecaster",
            "esn-N2000-RV-seed10",
            ["RV-seed10", "not part of the campaign", "(Re400 has esn-N500-SSV-seed0)"],
        ),
        ("figures.fixed_neurons", 700, ["figures.fixed_neurons is 700", "500, 1000, 1500"]),
        ("figures.flow_event.peak", 0.05, ["figures.flow_event.peak is 0.05", "of Re400, 0.1"]),
        ("campaign.1.cases", ["Re40O"], ["campaign[1].cases", "did you mean Re400?"]),
        (
            "forecasters.esn.connectivity",
            600,
            ["forecasters.esn.connectivity is 600", "at most 499"],
        ),
        (
            "campaign.0.forecasters.esn.variants",
            ["quadratic"],
            ["campaign[0].forecasters: there is no quadratic in forecasters.variants"],
        ),
        (
            "forecasters.variants",
            {"aware": {"readout": "quadratic"}},
            ["forecasters.variants.aware: esn_aware is another kind"],
        ),
        ("forecasters.variants", {"sparse": {"connectivity": 600}}, ["at most 499"]),
        ("forecasters.esn.readout", "cubic", ["forecasters.esn.readout", "linear or quadratic"]),
        ("forecasters.esn.leak_rate", [0], ["forecasters.esn.leak_rate", "above 0"]),
        ("campaign.1.forecasters", {}, ["campaign[1].forecasters names no kind"]),
        ("campaign.1.forecasters", {"esn": None}, ["campaign[1].forecasters names no kind"]),
        ("case_defaults.system", "mfee", ["unknown system 'mfee'", "did you mean 'mfe'"]),
        ("case_defaults.parameters.length", 1, ["no parameter 'length'", "length_x"]),
        ("case_defaults.ensemble.initial_state", [1, 2], ["initial_state has 2", "needs 9"]),
        ("case_defaults.ensemble.perturbed_component", 10, ["perturbed_component is 10", "1 to 9"]),
        ("case_defaults.ensemble.duration", 4000.5, ["ensemble.duration is 4000.5", "multiple"]),
        ("case_defaults.ensemble.transient", 200.1, ["ensemble.transient is 200.1", "multiple"]),
        ("case_defaults.ensemble.series", 200, ["ensemble.series, 200", "together"]),
        (
            "probability.calibration_series",
            1695,
            ["probability.calibration_series is 1695", "together", "ensemble.series, 2000"],
        ),
        ("case_defaults.training.series", 3, ["recycle_validation.series is 4", "training.series"]),
        ("case_defaults.lyapunov.saturation", 1e-8, ["lyapunov.perturbation", "below"]),
        ("case_defaults.lyapunov.orthonormalisation_interval", 0.3, ["is 0.3", "multiple"]),
        ("case_defaults.laminarisation_threshold", 0.1, ["event_threshold is 0.1", "below"]),
        ("case_defaults.controlled_density.range", [1, 1], ["controlled_density.range", "below"]),
        (
            "case_defaults.actuation.force",
            [0, 1],
            ["actuation: a force needs 9", "[0.0, 1.0]"],
        ),
        ("case_defaults.actuation.parameters", {"rho": 1}, ["actuation: ", "no parameter 'rho'"]),
        ("case_defaults.actuation.start_lt", -1.5, ["control.prediction_times_lt has 1", "alarm"]),
        (
            "control.forecasters.esn.neurons",
            [2000, 7],
            ["control.forecasters.esn.neurons has 7", "500, 1000", "must be one of"],
        ),
        (
            "statistics.forecasters.esn.validation",
            ["SV"],
            ["statistics.forecasters.esn.validation", "RV, SSV"],
        ),
        ("control.sweep.cases", ["Re40"], ["control.sweep.cases", "did you mean Re400"]),
        (
            "control.strategies",
            [{"strategy": "receding_horizn"}],
            ["strategies[0].strategy is receding_horizn", "reactive, receding_horizon"],
        ),
        (
            "control.strategies",
            [{"strategy": "reactive"}],
            ["control.strategies[0].settings", "needs the setting 'decision_interval_lt'"],
        ),
        (
            "control.strategies",
            [reactive(settings={"level": ["high"], "decision_interval_lt": [1]})],
            ["strategies[0].settings: setting 'level' of strategy", "must be a finite number"],
        ),
        (
            "control.strategies",
            [reactive(settings={"level": [0.05], "decision_interval_lt": [0.001]})],
            ["case", "control.strategies[0]: the interval", "must last a step"],
        ),
        (
            "control.strategies",
            [reactive(cases=["Re40"])],
            ["control.strategies[0].cases", "did you mean Re400"],
        ),
        (
            "control.strategies",
            [reactive(forecasters={"equations": {}})],
            ["control.strategies[0].forecasters", "reactive uses no forecaster"],
        ),
        (
            "control.strategies",
            [
                reactive(
                    strategy="planned",
                    settings={"decision_interval_lt": [0.25], "horizon_lt": [3]},
                    forecasters={"esn": {}},
                )
            ],
            [
                "control.strategies[0]: planned passes the parameters in force to forecasters",
                "which esn cannot use",
            ],
        ),
        (
            "control.strategies",
            [reactive(strategy="prediction_triggered", settings=WINDOWS)],
            ["control.strategies[0].forecasters names no kind", "asks forecasters"],
        ),
        (
            "control.strategies",
            [reactive(strategy="prediction_triggered", settings=WINDOWS, forecasters=SEVEN)],
            ["control.strategies[].forecasters.esn.neurons has 7", "must be one of"],
        ),
        (
            "control.strategies",
            [
                reactive(
                    strategy="prediction_triggered",
                    settings={**WINDOWS, "prediction_time_lt": [0.5]},
                    forecasters={"equations": {}},
                )
            ],
            ["control.strategies[0]: control is not defined", "before the alarm"],
        ),
        ("control.strategies", [voting(vote_share=[0.5])], ["committees; say committee: true"]),
        (
            "control.strategies",
            [reactive(committee=True)],
            ["control.strategies[0].committee: reactive has no votes"],
        ),
        (
            "control.strategies",
            [voting(committee=True, vote_share=[0.5, 5])],
            ["control.strategies[0].settings.vote_share has 5", "above 0, and 1 at most"],
        ),
        (
            "control.strategies",
            [voting(committee=True, seeds=2)],
            ["control.strategies[0].seeds", "leave it out"],
        ),
        (
            "control.strategies",
            [voting(committee=True, forecasters={"equations": {}})],
            ["control.strategies[0].forecasters names equations", "provides no ensemble"],
        ),
        ("control.strategies", [reactive(strength=[0])], ["strength[0] is 0", "above 0"]),
        ("control.strategies", [reactive(starts="loud")], ["starts", "quiet or unselected"]),
        ("cases.Re400.parameters", {"reynolds": 300}, ["Re400", "contradicts the name"]),
        ("cases.Re400.lyapunov.published_exponent", 2, ["Re400", "published_exponent", "step"]),
        ("cases.Re400.recycle_validation.intervals_per_series", 33, ["33 validation", "only 32"]),
        ("statistics.duration", 100, ["Re400", "statistics.duration", "loop of 100", "last 610"]),
    ],
)
def test_mistake_between_settings(config, name, value, parts):
    put(config, name, value)
    messages = [message for message in problems(config) if all(part in message for part in parts)]
    assert len(messages) == 1


@pytest.mark.parametrize(
    ("name", "value", "parts"),
    [
        ("forecasters.filter.members", 16, ["at least twice", "18 for the system mfe"]),
        ("forecasters.quadratic.window_lt", 0.01, ["shorter than one step", "has 61"]),
        ("forecasters.quadratic.window_lt", 70, ["4270 steps", "has 4001 samples"]),
    ],
)
def test_settings_of_kinds_matter_where_the_campaign_has_them(config, name, value, parts):
    put(config, name, value)
    load(copy.deepcopy(config))
    put(config, "campaign.0.forecasters.quadratic_filtered", {})
    with pytest.raises(ConfigError) as caught:
        load(config)
    assert all(part in str(caught.value) for part in [name, "Re400", *parts])


def test_block_without_case(config):
    del config["campaign"][1]["reynolds"]
    assert any("campaign[1] names no case" in problem for problem in problems(config))


def test_blocks_may_overlap(config):
    config["campaign"].append(config["campaign"][0])
    assert list(case_records(load(config))) == ["Re400", "Re600", "Re800", "Re1000"]


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
    found = [
        f"{shown}, line 4: the key horizon.events is there already, in line 2",
        f"{shown}, line 7: the key campaign[1].seeds is there already, in line 7",
        f"{shown}, line 8: the key horizon is there already, in line 1",
    ]
    assert misread([path, str(path)]) == found
    assert misread([ROOT / "config.yaml", *PRESETS]) == []
    put(config, "random_seed", -1)
    with pytest.raises(ConfigError) as caught:
        load(config, [path])
    assert caught.value.problems[:3] == found
    assert len(caught.value.problems) == 4


@pytest.mark.parametrize(
    ("text", "found"),
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
        ("a: 0b11", "a is 0b11, which YAML reads as 3: write"),
        ("a: 0x10", "a is 0x10, which YAML reads as 16: write"),
        ("a: 1:30.5", "a is 1:30.5, which YAML reads as 90.5: write"),
        ("a: 1_0.5", "a is 1_0.5, which YAML reads as 10.5: write"),
        ("a: !!int '010'", "a is 010, which YAML reads as 8: write"),
        ("010: a", "the key 010 is 010, which YAML reads as 8: write"),
        ("a: 2026-11-23", "a is 2026-11-23, which YAML reads as a date: quote it"),
    ],
)
def test_what_yaml_reads_otherwise_than_it_looks(config, tmp_path, text, found):
    (tmp_path / "mine").write_text(text)
    assert (found in misread([tmp_path / "mine"])[0]) if found else not misread([tmp_path / "mine"])
    if found:
        with pytest.raises(ConfigError, match="mine"):
            load(config, [tmp_path / "mine"])


def test_an_actuation_that_the_case_has_to_complete(config):
    put(config, "case_defaults.actuation", None)
    put(config, "cases.Re400.actuation", {"parameters": {"reynolds": 2000}, "force": None})
    assert [problem.partition(" is missing")[0] for problem in problems(config)] == [
        "case Re400: actuation.start_lt",
        "case Re400: actuation.duration_lt",
    ]


# -- what fits into a series -----------------------------------------------------------------------


@pytest.mark.parametrize(
    ("changes", "least"),
    [
        # a Lyapunov time of 61 steps, a washout of 30: what has to fit into a series
        ({"search.interval_lt": 10}, 30 + 610 + 1),
        ({"cases.Re400.recycle_validation.intervals_per_series": 4}, 30 + 4 * 122),
        ({"classification.longest_prediction_time_lt": 19}, 30 + 20 * 61),
        ({"horizon.longest_lead_time_lt": 30}, 30 + 30 * 61),
        # a closed loop as long as a series, at whose end it is seen to be at rest
        ({"statistics.fixed_point_interval_lt": 25}, 25 * 61 + 1),
    ],
)
def test_least_length_of_a_series(config, changes, least):
    config["campaign"] = [{"reynolds": [400], "forecasters": networks(2000)}]
    put(config, "cases.Re400.recycle_validation", {"series": 3, "intervals_per_series": 1})
    put(config, "horizon.longest_lead_time_lt", 1)
    put(config, "statistics", {**config["statistics"], "duration": None})
    put(config, "statistics.fixed_point_interval_lt", 1)
    for name, value in changes.items():
        put(config, name, value)
    # both ends of a series are sampled, one time unit apart
    put(config, "cases.Re400.ensemble", {"duration": least - 1})
    load(copy.deepcopy(config))
    put(config, "cases.Re400.ensemble", {"duration": least - 2})
    problem = only_problem(config)
    assert problem.startswith("case Re400: ")
    assert "ensemble.duration" in problem


@pytest.mark.parametrize(
    "name",
    [
        *("washout_lt", "search.interval_lt", "probability.start_spacing_lt"),
        *("classification.start_spacing_lt", "horizon.lead_time_step_lt"),
    ],
)
def test_durations_below_one_step(config, name):
    put(config, "campaign", [{"reynolds": [400], "forecasters": networks(2000)}])
    put(config, name, 0.01)
    assert only_problem(config) == (
        f"case Re400: {name} is 0.01 Lyapunov times, which is shorter than one step of the "
        "network: a Lyapunov time has 61"
    )


def test_calibration_leaves_out_one_of_several_training_series(config):
    put(config, "case_defaults.training.series", 1)
    put(config, "case_defaults.recycle_validation.series", 1)
    put(config, "cases.Re400.recycle_validation.series", 1)
    assert "left out of the training one by one: take 2 at least" in only_problem(config)
    put(config, "probability.calibration_series", 20)
    load(config)


def test_series_are_counted_together():
    check_kept_series(10, {"training.series": 4, "test_series": 6})
    with pytest.raises(ValueError, match=r"training.series is 4 and test_series is 7, but only 10"):
        check_kept_series(10, {"training.series": 4, "test_series": 7})


def test_too_few_starting_points_are_told_of_cases_that_the_campaign_uses(config):
    assert few_points(Configuration.model_validate(load(config))) == ""
    put(config, "campaign", [{"reynolds": [400, 600], "forecasters": networks(2000)}])
    put(config, "statistics.fixed_point_interval_lt", 1)
    put(config, "cases.Re400.ensemble", {"duration": 1500})
    put(config, "cases.Re400.recycle_validation", {"series": 1, "intervals_per_series": 1})
    put(config, "cases.Re400.test_series", 1)
    put(config, "probability.start_spacing_lt", 9)
    told = few_points(Configuration.model_validate(load(config)))
    # from a washout of 30 steps to 6 LT of 61 steps before the end, in one and in ten series
    score, calibrate = (len(range(29, 1501 - 6 * 61, step)) for step in (61, 9 * 61))
    assert (score, 10 * calibrate) == (19, 30)
    assert told.startswith("fewer than 30 starting points of forecasts: Re400 has 19 to score; ")
    put(config, "probability.start_spacing_lt", 10)
    put(config, "cases.Re400.ensemble", {"duration": 1400})
    told = few_points(Configuration.model_validate(load(config)))
    assert "Re400 has 17 to score and 20 to calibrate with; raise test_series" in told
    put(config, "cases.Re400.lyapunov.published_exponent", None)
    assert few_points(Configuration.model_validate(load(config))) == ""


def test_a_series_has_a_sample_at_each_end(config):
    # 0.5 Lyapunov times of 61 steps, and so many intervals that the last step is the 4001st
    put(config, "cases.Re400.ensemble", {"duration": 30 + 30 * 122 - 1})
    load(config)
    put(config, "cases.Re400.ensemble", {"duration": 30 + 30 * 122 - 2})
    assert "recycle_validation.intervals_per_series" in only_problem(config)


def test_the_flow_of_a_system_that_is_none_is_not_looked_at(config):
    config["cases"]["lorenz"] = lorenz()
    block = {"cases": ["lorenz"], "forecasters": networks(2000)}
    config["campaign"] = [block]
    put(config, "figures.example_case", "lorenz")
    put(config, "control.forecasters", {})
    load(config)  # its event threshold, 40, is above figures.flow_event.peak


def test_without_laminarisation_nothing_survives_better(config):
    config["case_defaults"]["laminarisation_threshold"] = None
    config["search"]["choice"] = "survival"
    assert "search.choice is survival" in only_problem(config)
    config["search"]["choice"] = "best"
    load(config)  # nothing is wrong with it


def test_realisations_need_series_of_their_own(config):
    config["campaign"][0]["realisations"] = 5
    load(config)
    config["case_defaults"]["ensemble"]["series"] = 199
    (problem, *_) = [one for one in problems(config) if "realisations" in one]
    assert "realisations is 5" in problem
    assert "are 200 series of Re400, but ensemble.series is 199" in problem


def test_names_of_realisations_are_taken(config):
    config["cases"]["Re400-training1"] = {"parameters": {"reynolds": 400}}
    assert "names that end so belong to other training series of Re400" in only_problem(config)


def test_drawn_training_sets_fit_the_campaign(config):
    block = {
        "reynolds": [400],
        "event_shares": [0.13, 0.17],
        "forecasters": {"esn": {"neurons": [500], "validation": ["RV"], "seeds": 1}},
    }
    config["campaign"].append(block)
    load(config)
    block["event_shares"] = [0.13, 1.5]
    assert any("event_shares[1]" in one for one in problems(config))
    block["event_shares"] = [0.13, "all"]
    load(config)
    config["campaign"].append({**block, "event_shares": [0.17]})
    assert "one list of event_shares must begin with the other" in only_problem(config)
    config["campaign"].pop()
    block["realisations"] = 3
    assert any("realisations and event_shares" in one for one in problems(config))
    del block["realisations"]
    config["case_defaults"]["ensemble"]["series"] = 179
    (problem, *_) = [one for one in problems(config) if "event_shares" in one]
    assert "event_shares has 2" in problem
    assert "are 180 series of Re400, but ensemble.series is 179" in problem


def test_drawn_training_sets_need_the_case_that_they_are_drawn_from(config):
    config["campaign"][0]["event_shares"] = [0.17]
    config["cases"]["Re400"]["event_threshold"] = {"quantile": 0.9}
    found = problems(config)
    assert any("drawn from the series of Re400, which no block" in one for one in found)
    assert any("Re400 is a quantile of the training series" in one for one in found)


def test_the_surrogate_starts_within_its_bounds(config):
    config["search"]["surrogate"] = {"length_scale": [0.01, 0.1], "random_state": 10}
    assert "search.surrogate.first_length_scale" in only_problem(config)
    config["search"]["surrogate"]["first_length_scale"] = 0.05
    load(config)
