"""Whether what a case asks of its series fits into them, as far as the config tells.

The checks are the library's, which refuses the same in a job and in a notebook.
"""

import math
from collections.abc import Callable, Iterable, Iterator
from contextlib import AbstractContextManager, contextmanager, suppress
from operator import attrgetter

import numpy as np

from burstcast import durations
from burstcast.control.strategies.registry import make_strategy as make_control_strategy
from burstcast.control.timing import Schedule
from burstcast.data.starting_points import starting_points, steps_before_events
from burstcast.forecasters._options import sections_of_kind
from burstcast.forecasters.precursor import lag_steps
from burstcast.forecasters.quadratic import window_steps
from burstcast.statistics.long_term import FixedPointCriterion, LongTermSettings
from burstcast.statistics.warning_signs import FEW_POSITIVES
from burstcast.tuning.strategies.base import ValidationPlan
from burstcast.tuning.strategies.registry import VALIDATED_TOGETHER, make_strategy
from burstcast_workflow.campaign.control_plans import block_plans
from burstcast_workflow.config.cases import campaign_cases, case_of, sound_case
from burstcast_workflow.config.measured_cases import space_of
from burstcast_workflow.config.model import Case, Configuration, Ensemble, Simulated
from burstcast_workflow.harness.settings import CLASSIFICATION, HORIZON, LONG_RUNS, VALIDATION

FINE = 1000
"""Steps per Lyapunov time where it is unknown: no duration is too short then."""


def misfits(
    config: Configuration,
    name: str,
    case: Simulated,
    kinds: Iterable[str],
    validations: Iterable[str],
) -> list[str]:
    """Durations that do not fit into the series of a case, if its Lyapunov time is known.

    Where it is computed, only the durations of control are compared with each other. The case has
    forecasters of these kinds, and networks of these validation strategies.
    """
    ensemble = case.ensemble
    problems: list[str] = []

    @contextmanager
    def telling(settings: str) -> Iterator[None]:
        try:
            yield
        except ValueError as error:
            problems.append(f"{settings}: {error}".removeprefix(": "))

    steps: int | None = 0
    with telling("lyapunov.published_exponent"):
        steps = case.steps_per_lyapunov_time
    if steps is None:
        _control(config, name, case, FINE, telling)
        return list(dict.fromkeys(problems))
    if not steps:
        return problems
    samples = _samples(ensemble)
    counts: dict[str, int] = {}
    for path in _DURATIONS:
        with telling(""):
            counts[path] = durations.positive_steps(attrgetter(path)(config), steps, path)
    if len(counts) == len(_DURATIONS):
        washout, classified = counts["washout_lt"], config.classification
        training, intervals = case.training.series, case.recycle_validation.intervals_per_series
        validated = min(case.recycle_validation.series, training)  # more are another mistake
        lead = config.search.single_shot_lead_steps
        plan = ValidationPlan(washout, counts["search.interval_lt"], validated, intervals, lead)
        for validation in dict.fromkeys([*VALIDATED_TOGETHER, *validations]):
            with telling(f"{VALIDATION} or ensemble.duration"):
                make_strategy(validation).folds(plan, training, samples)
        reach_lt = classified.longest_prediction_time_lt + classified.window_lt
        with telling(f"{CLASSIFICATION} or ensemble.duration"):
            starting_points(1, samples, 1, washout, durations.steps(reach_lt, steps))
        with telling(f"{HORIZON} or ensemble.duration"):
            steps_before_events(samples, counts["horizon.longest_lead_time_lt"], washout)
        judged = durations.steps(config.statistics.fixed_point_interval_lt, steps)
        run = config.statistics.duration
        closed_loop = samples - 1 if run is None else round(run / ensemble.sampling_interval)
        with telling(f"{LONG_RUNS} or ensemble.duration" if run is None else LONG_RUNS):
            rest = FixedPointCriterion(variation=0.0, above=0.0, interval=judged)
            LongTermSettings(closed_loop, np.empty(0), None, rest)
    if any("quadratic" in sections_of_kind(kind) for kind in kinds):
        with telling(""):
            window_steps(config.forecasters.quadratic.window_lt, steps, samples)
    _control(config, name, case, steps, telling)
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
    """Whether the lags of a precursor do not fit into the washout of a case."""
    if any("precursor" in sections_of_kind(kind) for kind in kinds):
        lags, steps = config.forecasters.precursor.lags_lt, FINE
        with suppress(ValueError):  # told with the case
            steps = case.steps_per_lyapunov_time or FINE
        try:
            lag_steps(lags, steps, durations.steps(config.washout_lt, steps))
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
        yield f"{CLASSIFICATION} or data.blocks.duration: {error}"


def _control(
    config: Configuration,
    name: str,
    case: Simulated,
    steps: int,
    telling: Callable[[str], AbstractContextManager[None]],
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
            with telling(f"control.strategies[{index}]"):
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


_DURATIONS = (
    "washout_lt",
    "search.interval_lt",
    "classification.start_spacing_lt",
    "classification.resolution_lt",
    "probability.start_spacing_lt",
    "horizon.longest_lead_time_lt",
    "horizon.lead_time_step_lt",
)
"""Durations of the config that take a step of the network at least."""
