"""Inputs and parameters of stages: functions of a job's wildcards, which Snakemake calls."""

import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, TypeAlias

from snakemake.exceptions import WorkflowError
from snakemake.io import local
from snakemake.iocontainers import Wildcards

from burstcast.base.declared import File, files_of, paths_of
from burstcast.base.discovery import suggestion
from burstcast.base.names import parsed
from burstcast.data.training_realisations import realisation_of
from burstcast.forecasters.registry import kind_class
from burstcast.tables.makers.registry import maker as maker_of
from burstcast_workflow.campaign.campaign import Campaign
from burstcast_workflow.campaign.job_settings import check_paths, settings_of_job
from burstcast_workflow.campaign.members import CaseForecaster, ControlRun
from burstcast_workflow.campaign.shown import Shown
from burstcast_workflow.harness.call import settings_taken
from burstcast_workflow.harness.job import function_of
from burstcast_workflow.harness.settings import covers, undeclared
from burstcast_workflow.snakemake_internals import of_wildcards, rules_of
from burstcast_workflow.tables.registry import cases_of, tables_of_maker, written
from burstcast_workflow.tracking.code import ByName, Sources

Paths: TypeAlias = str | list[str]
OfJob: TypeAlias = Callable[..., Any]
"""A function of a job's wildcards."""

ENVIRONMENT = "../envs/burstcast.yaml"
"""Environment of all jobs for ``--sdm conda``, from the files of rules."""

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


def any_of_regex(names: Iterable[str]) -> str:
    """Regular expression of a wildcard that is one of these names."""
    return "|".join(map(re.escape, names)) or "(?!)"


class Stages:
    """Files, settings and code of the stages of a campaign."""

    def __init__(self, campaign: Campaign, sources: Sources) -> None:
        self.campaign, self._sources = campaign, sources
        self.results: str = campaign.config.results

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
        directory = self.campaign.search_source(network).directory
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

    def computed_exponents(self, wildcards: Any) -> Paths:
        """Computed exponents that set a case's unit of time; nothing where it is given."""
        return self.in_results(self.campaign.cases[wildcards.case].computed_exponents)

    # -- settings and code -------------------------------------------------------------------------

    def settings(self, *paths: str, **values: Any) -> "RuleSettings":
        """Settings of a rule's jobs by their paths in the config, where they concern the job.

        A path of a section stands for all settings in it. ``values``: Given as they are.
        """
        try:
            check_paths(paths)
        except LookupError as error:
            raise WorkflowError(error.args[0]) from None
        return RuleSettings(self.campaign, paths, values)

    def settings_of_table(self, maker: str) -> "RuleSettings":
        """Settings of a maker of tables: as it declares them, and the columns of its tables."""
        tables = written(tables_of_maker(maker), self.campaign.unused_columns)
        paths = [path for path in paths_of(maker_of(maker)) if path != "case"]  # a wildcard
        return self.settings("case.parameters", *paths, tables=tables)

    def code(self, script: str, by_name: ByName) -> OfJob:
        """Hashes of a script, and of what it uses of each module, for the jobs of a rule.

        ``by_name``: Modules that all jobs of the rule reach by a name, by the package of their
        registry, beside what follows from the wildcards.
        """
        self.read_code(script, by_name)
        return _once(lambda wildcards: self.code_of(script, wildcards, by_name))

    def read_code(self, script: str, by_name: ByName) -> None:
        """Read the code of all jobs of a rule while rules are read, so that it is remembered."""
        self._sources.code(script, {**self.campaign.all_modules(), **by_name})

    def code_of(self, script: str, wildcards: Any, by_name: ByName) -> dict[str, str]:
        """Hashes of the code of one job (`code`)."""
        return self._sources.code(script, {**self.campaign.modules(wildcards), **by_name})

    def complete(self, workflow: Any) -> None:
        """Give rules what all share, the code of their scripts and the environment of jobs.

        A rule that names other settings than its script reads is refused.
        """
        for rule in rules_of(workflow):
            if not rule.script:
                continue
            script = str(rule.script).removeprefix("../scripts/")
            if "code" not in dict(rule.params.items()):
                maker = rule.params.get("maker")
                by_name = {"burstcast.tables.makers": [maker]} if maker else {}
                rule.set_params(code=self.code(script, by_name))
            rule.conda_env = ENVIRONMENT
            if workflow.is_main_process:  # jobs of a cluster read the rules that it has checked
                self._check(rule, function_of(self._sources.script(script)))

    def _check(self, rule: Any, function: Callable[..., None]) -> None:
        """Compare the settings that a rule names with what its script reads."""
        named, kind = rule.params.settings, settings_taken(function)
        if not isinstance(named, RuleSettings):
            return  # of figures, which declare their own
        maker = rule.params.get("maker")
        read = [*kind.paths(), *(paths_of(maker_of(maker)) if maker else [])]
        read = [path for path in read if path not in rule.wildcard_names]
        problems = [
            f"its script reads {path}, which the rule does not name{suggestion(path, named.names)}"
            for path in undeclared(named.names, read)
        ]
        problems += [
            f"no script reads {name}, which it names{suggestion(name, read)}"
            for name in named.names
            if not any(covers(name, path) for path in read)
        ]
        inputs = dict(rule.input.items())
        lacking = [name for name in kind.files() if name not in inputs]
        problems += [f"its script reads {name}, which is none of its inputs" for name in lacking]
        if problems:
            raise WorkflowError(f"rule {rule.name}: {'; '.join(problems)}")


class RuleSettings:
    """Settings of a rule, a function of a job's wildcards: values by path."""

    def __init__(self, campaign: Campaign, paths: Sequence[str], values: Mapping[str, Any]) -> None:
        self.names = [*dict.fromkeys([*paths, *values])]
        self._of_job = _once(
            # Snakemake's wildcards are a list: only of a mapping can one ask whether it has a name
            lambda wildcards: settings_of_job(campaign, paths, dict(wildcards.items()), values)
        )
        of_wildcards(self)

    def __call__(self, wildcards: Any) -> dict[str, Any]:
        """Values that concern a job, by their paths."""
        values: dict[str, Any] = self._of_job(wildcards)
        return values
