"""Whether what a case asks of its series fits into them, as far as the config tells.

Where its Lyapunov time is computed, a job checks it (`burstcast_workflow.jobs.lengths`).
"""

import math
from collections.abc import Collection, Iterable, Iterator
from contextlib import suppress
from operator import attrgetter

from burstcast import durations
from burstcast.control.strategies.registry import make_strategy as make_control_strategy
from burstcast.control.timing import Schedule
from burstcast.data.starting_points import starting_points
from burstcast.forecasters._options import sections_of_kind
from burstcast.forecasters.precursor import lag_steps
from burstcast.statistics.warning_signs import FEW_POSITIVES
from burstcast_workflow.config.cases import campaign_cases, case_of, sound_case
from burstcast_workflow.config.control_plans import block_plans
from burstcast_workflow.config.kinds import Section
from burstcast_workflow.config.measured_cases import space_of
from burstcast_workflow.config.model import Case, Configuration, Ensemble, Simulated
from burstcast_workflow.jobs.lengths import FORECASTS, Lengths, listing


def _lengths(config: Configuration, case: Simulated) -> Lengths:
    """What a case asks of its series, as its job would be given it."""
    found = {}
    for path in Lengths.paths():
        below = path.removeprefix("case.")
        value = attrgetter(below)(config if below == path else case)
        found[path] = value.dump() if isinstance(value, Section) else value
    return Lengths(found, {})


FINE = 1000
"""Steps per Lyapunov time where it is unknown: no duration is too short then."""


def misfits(
    config: Configuration,
    name: str,
    case: Simulated,
    kinds: Collection[str],
    validations: Collection[str],
) -> list[str]:
    """Durations that do not fit into the series of a case, if its Lyapunov time is known.

    Where it is computed, only the durations of control are compared with each other: a job compares
    the others. The case has forecasters of these kinds, and networks of these validation
    strategies.
    """
    ensemble = case.ensemble
    problems: list[str] = []
    steps: int | None = 0
    with listing(problems, "lyapunov.published_exponent"):
        steps = case.steps_per_lyapunov_time
    if steps is None or steps:
        _control(config, name, case, steps or FINE, problems)
    if steps:
        asked = _lengths(config, case)
        found = asked.misfits(steps, _samples(ensemble), kinds, validations)
        problems = [*found, *problems]
    return list(dict.fromkeys(problems))


def few_points(config: Configuration) -> str:
    """Describe cases with too few starting points of forecasts for any score; "" if there are none.

    That is fewer than the events that a score takes (`FEW_POSITIVES`), as far as Lyapunov times are
    known.
    """
    found = []
    for name in campaign_cases(config):
        case, classified = case_of(config, name), config.classification
        steps = case.steps_per_lyapunov_time if isinstance(case, Simulated) else None
        if not isinstance(case, Simulated) or steps is None:
            continue
        reach_lt = classified.longest_prediction_time_lt + classified.window_lt
        room = durations.steps(config.washout_lt, steps), durations.steps(reach_lt, steps)
        calibration = config.probability.calibration_series or case.training.series
        few = []
        for use, series, spacing_lt in (
            ("score", case.test_series, classified.start_spacing_lt),
            ("calibrate with", calibration, config.probability.start_spacing_lt),
        ):
            spacing = durations.steps(spacing_lt, steps)
            points = len(starting_points(series, _samples(case.ensemble), spacing, *room))
            if points < FEW_POSITIVES:
                few.append(f"{points} to {use}")
        if few:
            found.append(f"{name} has {' and '.join(few)}")
    if not found:
        return ""
    return (
        f"fewer than {FEW_POSITIVES} starting points of forecasts: {', '.join(found)}; raise "
        "test_series, training.series or ensemble.duration, or lower start_spacing_lt"
    )


def _samples(ensemble: Ensemble) -> int:
    """Samples of a series, with both of its ends."""
    return math.floor(ensemble.duration / ensemble.sampling_interval + 1e-9) + 1


def lag_misfits(config: Configuration, case: Case, kinds: Iterable[str]) -> Iterator[str]:
    """Whether lags of a precursor, or starting points of classifiers, do not fit a case's steps."""
    sections, steps = {name for kind in kinds for name in sections_of_kind(kind)}, FINE
    with suppress(ValueError):  # told with the case
        steps = case.steps_per_lyapunov_time or FINE
    try:
        if "precursor" in sections:
            lags = config.forecasters.precursor.lags_lt
            lag_steps(lags, steps, durations.steps(config.washout_lt, steps))
        if sections & {"precursor", "esn_direct"}:
            spacing = config.forecasters.classifiers.start_spacing_lt
            durations.positive_steps(spacing, steps, "forecasters.classifiers.start_spacing_lt")
    except ValueError as error:
        yield str(error)


def room_misfits(config: Configuration, case: Case) -> Iterator[str]:
    """Whether the blocks of a record are too short for a washout and a forecast."""
    exponent, blocks = case.lyapunov.known_exponent, case.data and case.data.blocks
    if exponent is None or not blocks:
        return
    interval, classified = case.ensemble.sampling_interval, config.classification
    reach_lt = classified.longest_prediction_time_lt + classified.window_lt
    try:
        steps = durations.steps_per_lyapunov_time(exponent, interval)
        washout = durations.positive_steps(config.washout_lt, steps, "washout_lt")
        samples = round(blocks.duration / interval) + 1
        starting_points(1, samples, 1, washout, durations.steps(reach_lt, steps))
    except ValueError as error:
        yield f"{FORECASTS} or data.blocks.duration: {error}"


def _control(
    config: Configuration,
    name: str,
    case: Simulated,
    steps: int,
    problems: list[str],
) -> None:
    """Check the strategies that control a case, at so many steps per Lyapunov time."""
    ensemble = case.ensemble
    for index, block in enumerate(config.control.strategies):
        if case.actuation is None or (block.cases and name not in block.cases):
            continue
        for plan in block_plans(block):
            seen = sound_case(config, plan.observed) if plan.observed else case
            if seen is None or (plan.observed and not (seen.data and seen.data.case == name)):
                continue
            try:
                strategy = make_control_strategy(plan.strategy, dict(plan.settings))
            except ValueError:  # told with the block
                continue
            with listing(problems, f"control.strategies[{index}]"):
                schedule = Schedule(
                    washout=max(1, durations.steps(config.washout_lt, steps)),
                    quiet_lt=plan.quiet_lt,
                    span_lt=plan.span_lt or config.control.span_lt,
                    delay_lt=plan.delay_lt,
                    actuation_start_lt=case.actuation.start_lt,
                    actuation_duration_lt=case.actuation.duration_lt,
                    steps_per_lyapunov_time=steps,
                    sampling_stride=ensemble.sampling_stride,
                    time_step=ensemble.time_step,
                )
                strategy.check(schedule)
                if (space := space_of(seen)) is not None:
                    strategy.check_system(space, case.actuation.force is not None)
