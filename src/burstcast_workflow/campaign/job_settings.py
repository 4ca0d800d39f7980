"""Settings of a job by their paths: their values, and which do not concern it."""

import inspect
import os
from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import cache, cached_property
from itertools import chain
from pathlib import Path
from typing import Any, get_args, get_origin

from burstcast.base.discovery import suggestion
from burstcast.base.names import ForecasterName
from burstcast.data.training_realisations import realisation_of
from burstcast.forecasters.registry import kind_class
from burstcast_workflow.campaign.campaign import Campaign, name_of
from burstcast_workflow.campaign.shown import Shown
from burstcast_workflow.config.case import Case, Measured, Simulated
from burstcast_workflow.config.control_plans import ControlPlan
from burstcast_workflow.config.kinds import Section
from burstcast_workflow.config.model import Configuration
from burstcast_workflow.harness.canonical import canonical
from burstcast_workflow.harness.settings import JobSettings
from burstcast_workflow.tracking.results import digest

LEFT_OUT = object()
"""Value of a setting that does not concern a job."""

_computed: dict[str, Callable[["Job"], Any]] = {}


def value_of_setting(path: str) -> Callable[[Callable[["Job"], Any]], property]:
    """Declare a property of jobs as the value of a setting that is not the config's as it is."""

    def property_of(value: Callable[["Job"], Any]) -> property:
        _computed[path] = value
        return property(value)

    return property_of


class NameWithoutSize(ForecasterName):
    """Name of all networks that differ in size and seed alone: settings are the same for them."""

    def __getattribute__(self, attribute: str) -> Any:
        if attribute in ("neurons", "seed", "identifier", "keys"):
            raise ValueError(
                f"{attribute} of a network is no setting of its jobs: networks that differ in size "
                f"and seed alone have the same settings, and a job has its name as a wildcard"
            )
        return super().__getattribute__(attribute)

    def __repr__(self) -> str:
        return f"networks of {self.kind}, of any size and seed"


class Job:
    """A job by its wildcards: its case, its forecaster or controller, its plan of control."""

    def __init__(self, campaign: Campaign, wildcards: Mapping[str, str]) -> None:
        self.campaign, self.wildcards = campaign, wildcards
        self.case_name = wildcards.get("case", "")  # empty for jobs of none

    @property
    def case(self) -> Case:
        """Case that the job is of."""
        return self.campaign.cases[self.case_name]

    @property
    def plain_case(self) -> dict[str, Any]:
        """Settings of the case as they are given to jobs."""
        return self.campaign.plain_cases[self.case_name]

    @cached_property
    def name(self) -> ForecasterName:
        """Forecaster or controller of the job, or the network that its reservoir is for."""
        name = name_of(self.wildcards)
        return NameWithoutSize(
            name.kind, validation=name.validation, role=name.role, label=name.label
        )

    @cached_property
    def plan(self) -> ControlPlan | None:
        """Plan of control; None for jobs of others."""
        strategy = self.wildcards.get("strategy")
        return None if strategy is None else self.campaign.plan(strategy)

    @property
    def observed(self) -> str:
        """Case that is the observed part of the controlled one; empty: all of it is observed."""
        return self.plan.observed if self.plan else ""

    @cached_property
    def sees_truth(self) -> bool:
        """Whether no noise concerns the forecaster: networks have learnt from noisy series."""
        kind = kind_class(self.name.kind) if self.name.asks_forecasters else None
        return kind is not None and kind.sees_truth and not kind.has_search

    def setting(self, path: str) -> Any:
        """Value of a setting; `LEFT_OUT` if it does not concern the job.

        A path has keys of the config, or of the job's case, and then names of properties: of the
        case (``case.space.dimension``), the job (``job.noise_of_data``), what is shown
        (``shown.panels``).
        """
        section, *rest = path.split(".")
        for count in range(len(rest) + 1):
            if (start := ".".join([section, *rest[:count]])) in _computed:
                whole = _computed[start](self)
                return whole if whole is LEFT_OUT else _below(whole, rest[count:])
        try:
            if section == "case":
                value: Any = self.plain_case if rest[0] in self.plain_case else self.case
            elif section == "forecasters":
                value = self.campaign.sections(self.case_name, self.name.label)
            elif section == "shown":
                value = Shown(self.campaign, self.case_name)
            else:
                value = self if section == "job" else self.campaign.plain[section]
            return _below(value, rest)
        except (KeyError, AttributeError) as error:
            raise LookupError(f"there is no setting {path}") from error

    # -- settings that are not the config's as they are --------------------------------------------

    @property
    def all_options(self) -> dict[str, Any]:
        """Settings of the forecaster's kind."""
        return self.campaign.options(self.name.kind, self.case_name, self.name.label)

    @value_of_setting("forecaster.options")
    def options(self) -> Any:
        """Settings of the forecaster's kind, but for the bound of divergence, if there is one."""
        if "controller" in self.wildcards and not self.name.asks_forecasters:
            return LEFT_OUT
        options = self.all_options.items()
        return {name: value for name, value in options if name != "divergence_bound"}

    @value_of_setting("forecaster.divergence_bound")
    def divergence_bound(self) -> float | None:
        """Bound beyond which a network's forecast is invalid; None for other kinds."""
        if "controller" in self.wildcards and not self.name.asks_forecasters:
            return None
        bound: float | None = self.all_options.get("divergence_bound")
        return bound

    @value_of_setting("forecaster.source")
    def forecaster_source(self) -> Any:
        """Source of the case, if the forecaster goes on with equations from decoded states."""
        solves = self.name.asks_forecasters and kind_class(self.name.kind).needs_equations
        seen = self.campaign.cases.get(self.observed or self.case_name)
        decodes = solves and seen is not None and seen.is_encoded
        return self.case.source_system if decodes else LEFT_OUT

    @value_of_setting("forecasters.aware")
    def aware(self) -> Any:
        """What forecasters learn of parameters, with the case's values, if they are given any."""
        if not self.name.asks_forecasters:
            return LEFT_OUT
        given = self.plan and self.plan.strategy.informed
        switched = self.case_name in self.campaign.where(is_switched=True)
        if not (given or switched or kind_class(self.name.kind).learns_parameters):
            return LEFT_OUT
        aware = self.campaign.sections(self.case_name)["aware"]
        return {**aware, "own": self.campaign.own_values(self.case_name)}

    @value_of_setting("case.training.noise")
    def noise(self) -> Any:
        """Noise of the training series, if the forecaster sees it."""
        return LEFT_OUT if self.sees_truth else self.plain_case["training"]["noise"]

    @value_of_setting("case.controlled_density")
    def controlled_density(self) -> Any:
        """Bins of the densities under control, which are made of the paper's control alone."""
        papers = self.plan is None or self.plan.is_of_the_paper
        return self.plain_case["controlled_density"] if papers else LEFT_OUT

    @value_of_setting("statistics.duration")
    def duration(self) -> float | None:
        """Duration of long runs; without one, that of the case's series."""
        duration = self.campaign.config.statistics.duration
        return self.plain_case["ensemble"]["duration"] if duration is None else duration

    @value_of_setting("control.run")
    def run(self) -> dict[str, Any]:
        """Plan of control; the noise is the case's if it has none, and unused for seen truth."""
        assert self.plan is not None
        run = self.plan.record(self.campaign.config.control.span_lt)
        if run["noise"] is None:
            del run["noise"]
            if not self.sees_truth:
                run["noise"] = self.case.training.noise
        return run

    @value_of_setting("control.cost")
    def cost(self) -> Any:
        """Whether the cost of actuation is counted."""
        return self.campaign.config.control.cost or LEFT_OUT

    @value_of_setting("control.sensor")
    def sensor(self) -> Any:
        """Sensor of the observed part."""
        return self.campaign.cases[self.observed].sensor if self.observed else LEFT_OUT

    # -- settings of no section, ``job.<name>`` ----------------------------------------------------

    @property
    def parameters(self) -> list[str]:
        """Parameters that forecasters may know, also where the case has known columns instead."""
        return self.campaign.config.forecasters.aware.parameters

    @property
    def noise_of_data(self) -> dict[str, Any] | None:
        """Observation noise that series of the case get when they are imported; None if none."""
        level = self.case.imported_noise
        return {"level": level, "random_seed": self.campaign.config.random_seed} if level else None

    @property
    def contents_of_data(self) -> list[list[str]]:
        """Names and digests of the files that measured series come in."""
        files = self.case.data.paths if self.case.data else []
        return [[Path(file).name, _digest(file)] for file in files]

    @property
    def drawn_shares(self) -> dict[str, Any] | None:
        """Shares of events that the choices up to a case's are drawn for; None: blocks of series.

        Each choice leaves the later ones other series.
        """
        source, _ = realisation_of(self.case_name)
        shares = self.campaign.config.event_shares_of(source)[: self.case.realisation]
        return {"shares": shares, "threshold": self.case.event_threshold} if shares else None

    @property
    def asked_of_series(self) -> dict[str, Any]:
        """Kinds, validation strategies and long runs of a case, for which series must be long."""
        forecasters = self.campaign.select(case=self.case_name)
        long_runs = {forecaster.case for forecaster in self.campaign.long_term_forecasters}
        strategies = {forecaster.name.validation for forecaster in forecasters}
        return {
            "kinds": sorted({forecaster.name.kind for forecaster in forecasters}),
            "validations": sorted(filter(None, strategies)),
            "long_runs": self.case_name in long_runs,
        }


def _below(value: Any, keys: Iterable[str]) -> Any:
    """What stands at some keys in a value, or is a property of it."""
    for key in keys:
        value = value[key] if isinstance(value, dict) else getattr(value, key)
    return value


@cache
def _digest(file: str) -> str:
    """Digest of a data file, once while a run is planned; empty if it is not there."""
    return digest(file) if os.path.exists(file) else ""


def check_paths(paths: Iterable[str]) -> None:
    """Check that there are settings at these paths, for some job (a LookupError with similar ones).

    Of what is no plain setting but a property, of a case, a job, or what is shown, only the name is
    checked.
    """
    for path in paths:
        parts = path.split(".")
        starts = {".".join(parts[: count + 1]) for count in range(len(parts))}
        if path not in _settings() and not starts & _properties():
            similar = suggestion(path, _settings() | _properties())
            raise LookupError(f"there is no setting {path}{similar}")


@cache
def _settings() -> frozenset[str]:
    """Paths of all sections and settings of configurations, and of cases of any kind."""
    of_cases = (_paths_of(kind, "case.") for kind in (Simulated, Measured))
    return frozenset(chain(_paths_of(Configuration, ""), *of_cases))


def _paths_of(model: type[Section], start: str) -> Iterator[str]:
    for name, field in model.model_fields.items():
        yield f"{start}{name}"
        for kind in _kinds_in(field.annotation):
            yield from _paths_of(kind, f"{start}{name}.")


def _kinds_in(annotation: Any) -> Iterator[type[Section]]:
    """Sections among the types of a setting: itself, or in a union; none of what lists have."""
    if isinstance(annotation, type):
        if issubclass(annotation, Section):
            yield annotation
    elif get_origin(annotation) is not list:
        for part in get_args(annotation):
            yield from _kinds_in(part)


@cache
def _properties() -> frozenset[str]:
    """Paths whose values are computed: properties of cases, of jobs, of what is shown."""
    owners = [("case", Simulated), ("case", Measured), ("job", Job), ("shown", Shown)]
    names = {f"{section}.{name}" for section, owner in owners for name in names_of(owner)}
    return frozenset(names | {*_computed})


def names_of(owner: type) -> list[str]:
    """Names of the properties of a class, by which settings, places and cases are addressed."""
    members = ((name, inspect.getattr_static(owner, name)) for name in dir(owner))
    return [
        name
        for name, member in members
        if isinstance(member, property | cached_property) and not name.startswith("_")
    ]


def settings_of_job(
    campaign: Campaign,
    paths: Iterable[str],
    wildcards: Mapping[str, str],
    values: Mapping[str, Any] | None = None,
) -> dict[str, Any]:
    """Settings of a job by their paths, in canonical form, without what does not concern it.

    ``forecasters.`` stands for the sections of kinds as the job's network has them. ``values`` are
    given as they are, beside them.
    """
    job = Job(campaign, wildcards)
    asked = {path: job.setting(path) for path in paths}
    concerning = {path: value for path, value in asked.items() if value is not LEFT_OUT}
    result: dict[str, Any] = canonical({**concerning, **(values or {})})
    return result


def settings_of_cases(
    campaign: Campaign, settings: type[JobSettings], cases: Iterable[str] | None = None
) -> dict[str, dict[str, Any]]:
    """Settings of all cases, or of some, by the name of the case: those of a class."""
    cases = campaign.case_names if cases is None else cases
    return {case: settings_of_job(campaign, settings.paths(), {"case": case}) for case in cases}
