"""Inputs and parameters of stages: functions of a job's wildcards, which Snakemake calls."""

import json
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from pathlib import Path
from typing import Any, TypeAlias

from snakemake.exceptions import WorkflowError
from snakemake.io import local
from snakemake.iocontainers import Wildcards

from burstcast.base.declared import File, files_of, paths_of
from burstcast.base.names import parsed
from burstcast.data.training_realisations import realisation_of
from burstcast.forecasters.registry import kind_class
from burstcast.tables.makers.registry import maker as maker_of
from burstcast_workflow.campaign.campaign import Campaign
from burstcast_workflow.campaign.job_settings import settings_of_job
from burstcast_workflow.campaign.members import CaseForecaster, ControlRun
from burstcast_workflow.campaign.shown import Shown
from burstcast_workflow.harness.call import settings_taken
from burstcast_workflow.harness.job import function_of
from burstcast_workflow.harness.settings import THRESHOLDS, TIME_UNIT, cases_of_thresholds
from burstcast_workflow.snakemake_internals import of_wildcards
from burstcast_workflow.tables.registry import cases_of, made_by, written
from burstcast_workflow.tracking.code import Sources

Paths: TypeAlias = str | list[str]
OfJob: TypeAlias = Callable[..., Any]
"""A function of a job's wildcards."""


_FORECASTERS = ("forecaster", "controller", "reservoir")
"""Wildcards that name a forecaster, or the network that a reservoir is for."""


def _once(function: OfJob) -> OfJob:
    """A function of wildcards, called once for all networks that differ in size and seed alone.

    It is given names without these, so that what it returns cannot depend on them; a campaign has
    hundreds of such networks.
    """
    by_kind: dict[tuple[str, ...], Any] = {}
    known: dict[tuple[str, ...], Any] = {}

    @of_wildcards
    def remembered(wildcards: Any) -> Any:
        values = tuple(wildcards)
        if values not in known:
            without_size = {
                name: _without_size(value) if name in _FORECASTERS else value
                for name, value in wildcards.items()
            }
            kind = tuple(without_size.values())
            if kind not in by_kind:
                by_kind[kind] = function(Wildcards(fromdict=without_size))
            known[values] = by_kind[kind]
        return known[values]

    return remembered


def _without_size(identifier: str) -> str:
    """Name of a forecaster without its size and seed."""
    return replace(parsed(identifier), neurons=None, seed=None).identifier


def _one(texts: OfJob, key: str) -> OfJob:
    """One of a job's parameters; empty where it does not concern the job."""
    return of_wildcards(lambda wildcards: texts(wildcards).get(key, ""))


def any_of_regex(names: Iterable[str]) -> str:
    """Regular expression of a wildcard that is one of these names."""
    return "|".join(map(re.escape, names)) or "(?!)"


class Stages:
    """Files, settings and code of the stages of a campaign."""

    def __init__(self, campaign: Campaign, sources: Sources) -> None:
        self.campaign, self._sources = campaign, sources
        self.results: str = campaign.config.results
        self._settings: dict[str, OfJob] = {}  # of each stage

    # -- files -------------------------------------------------------------------------------------

    def in_results(self, paths: str | Iterable[str]) -> Paths:
        """Paths, or one path, below the results directory."""
        if isinstance(paths, str):
            return f"{self.results}/{paths}"
        return [f"{self.results}/{path}" for path in paths]

    def case_files(self, name: str, cases: Iterable[str] | None = None) -> Paths:
        """The file called ``name`` of cases; default: all cases of the campaign."""
        cases = self.campaign.case_names if cases is None else cases
        return self.in_results(f"{case}/{name}" for case in cases)

    def forecaster_files(
        self, name: str, forecasters: Iterable[CaseForecaster | ControlRun] | None = None
    ) -> Paths:
        """The file called ``name`` of forecasters or runs of control; default: all forecasters."""
        forecasters = self.campaign.forecasters if forecasters is None else forecasters
        return self.in_results(f"{forecaster.directory}/{name}" for forecaster in forecasters)

    def declared(self, file: File) -> OfJob:
        """A declared file of a job's case; nothing where it is a table that the case lacks."""
        table = Path(file.path).stem if "/tables/" in file.path else ""

        @of_wildcards
        def paths(wildcards: Any) -> Paths:
            if table and wildcards.case not in cases_of(self.campaign, table):
                return []
            return self.in_results(Shown(self.campaign, wildcards.case).paths(file))

        return paths

    def inputs_of_tables(self, maker: str) -> dict[str, OfJob]:
        """Files that a maker of tables declares, by name."""
        return {name: self.declared(file) for name, file in files_of(maker_of(maker)).items()}

    def table_files(self, table: str) -> Paths:
        """A table of each case that has it."""
        return self.case_files(f"tables/{table}.csv", cases_of(self.campaign, table))

    def scan_of_network(self, suffix: str) -> OfJob:
        """A file of the scan that a network's search continues."""

        @of_wildcards
        def path(wildcards: Any) -> Paths:
            reservoir, strategies = self.campaign.scan_of(wildcards.forecaster)
            return self.in_results(f"{wildcards.case}/scan/{reservoir}/{strategies}.{suffix}")

        return path

    def hyperparameters(self, wildcards: Any) -> Paths:
        """Result of the search that a network's hyperparameters come from."""
        network = CaseForecaster(wildcards.case, parsed(wildcards.forecaster))
        directory = self.campaign.searched(network).directory
        return self.in_results(f"{directory}/hyperparameters.json")

    def scheduled(self, wildcards: Any) -> Paths:
        """Scheduled series for a kind that learns from parameters; nothing for other kinds."""
        names = dict(wildcards.items())
        name = parsed(names.get("forecaster") or names["reservoir"])
        kind = kind_class(name.kind)
        if not kind.has_trajectories:
            raise WorkflowError(
                f"{name.identifier} gives probabilities of events and forecasts no states: its "
                f"files are those of {names['case']}/classifiers/{name.identifier}"
            )
        if not kind.learns_parameters:
            return []
        return self.case_files("scheduled_series.nc", self.campaign.sources(names["case"]))

    def ensemble_of_source(self, wildcards: Any) -> Paths:
        """The ensemble that a case with its own draw of training series draws them from."""
        return self.in_results(f"{realisation_of(wildcards.case)[0]}/ensemble.nc")

    def sources_of_data(self, wildcards: Any) -> Any:
        """Files that the measured series of a case come in."""
        case = self.campaign.cases[wildcards.case]
        if case.source is not case:
            return [self.in_results(f"{case.source.name}/ensemble.nc")]
        return [local(path) for path in case.data.paths] if case.data else []

    def controlling(self, wildcards: Any) -> Paths:
        """Forecasters that the controller of a job asks."""
        asked = self.campaign.controlling(wildcards.case, wildcards.controller, wildcards.strategy)
        return self.forecaster_files("forecaster.nc", asked)

    def matched_flows(self, wildcards: Any) -> Paths:
        """Flows under the forecaster's own control, whose rate of alarms random control matches."""
        forecaster, _, role = wildcards.controller.rpartition("-")
        flows = f"{wildcards.case}/control/{forecaster}/{wildcards.strategy}/flows.nc"
        return self.in_results(flows if role == "random" else [])

    def encoder_of_observed(self, wildcards: Any) -> Paths:
        """Encoder of the case through which a run of control observes; nothing without one."""
        part = self.campaign.plan(wildcards.strategy).observed
        encoded = part in self.campaign.where(is_encoded=True)
        return self.in_results(f"{part}/encoder.nc" if encoded else [])

    # -- what settings leave to other jobs ---------------------------------------------------------

    @cached_property
    def has_quantiles(self) -> bool:
        """Whether a threshold is a quantile; only then are the settings of all jobs searched."""
        return any(case.event_quantile is not None for case in self.campaign.cases.values())

    def thresholds_of(self, settings: Any) -> Paths:
        """Files of the event thresholds that a job's settings have as quantiles."""
        return self.case_files("event_threshold.json", cases_of_thresholds(settings))

    def computed_settings_files(self, stage: str) -> dict[str, OfJob]:
        """Inputs of a stage: files of thresholds and units of time that other jobs determine.

        These are functions of each job, which take time: they are left out if no case needs them.
        """

        @of_wildcards
        def thresholds(wildcards: Any) -> Paths:
            return self.thresholds_of(self._settings[stage](wildcards))

        @of_wildcards
        def time_unit(wildcards: Any) -> Paths:
            measures_time = "case.lyapunov.time_unit" in self._settings[stage](wildcards)
            if not measures_time:
                return []
            return self.in_results(self.campaign.cases[wildcards.case].time_unit)

        files = {THRESHOLDS: thresholds} if self.has_quantiles else {}
        if any(case.time_unit for case in self.campaign.cases.values()):
            files[TIME_UNIT] = time_unit
        return files

    # -- settings and code ------------------------------------------------------------------------

    def of_script(
        self, script: str, stage: str = "", *, maker: str = "", **values: Any
    ) -> list[Any]:
        """Parameters of a script's jobs: each setting, and each module of the code that runs.

        Each is a text, ``path = value`` or ``module @hash``: the reasons name the ones that
        have changed. Settings are those of the class that the script's function takes.

        ``stage``: Name of the rule, if it is not the script's. ``maker``: Module of
        `burstcast.tables.makers`, whose function declares further settings, and whose tables are
        declared with their columns. ``values``: Given as they are.
        """
        declared = settings_taken(function_of(self._sources.script(script))).paths()
        by_name: dict[str, list[str]] = {}
        if maker:
            by_name = {"burstcast.tables.makers": [maker]}
            of_maker = paths_of(maker_of(maker))
            declared += [path for path in of_maker if path != "case"]  # a wildcard
            values["tables"] = written(made_by(maker), self.campaign.unused_columns)

        def settings(wildcards: Any) -> Any:
            asked = [path for path in declared if path not in values]
            # Snakemake's wildcards are a list: only of a mapping can one ask whether it has a name
            return settings_of_job(self.campaign, asked, dict(wildcards.items()), values)

        def modules(wildcards: Any) -> Mapping[str, Sequence[str]]:
            return {**self.campaign.modules(wildcards), **by_name}

        everything = {**self.campaign.all_modules(), **by_name}
        stage = stage or Path(script).stem
        self._settings[stage] = _once(settings)
        return self.parameters(
            script, [*declared, *values], self._settings[stage], modules, everything
        )

    def parameters(
        self,
        script: str,
        paths: Iterable[str],
        settings: OfJob,
        modules: OfJob,
        everything: Mapping[str, Sequence[str]],
    ) -> list[Any]:
        """Parameters of jobs, by functions of their settings and of modules found by name."""
        code = self._sources.entries
        least, most = code(script, {}), code(script, everything)
        # the same for all jobs of the script: the more modules a job reaches, the more definitions
        same = [entry for entry in most if entry in least]
        others = sorted({_name(entry) for entry in most if entry not in least})
        texts = _once(
            lambda wildcards: {
                path: f"{path} = {json.dumps(value, ensure_ascii=False)}"
                for path, value in settings(wildcards).items()
            }
        )

        @_once
        def reached(wildcards: Any) -> dict[str, str]:
            entries = {*code(script, modules(wildcards))} - {*same}
            by_entry = {_name(entry): entry for entry in entries}
            assert by_entry.keys() <= {*others}, f"{script} reaches more for {wildcards}"
            return by_entry

        return [
            *(_one(texts, path) for path in dict.fromkeys(paths)),
            *same,
            *(_one(reached, name) for name in others),
        ]


def _name(entry: str) -> str:
    """Name of a module, script, file or library in an entry of code."""
    return re.split(r" @| ==", entry)[0]
