"""What must run again after an edit does, nothing else does, and results have the same bits.

Settings, modules and scripts are edited in turn, in copies of finished results of the tiny preset.
The long tests make every edit: pytest -m long tests/workflow/rebuilds. Plans (-k plan) take half an
hour, runs (-k every_setting) hours.
"""

import copy
import os
import random
import re
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from fnmatch import fnmatchcase
from functools import cached_property
from pathlib import Path
from typing import Any, NamedTuple

import pytest
import yaml
from dependencies import (
    ALL,
    FORECASTERS_BY_NAME,
    FOUND_BY_NAME,
    HARNESS,
    JOBS_OF_NETWORKS,
    JOINED,
    MAKERS,
    STRATEGIES,
    STRATEGIES_BY_NAME,
    TABLES_OF_A_CASE,
    TABLES_OF_CASES,
    VERSION_OF_HARNESS,
    and_what_follows,
    readers,
)
from helpers_configs import tiny_with
from helpers_rebuilds import ROOT, TINY, Project, jobs_since
from snakemake.utils import update_config

from burstcast_workflow.config.model import Configuration

# Jobs of each network, and of those networks that control; tables that have rows of forecasters.
OF_LONG_RUNS = {"long_term/esn", "lyapunov_spectrum/esn"}
OF_NETWORKS = {
    *("scan", "search", "train", "forecast/esn", "horizon/esn"),
    *OF_LONG_RUNS,
    "calibration_forecast/esn",
}
TABLES_OF_CONTROL = {"control_table", "control_density_table", "control_strategies_table"}
OF_CONTROLLING_NETWORKS = {"control/esn", "control/esn-random", *TABLES_OF_CONTROL}
TABLES_OF_FORECASTERS = {
    *("classification_table", "horizon_table", "calibrate", "probability_scores"),
    *("reliability_table", "lead_times"),
}
TABLES_OF_LONG_RUNS = {"statistics_table", "survival_table", "lyapunov_spectrum_table"}
TABLES_OF_NETWORKS = {*TABLES_OF_FORECASTERS, "hyperparameters_table"}
TABLES = {
    *TABLES_OF_NETWORKS,
    *TABLES_OF_CONTROL,
    *TABLES_OF_LONG_RUNS,
    *("dataset_table", "data_generation_parameters", "warnings_table"),
    "network_hyperparameters",
}


@dataclass(frozen=True)
class ConfigEdit:
    """Another value of one setting, and the rules that must run again."""

    path: tuple[str, ...]
    value: Any
    expected: frozenset[str]  # jobs that run again for the tables, as the oracle calls them
    with_it: dict[str, Any] = field(default_factory=dict)  # for the config to stay valid

    @property
    def name(self) -> str:
        return ".".join(self.path)

    def overlay(self) -> dict[str, Any]:
        """Config that is laid over the preset."""
        result: dict[str, Any] = copy.deepcopy(self.with_it)
        if self.path[0] == "campaign":
            campaign = copy.deepcopy(tiny_config()["campaign"])
            inner: Any = campaign[0]
            for key in self.path[2:-1]:
                inner = inner[key]
            inner[self.path[-1]] = self.value
            return result | {"campaign": campaign}
        node: Any = self.value
        for key in reversed(self.path):
            node = {key: node}
        update_config(result, node)
        return result


def tiny_config() -> dict[str, Any]:
    """The tiny preset laid over config.yaml, with the defaults of sections that have any."""
    config = tiny_with()
    whole = Configuration.model_validate(config).dump()
    return config | {name: whole[name] for name in ("case_defaults", "forecasters")}


def leaves(node: Any, path: tuple[str, ...] = ()) -> Iterator[tuple[tuple[str, ...], Any]]:
    """All leaves of a config: lists are leaves, except that of the campaign's blocks."""
    if path == ("campaign",):
        for number, block in enumerate(node):
            yield from leaves(block, (*path, str(number)))
    elif isinstance(node, dict) and node:
        for key, value in node.items():
            yield from leaves(value, (*path, key))
    else:
        yield path, node


# -- values: a default rule, and what it does not fit ----------------------------------------------

_VALUES: dict[str, Any] = {
    "results": "results/elsewhere",
    "campaign.0.reynolds": [400, 500],
    "campaign.0.forecasters.esn.neurons": [30, 40, 35],
    "campaign.0.forecasters.esn.validation": ["RV"],
    "campaign.0.forecasters.equations": None,
    "campaign.0.forecasters.equations_noisy": None,
    "campaign.0.forecasters.quadratic_filtered": None,
    "case_defaults.system": "lorenz63",
    "case_defaults.laminarisation_threshold": 0.3,
    "case_defaults.parameters.length_x": 13,  # a longer domain has more energy than the threshold
    "case_defaults.ensemble.initial_state": [1, 0, 0.07, -0.07, 0, 0, 0, 0, 0],
    "case_defaults.ensemble.time_step": 0.25,
    "case_defaults.ensemble.sampling_stride": 1,
    "case_defaults.ensemble.transient": 220,
    "case_defaults.ensemble.duration": 420,
    "case_defaults.lyapunov.time_unit": "computed",
    "case_defaults.lyapunov.published_exponent": 0.02,
    "case_defaults.lyapunov.orthonormalisation_interval": 10,
    "case_defaults.lyapunov.perturbation": 1e-7,
    "case_defaults.lyapunov.saturation": 2e-2,
    "case_defaults.density.range": [0.015, 0.4],
    "case_defaults.controlled_density.range": [0.012, 0.4],
    "case_defaults.actuation.parameters.reynolds": 1500,
    "case_defaults.files": None,  # they belong to a system of one's own: the same again
    # what is measured, seen or encoded, each case says by itself: the same again
    "case_defaults.data": None,
    "case_defaults.sensors": None,
    "case_defaults.encoder": None,
    "case_defaults.actuation.force": [0.001, 0, 0, 0, 0, 0, 0, 0, 0],
    "case_defaults.actuation.start_lt": -0.5,
    "case_defaults.training.actuation": {
        "interval_lt": 0.25,
        "mean_on_lt": 0.75,
        "mean_off_lt": 2.25,
    },
    "case_defaults.training.trained_on": ["Re400"],
    "cases.Re400.lyapunov.published_exponent": 0.0174,
    "forecasters.esn.backend": "compiled",
    "forecasters.esn.input_range": "first",
    "forecasters.esn.input_offset": "mean",
    "forecasters.esn.readout": "quadratic",
    "forecasters.esn.leak_rate": [1, 0.5],
    "forecasters.variants": {"quadratic": {"readout": "quadratic"}},
    "forecasters.precursor.classifier": "logistic",
    "forecasters.aware.parameters": ["length_x"],
    "forecasters.aware.transform": "identity",
    "forecasters.observation.noise": 0.02,
    "forecasters.filter.members": 24,  # an even number
    "forecasters.filter.inflation": 1.02,
    "forecasters.quadratic.degree": 1,
    "search.spectral_radius": [0.2, 1],
    "search.input_scaling": [0.2, 10],
    "search.tikhonov": [1e-6, 1e-9],
    "search.interval_lt": 1.5,
    "classification.window_lt": 1.5,
    "classification.resolution_lt": 0.25,
    "classification.longest_prediction_time_lt": 3.5,
    "classification.prediction_times_lt": [1, 2, 3, 2.5],
    "horizon.lead_time_step_lt": 0.25,
    "statistics.forecasters.esn.validation": ["RV", "SSV"],
    "statistics.duration": 220,
    "control.forecasters.esn.neurons": [30, 40],
    "control.forecasters.esn.validation": ["RV", "SSV"],
    "control.prediction_times_lt": [1, 2],
    "control.forecasters.equations": None,
    "control.forecasters.equations_noisy": {},
    "statistics.forecasters.equations": {},
    "control.sweep.cases": ["Re400"],
    "control.strategies": [
        {
            "strategy": "receding_horizon",
            "settings": {"horizon_lt": [1], "decision_interval_lt": [0.5]},
            "forecasters": {"esn": {"neurons": [40], "validation": ["RV"]}, "equations": {}},
        },
        {
            "strategy": "reactive",
            "settings": {"level": [0.05], "decision_interval_lt": [0.5]},
            "starts": "unselected",
            "delay_lt": [0.5],
        },
    ],
    "control.sweep.prediction_times_lt": [1, 2],
    "bootstrap.confidence": 0.9,
    "figures.example_case": "Re400",  # the only one there is: the same again
    "figures.example_forecaster": "esn-N30-SSV-seed0",
    "figures.fixed_neurons": 30,
}
_WITH: dict[str, dict[str, Any]] = {
    "campaign.0.reynolds": {
        "cases": {
            "Re500": {
                "test_series": 12,
                "lyapunov": {"published_exponent": 0.015},
                "recycle_validation": {"series": 2, "intervals_per_series": 2},
            }
        }
    },
    # a sweep is only made for cases that are controlled
    "control.sweep.cases": {"control": {"sweep": {"prediction_times_lt": [2], "seeds": 1}}},
}

# Who is new, and the tables that list them: what is there already has nothing to do with it.
_EXPECTED: dict[str, set[str]] = {
    "campaign.0.reynolds": set(ALL),
    "campaign.0.forecasters.esn.neurons": OF_NETWORKS | TABLES_OF_NETWORKS | TABLES_OF_LONG_RUNS,
    "campaign.0.forecasters.esn.seeds": OF_NETWORKS
    | TABLES_OF_NETWORKS
    | TABLES_OF_LONG_RUNS
    | OF_CONTROLLING_NETWORKS
    | {"control/esn/receding_horizon", "control/esn-committee"},
    "campaign.0.forecasters.esn.validation": TABLES_OF_NETWORKS,
    "campaign.0.forecasters.equations": TABLES_OF_FORECASTERS | TABLES_OF_CONTROL,
    "campaign.0.forecasters.equations_noisy": TABLES_OF_FORECASTERS,
    # its members control, too
    "campaign.0.forecasters.quadratic_filtered": {
        *TABLES_OF_FORECASTERS,
        "control_strategies_table",
    },
    "statistics.forecasters.esn.validation": OF_LONG_RUNS | TABLES_OF_LONG_RUNS,
    "statistics.forecasters.equations": {
        *("long_term/equations", "lyapunov_spectrum/equations"),
        *TABLES_OF_LONG_RUNS,
    },
    "control.forecasters.esn.neurons": OF_CONTROLLING_NETWORKS,
    "control.forecasters.esn.validation": OF_CONTROLLING_NETWORKS,
    "control.forecasters.equations": TABLES_OF_CONTROL,
    "control.forecasters.equations_noisy": {"control/equations_noisy", *TABLES_OF_CONTROL},
    "control.prediction_times_lt": OF_CONTROLLING_NETWORKS | {"control/equations"},
    "control.random_alarms": TABLES_OF_CONTROL,
    "control.strategies": {
        "control/equations",
        "control/none",
        "control_strategies_table",
    },
    "control.sweep.cases": OF_CONTROLLING_NETWORKS | {"control/equations"},
}
# Choices that the preset leaves out, which become {}.
_CHOICES = [
    ("statistics", "forecasters", "equations"),
    ("control", "forecasters", "equations_noisy"),
]
# settings that say nothing where they are: another one hides them, or nothing uses them here
_WITHOUT_EFFECT = (
    *("figures.", "control.sweep.seeds", "control.sweep.prediction_times_lt"),
    # of forecasters that know the parameters, which the preset does not have
    *("case_defaults.training.actuation", "case_defaults.training.trained_on", "forecasters.aware"),
    # of networks that no block has
    "forecasters.variants",
    # of classifiers, which it does not have either
    *("forecasters.precursor", "forecasters.esn_direct", "forecasters.classifiers"),
)


def config_edits() -> list[ConfigEdit]:
    """One edit for every leaf of the tiny preset, and for what it leaves out."""
    config = tiny_config()
    own = {".".join(path) for path, _ in leaves(config["cases"]["Re400"])}
    edits = []
    for path, value in [*leaves(config), *((choice, None) for choice in _CHOICES)]:
        name = ".".join(path)
        if name in ("results", "case_defaults.system", "case_defaults.parameters"):
            continue  # tested apart: nothing is there, or nothing fits it
        new = _VALUES[name] if name in _VALUES else _another(value)
        if name in _EXPECTED:
            # of the forecasters' own jobs, only those that are new: nothing follows from them
            expected = _EXPECTED[name] | and_what_follows(_EXPECTED[name] & TABLES)
        elif name.startswith(_WITHOUT_EFFECT):
            expected = set()
        elif path[0] == "cases":
            expected = and_what_follows(readers("case." + ".".join(path[2:])))
            if path[1] != "Re400":
                expected = set()
        elif path[0] == "case_defaults":
            below = ".".join(path[1:])
            expected = set() if below in own else and_what_follows(readers(f"case.{below}"))
        else:
            expected = and_what_follows(readers(name))
        edits.append(ConfigEdit(path, new, frozenset(expected), _WITH.get(name, {})))
    return edits


def _another(value: Any) -> Any:
    if isinstance(value, bool):
        return not value
    if isinstance(value, int):
        return value + 1
    if isinstance(value, float):
        return value * 1.25
    if isinstance(value, list) and value and all(isinstance(item, int | float) for item in value):
        return [_another(value[0]), *value[1:]]
    raise AssertionError(f"say in _VALUES what {value!r} becomes")


# -- code ------------------------------------------------------------------------------------------


def module_of(path: str) -> str:
    """Name of a module; of a script its path below ``workflow/scripts``."""
    parts = Path(path).parts
    if parts[0] != "src":
        return "/".join(parts[2:])
    name = ".".join(Path(*parts[1:]).with_suffix("").parts)
    return name.removesuffix(".__init__")


def code_files() -> list[str]:
    """All modules and scripts."""
    return [
        str(path.relative_to(ROOT))
        for directory in ("src", "workflow/scripts")
        for path in sorted((ROOT / directory).rglob("*.py"))
    ]


# -- what an edit makes run again ------------------------------------------------------------------

TABLE_SCRIPTS = {job.partition("/")[0] for job in ALL}
_TOLD_APART = {job.partition("/")[0] for job in ALL if "/" in job}


class Laboratory:
    """Edits of a working copy with finished tables, which itself stays as it is."""

    def __init__(self, directory: Path, base: Project) -> None:
        self.directory, self.base = directory, base

    @cached_property
    def loaded(self) -> dict[str, set[str]]:
        """Modules that each script loads, and each module that is found by its name."""
        return self.base.loaded_modules()

    @cached_property
    def plans(self) -> Project:
        return self.base.copy(self.directory / "plans")

    def run_of_setting(self, edit: ConfigEdit) -> list[str]:
        """Change a setting and run: what is wrong with the jobs, or unlike a run from scratch."""
        return self._problems({*edit.expected}, edit.overlay(), {})

    def run_of_code(self, path: str, old: str, new: str) -> list[str]:
        """Change a module or a script and run."""
        return self._problems(self.jobs_with(module_of(path)), {}, {path: (old, new)})

    def _problems(
        self, expected: set[str], overlay: dict[str, Any], edits: dict[str, tuple[str, str]]
    ) -> list[str]:
        work = self.base.copy(self.directory / "work")
        for path, (old, new) in edits.items():
            work.edit(path, old, new)
        scratch = work.without_results(self.directory / "scratch")
        outcome = scratch.snakemake("tables", overlay=overlay)
        assert outcome.status == 0, outcome.text[-3000:]
        would, before = work.dry_run(overlay=overlay), work.logs()
        outcome = work.snakemake("tables", overlay=overlay)
        assert outcome.status == 0, outcome.text[-3000:]
        ran = jobs_since(before, work.logs())
        planned = sum(count for rule, count in would.items() if rule in TABLE_SCRIPTS)
        tables = work.tables()
        unlike = [name for name, digest in scratch.tables().items() if tables[name] != digest]
        return [
            *_otherwise_than(expected, {_job(name) for name in ran}),
            *(f"{name} is not that of a run from scratch" for name in unlike),
            *(f"{job} is left to do" for job in work.dry_run("tables", overlay=overlay)),
            *([f"{planned} jobs were announced, {len(ran)} ran"] if planned != len(ran) else []),
        ]

    def plan_of_setting(self, edit: ConfigEdit) -> list[str]:
        """Change a setting, and only plan: what is wrong with the plan's rules."""
        planned = self.plans.dry_run("tables", overlay=edit.overlay())
        return [*_otherwise_than({job.partition("/")[0] for job in edit.expected}, {*planned})]

    def plan_of_code(self, path: str) -> list[str]:
        """Add a constant to a module or a script, and only plan: what is wrong with the plan."""
        work = self.plans
        with work.restored(path):
            (work.directory / path).write_text((work.directory / path).read_text() + "\n_NEW = 1\n")
            planned = {_job(name) for name in work.planned()}
        of_tables = {job for job in planned if job.partition("/")[0] in TABLE_SCRIPTS}
        return [*_otherwise_than(self.jobs_with(module_of(path)), of_tables)]

    def jobs_with(self, module: str) -> set[str]:
        """Jobs that must run again when a module or script has changed."""
        if module == VERSION_OF_HARNESS:
            return set(ALL)
        if f"{module}.".startswith(HARNESS):
            return set()
        scripts = (name for name in self.loaded if name.endswith(".py"))
        return and_what_follows(
            {
                job
                for script in scripts
                for job in _jobs_of(script)
                if module == script or module in self._loaded_by(script, job)
            }
        )

    def _loaded_by(self, script: str, job: str) -> set[str]:
        """Modules that a script loads at its start, and those that its job finds by name."""
        loaded = self.loaded[script]
        if script == TABLES_OF_A_CASE:
            loaded = loaded | self.loaded[f"{MAKERS}.{job}"]
        by_name = {
            name
            for registry, names in FOUND_BY_NAME.items()
            if registry in loaded
            for name in names
        }
        whose = "esn" if job in JOBS_OF_NETWORKS else job.partition("/")[2].partition("/")[0]
        kind, _, role = whose.partition("-")
        registry, prefix = FORECASTERS_BY_NAME
        if registry in loaded and kind != "none" and role != "random":
            by_name.add(f"{prefix}{kind}")
        registry, prefix = STRATEGIES_BY_NAME
        if registry in loaded:
            by_name.update(f"{prefix}{name}" for name in STRATEGIES.get(job, ()))
        return loaded.union(*(self.loaded[name] for name in by_name))


def _otherwise_than(expected: set[str], rerun: set[str]) -> Iterator[str]:
    """What is wrong with the jobs that run again, in words."""
    if missing := expected - rerun:
        yield f"did not run again: {', '.join(sorted(missing))}"
    if needless := rerun - expected:
        yield f"ran again for nothing: {', '.join(sorted(needless))}"


def _job(log: str) -> str:
    """What the oracle calls the job of a log: with the kind that forecasts."""
    rule, *parts = log.removesuffix(".log").split("/")
    if rule not in _TOLD_APART:
        return rule
    # esn-N40-RV-seed0-random is esn-random
    job = f"{rule}/{re.sub(r'-(N[0-9]+|[A-Z]+|seed[0-9]+)', '', parts[1])}"
    strategy = parts[-1].partition("-")[0]
    return f"{job}/{strategy}" if f"{job}/{strategy}" in ALL else job


def _jobs_of(script: str) -> list[str]:
    """Jobs of a script; those for figures are none of the tables'."""
    if script.startswith("figures/"):
        return []
    if script == TABLES_OF_A_CASE:
        return list(TABLES_OF_CASES)
    rule = Path(script).stem
    return [*JOINED] if rule == "joined" else [job for job in ALL if job.partition("/")[0] == rule]


# -- what runs -------------------------------------------------------------------------------------

CONFIG_EDITS = {edit.name: edit for edit in config_edits()}


@pytest.fixture(scope="module")
def lab(tmp_path_factory, finished):
    return Laboratory(tmp_path_factory.mktemp("trials"), finished.project)


@pytest.mark.long
def test_a_setting_and_a_module_of_the_scores(lab):
    assert lab.run_of_setting(CONFIG_EDITS["classification.prediction_times_lt"]) == []
    recall = "ratio(self.true_positive, self.true_positive + self.false_negative)"
    edit = "src/burstcast/forecast/classification.py", recall, f"0.5 * {recall}"
    assert lab.run_of_code(*edit) == []
    assert replace(lab.base, directory=lab.directory / "work").tables() != lab.base.tables()


def test_edits_that_mean_nothing_run_nothing(lab):
    work = lab.base.copy(lab.directory / "nothing")
    for path in [
        *(work.directory / "src").rglob("*.py"),
        *(work.directory / "workflow/scripts").rglob("*.py"),
    ]:
        if path.is_file() and path.stat().st_size > 0:
            path.write_text(_reformatted(path.read_text()))
    for name in ("config.yaml", TINY):
        path = work.directory / name
        config = yaml.safe_load(path.read_text())
        path.write_text("# another comment\n" + yaml.safe_dump(_otherwise(config)))
    (work.directory / "Snakefile").touch()
    for path in work.directory.glob("workflow/rules/*.smk"):
        path.touch()
    assert work.dry_run("tables") == {}
    # a result that is touched is compared by its content, since it is small
    (work.results / "Re400" / "dataset.json").touch()
    assert work.dry_run("tables") == {}


def test_why_says_it_in_words(lab):
    work = lab.base.copy(lab.directory / "why")
    assert work.why("tables") == "Nothing would run: all results are up to date.\n"
    path = work.directory / "src/burstcast/forecast/classification.py"
    path.write_text(path.read_text() + "\nEDITED = 1\n")
    said = work.why("tables", overlay={"case_defaults": {"event_threshold": 0.08}}).splitlines()
    (threshold,) = [line for line in said if "event_threshold 0.07 -> 0.08 (Re400)" in line]
    assert "events (1), " in threshold
    assert "horizon (7), " in threshold
    module = "burstcast.forecast.classification"
    (code,) = [line for line in said if module in line]
    assert code.startswith(f"code of {module} changed")
    assert "classification_table (1), " in code


@pytest.mark.long
def test_another_campaign_takes_from_the_cache_what_it_shares(lab, tmp_path):
    network = "Re400/esn-N30-RV-seed0/forecaster.nc"
    first, second = (lab.base.without_results(lab.directory / name) for name in ("one", "other"))
    store = {"BURSTCAST_CACHE": str(tmp_path / "cache")}
    assert first.snakemake(f"results/tiny/{network}", **store).status == 0
    # elsewhere, with another threshold, which the networks do not depend on, and another noise
    for noise, hits in ((0.01, 4), (0.02, 1)):
        overlay = {
            "results": f"results/noise{noise}",
            "case_defaults": {"event_threshold": 0.08, "training": {"noise": noise}},
        }
        target = f"results/noise{noise}/{network}"
        assert second.snakemake(target, overlay=overlay, **store).status == 0
        logs = [path.read_text() for path in (second.directory / target).parents[2].rglob("*.log")]
        assert sum("taken from the cache" in text for text in logs) == hits
        same = (second.directory / target).read_bytes() == (first.results / network).read_bytes()
        assert same == (noise == 0.01)


def test_the_oracle_knows_every_rule_of_the_tables(lab):
    ran = {name.split("/")[0].removesuffix(".log") for name in lab.base.logs()}
    assert ran == TABLE_SCRIPTS == {name.split("/")[0] for name in ALL}


def test_every_module_is_in_some_trial():
    assert {str(path.relative_to(ROOT)) for path in (ROOT / "src").rglob("*.py")} <= {*code_files()}


def _reformatted(text: str) -> str:
    """Another text of the same code: comments, a docstring's words, blank lines."""
    lines = text.replace("\n\n\n", "\n\n\n\n# a comment\n").splitlines(keepends=True)
    if lines[0].startswith('"""'):
        lines[0] = '"""Other words. ' + lines[0].removeprefix('"""')
    return "".join(lines) + "# the end\n"


def _otherwise(value):
    """Equal settings, written otherwise: keys in another order, whole numbers with a point."""
    if isinstance(value, dict):
        return {key: _otherwise(value[key]) for key in reversed(value)}
    if isinstance(value, list):
        return [_otherwise(item) for item in value]
    # where the model wants a whole number, 3.0 is one, too
    return float(value) if type(value) is int else value


# -- everything ------------------------------------------------------------------------------------

EVERY_SETTING = pytest.mark.parametrize("name", CONFIG_EDITS)


@pytest.mark.long
@EVERY_SETTING
def test_every_setting(lab, name):
    assert lab.run_of_setting(CONFIG_EDITS[name]) == []


@pytest.mark.long
@EVERY_SETTING
def test_the_plan_of_every_setting(lab, name):
    assert lab.plan_of_setting(CONFIG_EDITS[name]) == []


@pytest.mark.long
@pytest.mark.parametrize("path", code_files())
def test_the_plan_of_every_module_and_script(lab, path):
    assert lab.plan_of_code(path) == []


@pytest.fixture(scope="module")
def another(finished, tmp_path_factory) -> Project:
    """The same campaign with another seed."""
    project = finished.project.copy(tmp_path_factory.mktemp("another") / "project")
    assert project.snakemake("tables", overlay={"random_seed": 7}).status == 0
    return project


@pytest.mark.long
@EVERY_SETTING
@pytest.mark.parametrize("what", ["deleted", "restored"])
def test_deleted_and_restored_files_hide_no_edit(lab, finished, another, tmp_path, name, what):
    """Whatever results are deleted, an edit makes at least the jobs run that it would run anyway.

    So it does if results are those of another run, or their records are, or both.
    """
    project = finished.project.copy(tmp_path / "project")
    chance = random.Random(f"{os.environ.get('BURSTCAST_SEED', 0)} {name}")
    parts = (["{}"], [".records/{}.json"], ["{}", ".records/{}.json"])[len(name) % 3]
    for path in sorted(project.results.glob("[!.]*/**/*.*")):
        result = path.relative_to(project.results)
        asked_for = result.parts[0] in (".records", "logs", "benchmarks", "tables")
        if not path.is_file() or asked_for or chance.random() >= 0.6:
            continue
        if what == "deleted":
            path.unlink()
        else:
            for part in (part.format(result) for part in parts):
                shutil.copy2(another.results / part, project.results / part)
    overlay = CONFIG_EDITS[name].overlay()
    with_all, jobs = (one.dry_run("tables", overlay=overlay) for one in (lab.plans, project))
    assert {rule: count for rule, count in with_all.items() if jobs.get(rule, 0) < count} == {}
    if what == "restored":
        assert project.dry_run("tables") != {}


# -- what an edit must not set off: the jobs that may run at all, written by hand ------------------

# What has rows of every forecaster, of those that control, and of networks.
GROUPS = {
    "GATHERED": """classification_table/* horizon_table/* warnings_table/*
        calibrate/* probability_scores/* reliability_table/* lead_times/*
        joined_forecasts joined_horizon joined_warnings joined_probabilities figure/reliability
        figure/classification_scores figure/horizon_by_size figure/forecast_skill""",
    "OF_CONTROL": """control_table/* control_density_table/* control_strategies_table/*
        joined_control figure/control_tradeoff figure/control_density figure/control_frontier""",
    "OF_LONG_RUNS": """statistics_table/* survival_table/* lyapunov_spectrum_table/*
        joined_long_term figure/own_flow warnings_table/* joined_warnings""",
    "OF_NETWORKS": """scan/* search/* train/* */esn-*
        figure/network_schematic figure/prediction_* figure/horizon_evaluations
        figure/midplane_planes figure/vorticity_isosurfaces figure/control_schematic
        figure/suppressed_event""",
}
GROUPS["ALL_OF_NETWORKS"] = f"""{GROUPS["GATHERED"]} {GROUPS["OF_CONTROL"]}
    {GROUPS["OF_LONG_RUNS"]} hyperparameters_table/* joined_networks
    figure/long_term_density figure/profile_errors figure/midplane_mean_square"""


class Edit(NamedTuple):
    """Another text in one place of a file; or a new file like another of its directory, renamed."""

    what: str
    path: str
    old: str
    new: str
    allowed: str = ""  # patterns of the jobs that may run, and groups of them


def edits_of(table):
    """Edits from lines: what, file, old text, new text, and jobs that may run."""
    for line in table.strip().replace("\n  ", " ").splitlines():
        what, path, *rest = (part.strip(" ") for part in line.split(" | "))
        path = path.replace("LIBRARY", "src/burstcast").replace(
            "WORKFLOW", "src/burstcast_workflow"
        )
        yield Edit(what, path, *(part.replace("\\n", "\n") for part in rest))


@pytest.fixture(scope="module")
def project(tmp_path_factory, finished) -> Project:
    """Finished results of the tiny preset, figures included."""
    made = finished.project.copy(tmp_path_factory.mktemp("whole") / "project")
    outcome = made.snakemake()
    assert outcome.status == 0, outcome.text[-3000:]
    assert made.planned() == set()
    return made


@contextmanager
def edited(project: Project, *edits: Edit) -> Iterator[None]:
    """Make edits, and take them back."""
    with project.restored(*(edit.path for edit in edits)):
        for edit in edits:
            if edit.what.startswith("a new "):
                text = (project.directory / edit.path).with_name(edit.old).read_text()
                (project.directory / edit.path).write_text(re.sub(*edit.new.split(" "), text))
            else:
                project.edit(edit.path, edit.old, edit.new)
        yield


def beyond(planned: set[str], allowed: str) -> set[str]:
    """Jobs that no pattern allows."""
    groups = (GROUPS.get(one, one).split() for one in allowed.split())
    patterns = [pattern for group in groups for pattern in group]
    return {job for job in planned if not any(fnmatchcase(job, one) for one in patterns)}


# -- nothing runs ----------------------------------------------------------------------------------

WITHOUT_EFFECT = [
    *edits_of(r"""
help of the command line | WORKFLOW/commands/command_line.py |
  help="the zip; <results>.zip if left out" | help="the archive"
another message of the harness | WORKFLOW/harness/job.py |
  "%s starts with settings %s" | "%s begins; its settings: %s"
the log in a module of the library that had none | LIBRARY/durations.py |
  import math\n | import logging\nimport math\n\nlogger = logging.getLogger(__name__)\n
a message in it, and other words of an error | LIBRARY/durations.py |
  raise ValueError(f"the leading Lyapunov exponent must be positive, not {exponent}") |
  logger.warning("%s", exponent)\n        raise ValueError(f"one is positive, not {exponent}")
words of an error of the library | LIBRARY/systems/integration.py |
  "an initial state is not finite" | "all initial states must be finite"
words of an error of the jobs | WORKFLOW/jobs/gather.py |
  remove it, and run again | remove it and run the workflow again
a check of lengths | WORKFLOW/config/case_checks.py | \n        if steps is None or steps:\n |
  \n        if steps == 3:\n            return ["a"]\n        if steps is None or steps:\n
caption of a figure | LIBRARY/figures/observable_and_density.py |
  Typical evolution of the observable | How the observable evolves
meaning of a column | workflow/tables.yaml |
  harmonic mean of precision and recall | 2 TP / (2 TP + FP + FN)
caption of a table in the report | workflow/tables.yaml |
  Counts and scores of the forecasts of each forecaster | Scores of each forecaster
a strategy of control that nobody uses | LIBRARY/control/strategies/probability_triggered.py |
  windows: float = 1.0 | windows: float = 2.0
a system that nobody uses | LIBRARY/systems/lorenz63.py | rho: float = 28.0 | rho: float = 29.0
a new forecaster | LIBRARY/forecasters/forever.py | persistence.py | Persistence Forever
a new strategy of control | LIBRARY/control/strategies/always.py | reactive.py | Reactive Always
a new strategy of validation | LIBRARY/tuning/strategies/last_series.py | single_shot.py | SSV LSV
a new system | LIBRARY/systems/decay.py | fitzhugh_nagumo.py | FitzHughNagumoPair Decay
""")
]


def test_edits_that_run_nothing(project):
    with edited(project, *WITHOUT_EFFECT):
        planned = project.planned()
    if planned:
        for count, edit in enumerate(WITHOUT_EFFECT, 1):  # which of them it was
            with edited(project, *WITHOUT_EFFECT[:count]):
                assert project.planned() == set(), edit.what
    assert planned == set()


# -- some run --------------------------------------------------------------------------------------

WITH_EFFECT = [
    *edits_of(r"""
a strategy of control | LIBRARY/control/strategies/receding_horizon.py |
  (ahead >= level) | (ahead >= 2.0 * level) | control/*/receding_horizon-*
  control_strategies_table/* joined_control figure/control_frontier
  figure/control_tradeoff
head of a column | workflow/tables.yaml | head: exceedance} | head: without control} |
  joined_control
format of a column | workflow/tables.yaml | empty without events, format: .3f |
  empty without events, format: .2f | joined_forecasts
caption of a LaTeX table | workflow/tables.yaml | Hyperparameters that the search chose. |
  The hyperparameters that were found. | joined_networks
order of the columns of a table | workflow/tables.yaml | [series, survived_fraction, escapes, |
  [series, escapes, survived_fraction, | survival_table/* joined_long_term figure/own_flow
columns side by side in tables for papers | LIBRARY/tables/latex.py | _COLUMNS = 4 | _COLUMNS = 5 |
  data_generation_parameters network_hyperparameters joined_*
a colour of one figure | LIBRARY/figures/control_tradeoff.py |
  panel.axhline(0, color=style.GREY | panel.axhline(0, color=style.PURPLE | figure/control_tradeoff
the equations as a forecaster | LIBRARY/forecasters/equations_noisy.py |
  return cls(case.system, *steps, case.parameters) |
  return cls(case.system, 1.0 * steps[0], steps[1], case.parameters) |
  */equations */equations/* */equations_noisy GATHERED OF_CONTROL
networks as a forecaster, neither data nor their search | LIBRARY/forecasters/esn.py |
  return self.network.forecast(memory, steps) |
  return self.network.forecast(memory.copy(), steps) |
  train/* forecast/*/esn-* calibration_forecast/*/esn-* horizon/*/esn-* long_term/*/esn-*
  lyapunov_spectrum/*/esn-* control/*/esn-* examples/* flow_event/* suppressed_event/*
  GATHERED OF_CONTROL OF_LONG_RUNS figure/long_term_density figure/profile_errors
  figure/midplane_* figure/prediction_* figure/horizon_evaluations figure/vorticity_isosurfaces
  figure/control_schematic figure/suppressed_event
the readouts of networks | LIBRARY/esn/readout.py |
  def _symmetric_norm(lower: FloatArray, rows_per_block: int = 256) |
  def _symmetric_norm(lower: FloatArray, rows_per_block: int = 128) | OF_NETWORKS ALL_OF_NETWORKS
the velocity profiles | LIBRARY/statistics/profiles.py |
  np.linspace(-1.0, 1.0, points) | np.linspace(-1, 1, points) |
  reference_statistics/* statistics_table/* joined_long_term warnings_table/*
  joined_warnings figure/long_term_density figure/profile_errors figure/midplane_*
  figure/suppressed_event figure/vorticity_isosurfaces
""")
]


@pytest.mark.parametrize("edit", WITH_EFFECT, ids=lambda edit: edit.what)
def test_edits_that_run_little(project, edit):
    with edited(project, edit):
        planned = project.planned()
    assert planned
    assert beyond(planned, edit.allowed) == set()


def test_one_more_seed_in_a_block_of_its_own(project):
    networks = {"neurons": [40], "validation": ["RV"], "seeds": 2}
    block = {"reynolds": [400], "forecasters": {"esn": networks}}
    planned = project.planned(overlay={"campaign": [*tiny_with()["campaign"], block]})
    assert "Re400/esn-N40-RV-seed1/forecaster.nc" in planned
    new = "Re400/*esn-N40-RV-seed1* Re400/scan/esn-N40-seed1-* control/*/esn-N40-RV-committee/*"
    assert beyond(planned, f"{new} ALL_OF_NETWORKS") == set()


# -- no job depends on a setting that it does not read ---------------------------------------------


def unread_settings(log: Path) -> set[str]:
    """Settings that a job says it did not read."""
    found = re.findall(r"settings not read: (.*)$", log.read_text(), re.M)
    return {name for line in found for name in line.split(", ")}


def test_every_setting_is_read_by_some_job_of_its_rule(project):
    logs = project.results / "logs"
    unread: dict[str, set[str]] = {}
    for log in logs.rglob("*.log"):
        rule = log.relative_to(logs).with_suffix("").parts[0]
        if rule == "figure":
            rule = f"figure {log.stem}"
        found = unread_settings(log)
        unread[rule] = unread.get(rule, found) & found
    assert {"simulate", "search", "control", "figure long_term_density"} <= unread.keys()
    assert {rule: names for rule, names in unread.items() if names} == {}
