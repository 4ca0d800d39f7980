"""Stages as a whole: rules, their scripts and the registries agree with one another."""

import ast
import inspect
import re
import textwrap
from functools import cache
from types import SimpleNamespace

import pytest
import yaml
from helpers_configs import ROOT, paper_with
from snakemake import iocontainers
from snakemake.api import SnakemakeApi
from snakemake.exceptions import WorkflowError
from snakemake.settings.types import ConfigSettings, OutputSettings, Quietness, ResourceSettings

from burstcast.base.declared import files_of, paths_of
from burstcast.forecasters.registry import all_kinds, available_kinds, kind_class
from burstcast.tables.makers.registry import maker
from burstcast_workflow.campaign.campaign import Campaign
from burstcast_workflow.campaign.loading import load
from burstcast_workflow.figures.jobs import FigureJobs
from burstcast_workflow.figures.registry import FIGURES, settings_of
from burstcast_workflow.harness.call import parameters as parameters_of
from burstcast_workflow.harness.call import settings_taken
from burstcast_workflow.harness.job import function_of
from burstcast_workflow.harness.settings import Setting
from burstcast_workflow.stages.stages import Stages, any_of_regex
from burstcast_workflow.tables.declarations import TABLES as DECLARED
from burstcast_workflow.tracking.code import Sources

SCRIPTS = ROOT / "workflow" / "scripts"
SOURCE = ROOT / "src"
MAKERS = [path.stem for path in (SOURCE / "burstcast" / "tables" / "makers").glob("[!_]*_*.py")]
RULES = "".join(path.read_text() for path in sorted((ROOT / "workflow" / "rules").glob("*.smk")))
# Rules with a script, read as text: pytest asks for them before any test. Those of tables are made
# in loops: of a case, and of all cases by section.
WRITTEN = {
    name: text
    for name, text in re.findall(r"^rule (\w+):\n((?: .*\n|\n)*)", RULES, re.M)
    if "script:" in text and name != "figure"
}


@cache
def workflow():
    """The rules by name, and the campaign of the paper, with all that other campaigns have."""
    campaign = yaml.safe_load((ROOT / "config.yaml").read_text(encoding="utf-8"))["campaign"]
    encoded = {"data": {"case": "Re400"}, "encoder": {"kind": "pod", "modes": 2}}
    overlay = {
        "control": {"tolerated_exceedance": 0.01},
        "cases": {"encoded": encoded},
        "campaign": [*campaign, {"cases": ["encoded"], "forecasters": {"persistence": {}}}],
    }
    with SnakemakeApi(OutputSettings(quiet={Quietness.ALL})) as api:
        loaded = api.workflow(
            resource_settings=ResourceSettings(cores=1),
            config_settings=ConfigSettings(configfiles=(ROOT / "config.yaml",), config=overlay),
            snakefile=ROOT / "Snakefile",
        )._workflow
        rules = {rule.name: rule for rule in loaded.rules}
        config = {name: value for name, value in loaded.config.items() if name != "captions"}
    return SimpleNamespace(rules=rules, campaign=Campaign(load(config)))


def Wildcards(**values):  # noqa: N802 - as Snakemake's
    """Values by name or attribute, as Snakemake's."""
    return iocontainers.Wildcards(fromdict=values)


JOINED = dict.fromkeys(table.section for table in DECLARED.values() if table.of_cases)
"""Sections of the report, the tables of which one job joins."""
STAGES = [*WRITTEN, *MAKERS] + [f"joined_{section}" for section in JOINED]
TABLES = SCRIPTS / "tables" / "table.py"
"""Script that makes all tables of a case."""


def script_of(rule):
    return (ROOT / "workflow" / "rules" / workflow().rules[rule].script).resolve()


def wildcards_of(rule):
    network, plan = "esn-N2000-RV-seed0", "prediction_triggered-prediction_time1-window1"
    wildcards = {"case": "Re400", "family": "networks", "forecaster": network}
    wildcards |= {"reservoir": "esn-N2000-seed0", "strategies": "RV+SSV"}
    wildcards |= {"controller": network, "strategy": plan}
    names = workflow().rules[rule].wildcard_names
    return Wildcards(**{name: wildcards[name] for name in names})


def texts_of(params, wildcards):
    """Parameters as Snakemake hands them to a job."""
    return [text(wildcards) if callable(text) else text for text in params]


def of_job(rule, wildcards=None):
    """Settings of a rule's job, and the names of its code."""
    params = workflow().rules[rule].params
    settings, code = parameters_of(texts_of(params, wildcards or wildcards_of(rule)))
    return settings, {entry.partition(" ")[0] for entry in code}


def test_the_rules_are_those_of_the_text_and_every_script_belongs_to_one():
    assert {name for name, rule in workflow().rules.items() if rule.script} == {*STAGES, "figure"}
    assert len(STAGES) == len(set(STAGES)) > 20
    of_rules = {script_of(rule) for rule in STAGES}
    assert of_rules | {script_of("figure")} == set(SCRIPTS.glob("*/*.py"))
    assert {rule for rule in STAGES if script_of(rule) == TABLES} == set(MAKERS)


@pytest.mark.parametrize("rule", WRITTEN)
def test_a_rule_says_its_name_wherever_it_is_asked_for(rule):
    """Settings are found by it, and logs are named by it."""
    asked = r"computed_settings_files\(\s*\"(\w+)\"|<logs>/(\w+)"
    assert {name for names in re.findall(asked, WRITTEN[rule]) for name in names} == {rule, ""}
    script = script_of(rule).relative_to(SCRIPTS)
    assert re.search(rf'\*of_script\(\s*"{script}"', WRITTEN[rule])
    # what other jobs find out is an input of the rules that read it: of drawn training series,
    # which the paper's campaign has not, the threshold
    read = re.search("event_threshold|lyapunov.time_unit|drawn_shares", str(of_job(rule)[0]))
    assert ("computed_settings_files" in WRITTEN[rule]) == bool(read)


@pytest.mark.parametrize("rule", STAGES)
def test_a_rule_runs_the_script_of_its_name_and_has_its_code(rule):
    # of rules in a loop not that of the last one
    script, made = script_of(rule), dict(workflow().rules[rule].params.items())
    (module,) = [name for name in of_job(rule)[1] if name.endswith(".py")]
    assert module == str(script.relative_to(SCRIPTS))
    if script == TABLES:
        assert made["maker"] == rule
    else:
        assert script.stem == ("joined" if rule.startswith("joined_") else rule)


def test_the_page_of_the_architecture_shows_the_rules():
    text = (ROOT / "docs" / "images" / "rule_graph.svg").read_text()
    drawn = {name for name in re.findall(r">(\w+)</text>", text) if name in WRITTEN}
    of_others = {"import_data", "neighbour_divergence", "encode", "training_realisation"}
    assert drawn < {*WRITTEN} - of_others
    assert drawn > {"simulate", "scan", "search", "train", "fit", "forecast", "report_page"}


# -- scripts ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("rule", STAGES)
def test_a_script_takes_the_files_of_its_rule_and_its_settings(rule):
    made = workflow().rules[rule]
    files = [*made.input.keys(), *made.output.keys()]
    assert len({*files}) == len(files)
    if script_of(rule) == TABLES:
        assert {*files_of(maker(rule)), "tables"} == {*files}
        return
    function = function_of(script_of(rule))
    # the last of its script, since a job starts where the decorator stands
    assert ast.parse(script_of(rule).read_text()).body[-1].name == function.__name__
    arguments = inspect.signature(function).parameters
    assert {*arguments} - {"settings"} == {*files}
    required = inspect.Parameter.KEYWORD_ONLY, inspect.Parameter.empty
    assert {(each.kind, each.default) for each in arguments.values()} == {required}


DECLARING = {name: maker(name) for name in MAKERS}
DECLARING |= {name: figure.draw for name, figure in FIGURES.items()}


@pytest.mark.parametrize("name", DECLARING)
def test_tables_and_figures_are_made_of_all_that_they_declare_and_of_nothing_else(name):
    function = DECLARING[name]
    arguments = inspect.signature(function).parameters
    optional = {name for name, argument in arguments.items() if argument.default is None}
    assert optional <= {"published"}  # an input only where it is wanted
    for missing in {*arguments} - optional - {"published"}:
        with pytest.raises(TypeError, match=f"{name} is called without {missing}$"):
            function(**dict.fromkeys({*arguments} - {missing}))
    read = {
        node.id
        for part in ast.parse(inspect.getsource(function)).body[0].body
        for node in ast.walk(part)
        if isinstance(node, ast.Name)
    }
    assert {*arguments} <= read


@pytest.mark.parametrize("name", FIGURES)
def test_a_figure_has_its_settings_and_its_own_module_and_what_that_reaches(name):
    assert {*settings_of(workflow().campaign, FIGURES[name], "Re400")} == {*FIGURES[name].paths}
    _, modules = of_job("figure", Wildcards(figure=name, of_case=""))
    figures = {f"burstcast.figures.{figure}" for figure in FIGURES}
    assert modules & figures == {f"burstcast.figures.{name}"}
    call = "burstcast_workflow.harness.call"
    assert modules > {"figures/figure.py", "burstcast.figures.parts.style", call}
    # of what the module itself finds by name, only what the case is about
    strategies = {
        "burstcast.networks.validation_strategies.recycle",
        "burstcast.networks.validation_strategies.single_shot",
    }
    assert modules & strategies == (strategies if name == "validation_strategies" else set())
    assert "burstcast.systems.lorenz63" not in modules


# -- settings --------------------------------------------------------------------------------------


def fields_read(function, cls, seen):
    """Fields that a function reads of settings of a class, in what it is handed on to as well."""
    if function in seen:
        return set()
    seen.add(function)
    fields = set()
    for node in ast.walk(ast.parse(textwrap.dedent(inspect.getsource(function)))):
        if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name):
            of_class = function.__globals__.get(node.value.id)
            if node.value.id in ("settings", "self") or (of_class in cls.__mro__):
                value = inspect.getattr_static(cls, node.attr, None)
                method = getattr(value, "fget", value)  # of a property
                if isinstance(value, Setting):
                    fields.add(node.attr)
                elif inspect.isfunction(method):
                    fields |= fields_read(method, cls, seen)
        elif isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
            handed = node.args + [keyword.value for keyword in node.keywords]
            if {"settings", "self"} & {ast.unparse(argument) for argument in handed}:
                helper = function.__globals__.get(node.func.id)
                fields |= fields_read(helper, cls, seen) if inspect.isfunction(helper) else set()
    return fields


def fields_of(cls):
    every = {name for ancestor in cls.__mro__ for name in vars(ancestor)}
    return {name for name in every if isinstance(inspect.getattr_static(cls, name), Setting)}


@pytest.mark.parametrize("rule", STAGES)
def test_a_script_reads_every_setting_that_it_declares_and_a_job_is_given(rule):
    """Those that do not concern the job are left out."""
    function = function_of(script_of(rule))
    cls = settings_taken(function)
    assert fields_read(function, cls, set()) == fields_of(cls)
    of_maker = {*paths_of(maker(rule))} if script_of(rule) == TABLES else set()
    given = set(of_job(rule)[0]) - set(cls.paths())
    assert [path for path in given if not covered(path, of_maker)] == []


def covered(path, paths):
    """Whether one of the paths is this one, or lies in it."""
    return any(path == other or other.startswith(f"{path}.") for other in paths)


# -- forecasters -----------------------------------------------------------------------------------


def test_kinds_of_the_config_are_those_of_the_library():
    others = {*all_kinds()} - {*available_kinds()}
    assert all(kind_class(kind).aware for kind in others)


@pytest.mark.parametrize(
    ("directory", "rule"),
    [
        ("networks/esn_aware-squares-N30-RV-seed0", "train"),
        ("networks/my_models.NVAR-one", None),
        ("networks/esn-N30-RV-committee", None),
        ("models/esn-N30-RV-seed0", None),
        ("models/my_models.NVAR-one", "fit"),
        ("classifiers/precursor", "event_probabilities"),
        ("classifiers/models.base_rate.BaseRate", "event_probabilities"),
        ("classifiers/esn-N30-RV-seed0", None),
        ("others/equations", None),
    ],
)
def test_the_directory_of_a_forecaster_says_which_rule_makes_it(directory, rule):
    """A mistyped one is made by no rule, and not by the rule for others."""
    assert makers_of(f"Re400/{directory}/forecaster.nc") == ({rule} if rule else set())


def test_a_classifier_among_the_models_is_refused_with_its_directory(paper):
    wildcards = Wildcards(case="Re400", forecaster="precursor")
    with pytest.raises(WorkflowError, match="Re400/classifiers/precursor"):
        paper.scheduled(wildcards)


def makers_of(name):
    """Names of the rules that make a file of the results."""
    path = f"{workflow().campaign.config.results}/{name}"
    return {name for name, rule in workflow().rules.items() if rule.is_producer(path)}


# -- what rules ask for each job -------------------------------------------------------------------

PUBLISHED = "resources/published_percentiles.csv"


def stages(*overlays):
    sources = Sources(lambda name: SCRIPTS / name, SOURCE, {})
    return Stages(Campaign(load(paper_with(*overlays))), sources)


@pytest.fixture(scope="module")
def paper():
    return stages()


QUANTILE = {"case_defaults": {"event_threshold": {"quantile": 0.9}}}
JOB = Wildcards(case="Re600", forecaster="esn-N2000-RV-seed3")


def test_wildcards_of_some_names_and_of_none():
    assert re.fullmatch(any_of_regex(["Re400", "a.b"]), "a.b")
    assert not re.fullmatch(any_of_regex(["Re400", "a.b"]), "aXb")
    assert not re.fullmatch(any_of_regex([]), "")


def test_a_parameter_is_empty_where_it_does_not_concern_the_job(paper):
    params = paper.of_script("evaluation/forecast.py", given=3)
    lengths = []
    for name in ("esn-N2000-RV-seed3", "equations"):
        wildcards = Wildcards(case="Re600", forecaster=name)
        texts = texts_of(params, wildcards)
        assert "" in texts
        settings, code = parameters_of(texts)
        assert (settings["given"], settings["random_seed"]) == (3, 2022)
        reached = {entry.partition(" ")[0] for entry in code}
        assert ("burstcast.networks.dynamics" in reached) == name.startswith("esn")
        assert "burstcast.systems.mfe" in reached
        lengths.append(len(texts))
    assert lengths == [len(params)] * 2  # one for each setting and each module of any job


def test_a_figure_of_another_case_and_its_overlay():
    job = Wildcards(figure="long_term_density", of_case="_Re600")
    for overlay in (False, True):
        made = stages({"figures": {"published_overlay": overlay}})
        drawn = FigureJobs(made, PUBLISHED)
        assert drawn.case(job) == "Re600"
        assert ("published" in drawn.files(job)) == overlay
        assert drawn.labels(job) == {"figure": "long_term_density", "case": "Re600"}
        assert drawn.category(job).endswith("Long-term statistics")


# -- the profile for Slurm -------------------------------------------------------------------------

PROFILE = yaml.safe_load((ROOT / "profiles" / "slurm" / "config.yaml").read_text())
DEFAULT = yaml.safe_load((ROOT / "profiles" / "default" / "config.yaml").read_text())


def test_the_profile_describes_its_groups_and_spans_those_that_there_are():
    described = (ROOT / "profiles" / "slurm" / "config.yaml").read_text()
    groups = {entry.split("=")[1] for entry in PROFILE["groups"]}
    assert groups <= {*re.findall(r"^#   (\w+) ", described, re.M)}
    spanning = {entry.split("=")[0] for entry in PROFILE["group-components"]}
    assert set() < spanning <= groups


def test_what_makes_a_job_run_again_is_the_same_everywhere():
    for option in ("rerun-triggers", "max-checksum-file-size", "rerun-incomplete", "keep-going"):
        assert PROFILE[option] == DEFAULT[option]
    assert PROFILE["retries"] == 2  # with more
    # logs are those that the summary of failures reads
    common = (ROOT / "workflow" / "rules" / "common.smk").read_text()
    assert f'SCHEDULER_LOGS = Path("{PROFILE["slurm-logdir"]}")' in common


def test_every_rule_belongs_to_a_group_of_the_cluster():
    """Rules of tables name it themselves; all others the profile does."""
    groups = dict(pair.split("=") for pair in PROFILE["groups"])
    named = {rule for rule, text in WRITTEN.items() if "    group:\n" in text}
    assert not named & groups.keys()
    assert named | groups.keys() == {*WRITTEN, "figure"}
    assert {*groups.values()} == {"case", "forecaster", "tables", "figures"}
    in_loops = re.findall(r"^    rule:\n((?:  .*\n|\n)*)", RULES, re.M)
    assert len(in_loops) == 2
    assert all('group:\n            "tables"' in text for text in in_loops)
