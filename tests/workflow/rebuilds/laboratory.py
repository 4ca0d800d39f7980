"""Edits of settings and of code, finished results of the tiny preset, and what runs again."""

import copy
import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

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
from helpers_configs import ROOT, tiny_with
from helpers_rebuilds import Project, jobs_since
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
    *("probability_diagrams", "lead_times"),
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
    "cases.Re400.recycle_validation.series": 3,
    "cases.Re400.lyapunov.published_exponent": 0.0174,
    "forecasters.esn.backend": "compiled",
    "forecasters.esn.input_range": "first",
    "forecasters.esn.readout": "quadratic",
    "forecasters.esn.leak_rate": [1, 0.5],
    "forecasters.variants": {"quadratic": {"readout": "quadratic"}},
    "forecasters.precursor.classifier": "logistic",
    "forecasters.precursor.degree": 1,
    "forecasters.aware.parameters": ["length_x"],
    "forecasters.aware.transform": "identity",
    "forecasters.observation.noise": 0.02,
    "forecasters.filter.members": 24,  # an even number
    "forecasters.filter.inflation": 1.02,
    "forecasters.quadratic.degree": 1,
    "search.spectral_radius": [0.2, 1],
    "search.input_scaling": [0.2, 10],
    "search.tikhonov": [1e-6, 1e-9],
    "search.grid": 3,
    "search.interval_lt": 1.5,
    "search.choice": "survival",
    "search.surrogate.variance": [0.1, 3],
    "search.surrogate.length_scale": [0.01, 10],
    "search.surrogate.first_length_scale": 0.2,
    "search.surrogate.random_state": 10,
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
    # what a network is trained with is in another file, and all that comes of it
    "search.choice": {"survival_choice", "train", "hyperparameters_table"},
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
            followed = TABLES | {"train"} if name == "search.choice" else TABLES
            expected = _EXPECTED[name] | and_what_follows(_EXPECTED[name] & followed)
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
