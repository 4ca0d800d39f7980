"""Settings of a job by their paths: their values, and which do not concern it."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import cached_property
from typing import Any

from burstcast.forecasters._names import ForecasterName
from burstcast.forecasters.registry import kind_class
from burstcast_workflow.campaign.campaign import Campaign, name_of
from burstcast_workflow.config.control_plans import ControlPlan
from burstcast_workflow.harness.canonical import canonical


class JobFacts:
    """A job by its wildcards: its case, its forecaster or controller, its plan of control."""

    def __init__(self, campaign: Campaign, wildcards: Mapping[str, str]) -> None:
        self.campaign, self.wildcards = campaign, wildcards

    @property
    def case(self) -> str:
        """Name of the case; empty for jobs of none."""
        return self.wildcards.get("case", "")

    @cached_property
    def name(self) -> ForecasterName:
        """Forecaster or controller of the job, or the network that its reservoir is for."""
        return name_of(self.wildcards)

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

    def value(self, path: str) -> Any:
        """Value of a setting that concerns the job."""
        if path in _VALUES:
            return _VALUES[path](self)
        section, *rest = path.split(".")
        if section == "case":
            value: Any = self.campaign.plain_cases[self.case]
        elif section == "forecasters":
            value = self.campaign.sections(self.case, self.name.label)
        else:
            value = self.campaign.plain[section]
        for key in rest:
            value = value[key]
        return value


def settings_of_job(
    campaign: Campaign,
    paths: Iterable[str],
    wildcards: Mapping[str, str],
    values: Mapping[str, Any] | None = None,
) -> dict[str, Any]:
    """Settings of a job by their paths in the config, in canonical form.

    ``case.`` stands for the job's case, ``forecasters.`` for the sections of kinds as the job's
    network has them. What does not concern the job is left out. ``values`` are given as they are,
    beside them.
    """
    job = JobFacts(campaign, wildcards)
    found = {
        path: job.value(path) for path in paths if path not in _CONCERNS or _CONCERNS[path](job)
    }
    result: dict[str, Any] = canonical({**found, **(values or {})})
    return result


def settings_of_cases(
    campaign: Campaign, paths: Sequence[str], cases: Iterable[str] | None = None
) -> dict[str, dict[str, Any]]:
    """Settings of all cases, or of some, by the name of the case."""
    cases = campaign.case_names if cases is None else cases
    return {case: settings_of_job(campaign, paths, {"case": case}) for case in cases}


# -- settings that concern some jobs only ----------------------------------------------------------


def _is_told_parameters(job: JobFacts) -> bool:
    """Whether a job's forecaster learns about parameters, or is given those in force."""
    if not job.name.asks_forecasters:
        return False
    plan = job.plan
    told = plan and plan.strategy.told
    switched = job.case in job.campaign.switched_cases
    return bool(told) or switched or kind_class(job.name.kind).learns_parameters


def _decodes(job: JobFacts) -> bool:
    """Whether the forecaster goes on with equations from decoded states of another case."""
    seen = job.campaign.cases.get(job.observed or job.case)
    solves = job.name.asks_forecasters and kind_class(job.name.kind).needs_equations
    return solves and seen is not None and seen.is_encoded


_CONCERNS: Mapping[str, Callable[[JobFacts], bool]] = {
    "case.training.noise": lambda job: not job.sees_truth,
    "forecasters.aware": _is_told_parameters,
    "forecaster.source": _decodes,
    # controllers may ask no forecaster
    "forecaster.options": lambda job: (
        "controller" not in job.wildcards or job.name.asks_forecasters
    ),
    "control.cost": lambda job: job.campaign.config.control.cost,
    "control.sensor": lambda job: bool(job.observed),
    # densities are made of the paper's control alone
    "case.controlled_density": lambda job: job.plan is None or job.plan.is_of_the_paper,
}
"""Whether a setting concerns a job, where it does not concern all jobs that may read it."""


# -- settings that the campaign puts together ------------------------------------------------------


def _options(job: JobFacts) -> dict[str, Any]:
    """Settings of the forecaster's kind, but for the bound of divergence."""
    options = _all_options(job)
    options.pop("divergence_bound", None)
    return options


def _all_options(job: JobFacts) -> dict[str, Any]:
    return job.campaign.options(job.name.kind, job.case, job.name.label)


def _aware(job: JobFacts) -> dict[str, Any]:
    """What forecasters that know the parameters learn of them, with the case's own values."""
    aware = job.campaign.sections(job.case)["aware"]
    return {**aware, "own": job.campaign.own_values(job.case)}


def _duration(job: JobFacts) -> float | None:
    """Duration of long runs; without one, that of the case's series."""
    said = job.campaign.config.statistics.duration
    return job.campaign.plain_cases[job.case]["ensemble"]["duration"] if said is None else said


def _run(job: JobFacts) -> dict[str, Any]:
    """Plan of control; the noise is the case's if it says none, and unused for seen truth."""
    assert job.plan is not None
    run = job.plan.record(job.campaign.config.control.span_lt)
    if run["noise"] is None:
        del run["noise"]
        if not job.sees_truth:
            run["noise"] = job.campaign.cases[job.case].training.noise
    return run


_VALUES: Mapping[str, Callable[[JobFacts], Any]] = {
    "forecaster.options": _options,
    "forecaster.source": lambda job: job.campaign.cases[job.case].source_system,
    "forecaster.divergence_bound": lambda job: _all_options(job).get("divergence_bound"),
    "forecasters.aware": _aware,
    "statistics.duration": _duration,
    "control.run": _run,
    "control.sensor": lambda job: job.campaign.cases[job.observed].sensor,
    "source": lambda job: job.campaign.cases[job.case].source_system,
    "noise": lambda job: job.campaign.noise_of_data(job.case),
    "realisation": lambda job: job.campaign.cases[job.case].realisation,
    "drawn": lambda job: job.campaign.drawn_shares(job.case),
    "quantile": lambda job: job.campaign.cases[job.case].event_quantile,
    "parameters": lambda job: job.campaign.config.forecasters.aware.parameters,
    "sets_time_unit": lambda job: job.campaign.cases[job.case].estimates_time_unit,
    "asked": lambda job: job.campaign.asked_of_series(job.case),
    "prediction_time_lt": lambda job: job.campaign.prediction_time(2),
}
"""Values of settings that are not in the config as they are."""
