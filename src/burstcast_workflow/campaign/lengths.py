"""Whether what jobs need fits into the series of their cases, checked before any job.

The checks are those of the job ``lengths``, with the settings of that job. It makes them again
where the config does not know a Lyapunov time or the length of the series.
"""

from collections.abc import Iterator
from contextlib import suppress

from burstcast.base import durations
from burstcast.control.timing import Schedule
from burstcast.forecasters.precursor import lag_steps
from burstcast.forecasters.registry import sections_of_kind
from burstcast_workflow.campaign.campaign import Campaign
from burstcast_workflow.campaign.job_settings import Job, settings_of_job
from burstcast_workflow.config.case import Case, Simulated
from burstcast_workflow.config.control_plans import ControlPlan, block_plans
from burstcast_workflow.config.measured_cases import space_of
from burstcast_workflow.config.model import Configuration
from burstcast_workflow.config.problems import of_cases
from burstcast_workflow.jobs.lengths import Lengths, listing

FINE = 1000
"""Steps per Lyapunov time where it is unknown: no duration is too short then."""


def misfits(config: Configuration) -> list[str]:
    """Durations that do not fit into the series of the valid cases, a message for each."""
    campaign = Campaign(config, skip_invalid=True)
    return of_cases((name, _misfits(campaign, case)) for name, case in campaign.cases.items())


def _misfits(campaign: Campaign, case: Case) -> list[str]:
    """Durations that do not fit into the series of a case."""
    problems: list[str] = []
    steps: int | None = None
    with listing(problems, "lyapunov.given_exponent"):
        steps = case.steps_per_lyapunov_time
    if problems:
        return problems
    wildcards = {"case": case.name}
    asked = Job(campaign, wildcards).asked_of_series
    if steps is not None:
        lengths = Lengths(settings_of_job(campaign, Lengths.paths(), wildcards), wildcards)
        problems += lengths.misfits(steps, case.ensemble.sampling_interval, case.samples, **asked)
        if not isinstance(case, Simulated):
            advice = "data.blocks.duration" if case.data and case.data.blocks else "data.delays"
            problems = [text.replace("ensemble.duration", advice) for text in problems]
    steps, forecasters = steps or FINE, campaign.config.forecasters
    sections = {name for kind in asked["kinds"] for name in sections_of_kind(kind)}
    with listing(problems):
        if "precursor" in sections:
            washout = durations.steps(campaign.config.washout_lt, steps)
            lag_steps(forecasters.precursor.lags_lt, steps, washout)
        if sections & {"precursor", "esn_direct"}:
            name = "forecasters.classifiers.start_spacing_lt"
            durations.positive_steps(forecasters.classifiers.start_spacing_lt, steps, name)
    if isinstance(case, Simulated):
        problems += _control(campaign, case, steps)
    return problems


def _control(campaign: Campaign, case: Simulated, steps: int) -> list[str]:
    """Strategies of control that do not fit a case, at so many steps per Lyapunov time."""
    problems: list[str] = []
    if case.actuation is None:
        return problems
    for place, plan in plans_of(campaign.config, case.name):
        seen = campaign.cases.get(plan.observed) if plan.observed else case
        if seen is None or seen.source is not case:
            continue
        with listing(problems, place):
            schedule = Schedule(
                washout=max(1, durations.steps(campaign.config.washout_lt, steps)),
                quiet_lt=plan.quiet_lt,
                span_lt=plan.span_lt or campaign.config.control.span_lt,
                delay_lt=plan.delay_lt,
                actuation_start_lt=case.actuation.start_lt,
                actuation_duration_lt=case.actuation.duration_lt,
                steps_per_lyapunov_time=steps,
                sampling_stride=case.ensemble.sampling_stride,
                time_step=case.ensemble.time_step,
            )
            plan.strategy.check(schedule)
            if (space := space_of(vars(seen))) is not None:
                plan.strategy.check_system(space, case.actuation.force is not None)
    return problems


def plans_of(config: Configuration, case: str) -> Iterator[tuple[str, ControlPlan]]:
    """Valid plans of the blocks of strategies that control a case, with the block's place."""
    for place, block in config.control.blocks:
        if case in (block.cases or [case]):
            for plan in block_plans(block):
                with suppress(ValueError):  # reported with the block
                    _ = plan.strategy
                    yield place, plan
