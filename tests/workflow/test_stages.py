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
from burstcast.figures.registry import figure_of
from burstcast.forecasters.registry import all_kinds, available_kinds, kind_class
from burstcast.tables.makers.registry import maker
from burstcast_workflow.campaign.campaign import Campaign
from burstcast_workflow.campaign.loading import load
from burstcast_workflow.figures.jobs import FigureJobs
from burstcast_workflow.figures.registry import FIGURES, settings_of
from burstcast_workflow.harness.call import is_script, settings_taken
from burstcast_workflow.harness.job import function_of
from burstcast_workflow.harness.settings import Computed, JobSettings, Part, Setting, covers
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


def of_job(rule, wildcards=None):
    """Settings of a rule's job, and the names of its code."""
    params, wildcards = workflow().rules[rule].params, wildcards or wildcards_of(rule)
    return params.settings(wildcards), {*params.code(wildcards)}


def test_the_rules_are_those_of_the_text_and_every_script_belongs_to_one():
    assert {name for name, rule in workflow().rules.items() if rule.script} == {*STAGES, "figure"}
    assert len(STAGES) == len(set(STAGES)) > 20
    of_rules = {script_of(rule) for rule in STAGES}
    assert of_rules | {script_of("figure")} == set(SCRIPTS.glob("*/*.py"))
    assert {rule for rule in STAGES if script_of(rule) == TABLES} == set(MAKERS)


@pytest.mark.parametrize("rule", WRITTEN)
def test_a_rule_says_its_name_in_its_log_and_its_settings_in_order(rule):
    assert set(re.findall(r"<logs>/(\w+)", WRITTEN[rule])) == {rule}
    (named,) = re.findall(r"settings=settings\((.*?)\n?\s*\)", WRITTEN[rule], re.S)
    paths = re.findall(r'^\s+"([\w.]+)",$', named, re.M)
    assert paths == sorted(paths)
    assert "group:" in WRITTEN[rule]


@pytest.mark.parametrize("rule", STAGES)
def test_a_rule_runs_the_script_of_its_name_and_has_its_code(rule):
    # of rules in a loop not that of the last one
    script, made = script_of(rule), dict(workflow().rules[rule].params.items())
    (module,) = filter(is_script, of_job(rule)[1])
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
    assert {*arguments} - {"settings"} == {*files} - {*settings_taken(function).files()}
    required = inspect.Parameter.KEYWORD_ONLY, inspect.Parameter.empty
    assert {(each.kind, each.default) for each in arguments.values()} == {required}


DECLARING = {name: maker(name) for name in MAKERS}
DECLARING |= {name: figure_of(name).draw for name in FIGURES}


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


def paths_read(function, kinds, seen):
    """Paths of the fields that a function reads of settings and of their parts.

    ``kinds``: Classes of settings by the names of arguments. In functions that these are handed on
    to as well.
    """
    if function in seen:
        return set()
    seen.add(function)
    paths, kinds = set(), dict(kinds)

    def kind_of(node):
        """Class of the settings that an expression is; None if it is none."""
        if isinstance(node, ast.Name):
            named = function.__globals__.get(node.id)
            is_kind = inspect.isclass(named) and issubclass(named, JobSettings)
            return kinds.get(node.id) or (named if is_kind else None)
        if isinstance(node, ast.Attribute) and (owner := kind_of(node.value)):
            field = inspect.getattr_static(owner, node.attr, None)
            return field.kind if isinstance(field, Part) else None
        return None

    tree = ast.parse(textwrap.dedent(inspect.getsource(function)))
    for node in ast.walk(tree):  # names that stand for parts
        if isinstance(node, ast.Assign):
            (target,), value = node.targets, node.value
            several = isinstance(target, ast.Tuple) and isinstance(value, ast.Tuple)
            pairs = zip(target.elts, value.elts, strict=True) if several else [(target, value)]
            kinds |= {
                name.id: kind
                for name, part in pairs
                if isinstance(name, ast.Name) and (kind := kind_of(part))
            }
    for node in ast.walk(tree):
        if isinstance(node, ast.Attribute) and (owner := kind_of(node.value)):
            value = inspect.getattr_static(owner, node.attr, None)
            method = getattr(value, "fget", value)  # of a property
            if isinstance(value, Setting | Computed):
                paths.add(value.path)
            elif inspect.isfunction(method):
                paths |= paths_read(method, {"self": owner}, seen)
        elif isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
            helper = function.__globals__.get(node.func.id)
            if inspect.isfunction(helper):
                handed = dict(zip(inspect.signature(helper).parameters, node.args, strict=False))
                handed |= {keyword.arg: keyword.value for keyword in node.keywords}
                of_helper = {name: kind for name, part in handed.items() if (kind := kind_of(part))}
                paths |= paths_read(helper, of_helper, seen) if of_helper else set()
    return paths


@pytest.mark.parametrize("rule", STAGES)
def test_a_script_reads_every_setting_that_it_declares_and_a_job_is_given(rule):
    """Those that do not concern the job are left out."""
    function = function_of(script_of(rule))
    cls = settings_taken(function)
    read = paths_read(function, {"settings": cls}, set())
    assert [path for path in cls.paths() if not any(covers(path, each) for each in read)] == []
    assert {*cls.files()} == {path.partition(".")[0] for path in read} & {*cls.files()}
    of_maker = {*paths_of(maker(rule))} if script_of(rule) == TABLES else set()
    given = set(of_job(rule)[0])
    assert [path for path in given if not covered(path, {*cls.paths(), *of_maker})] == []


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


def test_a_job_has_the_settings_and_the_code_that_concern_it(paper):
    named = paper.settings("random_seed", "forecasters.aware", "forecaster.options", given=3)
    code = paper.code("evaluation/forecast.py", {})
    for name in ("esn-N2000-RV-seed3", "equations"):
        wildcards = Wildcards(case="Re600", forecaster=name)
        settings, reached = named(wildcards), code(wildcards)
        assert (settings["given"], settings["random_seed"]) == (3, 2022)
        assert "forecasters.aware" not in settings  # which concerns no kind of both
        assert ("burstcast.networks.dynamics" in reached) == name.startswith("esn")
        assert "burstcast.systems.mfe" in reached


@pytest.mark.parametrize(
    ("paths", "message"),
    [
        (["horizon.tolerance"], "its script reads case.system, which the rule does not name"),
        (
            ["horizon.tolerance", "random_seed", "search.grid"],
            "no script reads search.grid",
        ),
        (["search.grid"], "its script reads random_seed, which the rule does not name"),
    ],
)
def test_a_rule_that_names_other_settings_than_its_script_reads_is_refused(paper, paths, message):
    rule = SimpleNamespace(
        name="mine",
        params=iocontainers.Namedlist(fromdict={"settings": paper.settings(*paths)}),
        input=iocontainers.Namedlist(fromdict={}),
        wildcard_names={"case"},
    )
    function = function_of(SCRIPTS / "evaluation" / "horizon.py")
    with pytest.raises(WorkflowError) as refused:
        paper._check(rule, function)
    assert f"rule mine: {message}" in str(refused.value) or f"; {message}" in str(refused.value)
    assert "its script reads time_unit, which is none of its inputs" in str(refused.value)


@pytest.mark.parametrize(
    ("path", "similar"),
    [
        ("horizon.tolerence", r" \(did you mean 'horizon\.tolerance'"),
        ("case.event_treshold", r" \(did you mean 'case\.event_threshold'"),
        ("shown.strategis", r" \(did you mean 'shown\.strategies'"),
        ("nothing_alike_at_all", "$"),
    ],
)
def test_a_setting_that_is_none_is_told_when_rules_are_read(paper, path, similar):
    with pytest.raises(WorkflowError, match=f"there is no setting {path}{similar}"):
        paper.settings("random_seed", path)


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


GROUPS = re.findall(r'group:\n\s+"(\w+)"', RULES)


def test_the_profile_describes_the_groups_of_rules_and_spans_some():
    described = (ROOT / "profiles" / "slurm" / "config.yaml").read_text()
    assert {*GROUPS} == {*re.findall(r"^#   (\w+) ", described, re.M)}
    spanning = {entry.split("=")[0] for entry in PROFILE["group-components"]}
    assert set() < spanning <= {*GROUPS}
    assert "groups" not in PROFILE


def test_what_makes_a_job_run_again_is_the_same_everywhere():
    for option in ("rerun-triggers", "max-checksum-file-size", "rerun-incomplete", "keep-going"):
        assert PROFILE[option] == DEFAULT[option]
    assert PROFILE["retries"] == 2  # with more
    # logs are those that the summary of failures reads
    common = (ROOT / "workflow" / "rules" / "common.smk").read_text()
    assert f'SCHEDULER_LOGS = Path("{PROFILE["slurm-logdir"]}")' in common


def test_every_rule_with_a_script_belongs_to_a_group_of_the_cluster():
    assert len(GROUPS) == RULES.count("script:\n")
