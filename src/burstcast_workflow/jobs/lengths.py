"""Whether what a case asks of its series fits into them, where its Lyapunov time is known.

The checks are the library's, which refuses the same in a job and in a notebook.
"""

from collections.abc import Collection, Iterator, Mapping
from contextlib import contextmanager
from typing import Any

import numpy as np

from burstcast import durations
from burstcast.data.starting_points import starting_points, steps_before_events
from burstcast.forecasters._options import sections_of_kind
from burstcast.forecasters.quadratic import window_steps
from burstcast.statistics.long_term import FixedPointCriterion, LongTermSettings
from burstcast.tuning.strategies.base import ValidationPlan
from burstcast.tuning.strategies.registry import VALIDATED_TOGETHER, make_strategy
from burstcast_workflow.harness.settings import CLASSIFICATION, HORIZON, LONG_RUNS, VALIDATION


@contextmanager
def listing(problems: list[str], settings: str = "") -> Iterator[None]:
    """Add the message of the library to a list, after the settings that it concerns."""
    try:
        yield
    except ValueError as error:
        problems.append(f"{settings}: {error}".removeprefix(": "))


def misfits(
    settings: Mapping[str, Any],
    steps: int,
    samples: int,
    sampling_interval: float,
    kinds: Collection[str],
    validations: Collection[str],
    long_runs: bool = True,
) -> list[str]:
    """Durations that do not fit into series of so many samples, with their settings.

    ``settings``: Values by their paths. The case has forecasters of these ``kinds``, and networks
    of these ``validations``.
    """
    problems: list[str] = []
    counts: dict[str, int] = {}
    lasting_a_step = {
        "washout_lt": settings["washout_lt"],
        "search.interval_lt": settings["search.interval_lt"],
        "classification.start_spacing_lt": settings["classification.start_spacing_lt"],
        "classification.resolution_lt": settings["classification.resolution_lt"],
        "probability.start_spacing_lt": settings["probability.start_spacing_lt"],
        "horizon.longest_lead_time_lt": settings["horizon.longest_lead_time_lt"],
        "horizon.lead_time_step_lt": settings["horizon.lead_time_step_lt"],
    }
    for path, duration in lasting_a_step.items():
        with listing(problems):
            counts[path] = durations.positive_steps(duration, steps, path)
    if len(counts) == len(lasting_a_step):
        washout, training = counts["washout_lt"], settings["case.training.series"]
        validated = min(settings["case.recycle_validation.series"], training)
        intervals = settings["case.recycle_validation.intervals_per_series"]
        lead = settings["search.single_shot_lead_steps"]
        plan = ValidationPlan(washout, counts["search.interval_lt"], validated, intervals, lead)
        for validation in dict.fromkeys([*VALIDATED_TOGETHER, *validations] if validations else []):
            with listing(problems, f"{VALIDATION} or ensemble.duration"):
                make_strategy(validation).folds(plan, training, samples)
        reach_lt = settings["classification.longest_prediction_time_lt"]
        reach = durations.steps(reach_lt + settings["classification.window_lt"], steps)
        with listing(problems, f"{CLASSIFICATION} or ensemble.duration"):
            starting_points(1, samples, 1, washout, reach)
        with listing(problems, f"{HORIZON} or ensemble.duration"):
            steps_before_events(samples, counts["horizon.longest_lead_time_lt"], washout)
        judged = durations.steps(settings["statistics.fixed_point_interval_lt"], steps)
        run = settings["statistics.duration"]
        closed_loop = samples - 1 if run is None else round(run / sampling_interval)
        with listing(problems, f"{LONG_RUNS} or ensemble.duration" if run is None else LONG_RUNS):
            rest = FixedPointCriterion(variation=0.0, above=0.0, interval=judged)
            if long_runs:
                LongTermSettings(closed_loop, np.empty(0), None, rest)
    if any("quadratic" in sections_of_kind(kind) for kind in kinds):
        with listing(problems):
            window_steps(settings["forecasters.quadratic.window_lt"], steps, samples)
    return list(dict.fromkeys(problems))
