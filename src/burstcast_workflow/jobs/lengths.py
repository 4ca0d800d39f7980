"""Whether what a case asks of its series fits into them, where its Lyapunov time is known.

The checks are the library's, which refuses the same in a job and in a notebook.
"""

from collections.abc import Collection, Iterator, Sequence
from contextlib import contextmanager
from typing import Any

import numpy as np

from burstcast.base import durations
from burstcast.data.starting_points import starting_points, steps_before_events
from burstcast.forecasters.quadratic import window_steps
from burstcast.forecasters.registry import sections_of_kind
from burstcast.networks.validation_strategies.base import ValidationPlan
from burstcast.networks.validation_strategies.registry import VALIDATED_TOGETHER, make_strategy
from burstcast.statistics.long_term import FixedPointCriterion, LongTermSettings
from burstcast_workflow.harness.settings import JobSettings, at, names


@contextmanager
def listing(problems: list[str], settings: str = "") -> Iterator[None]:
    """Add the message of the library to a list, after the settings that it concerns."""
    try:
        yield
    except ValueError as error:
        problems.append(f"{settings}: {error}".removeprefix(": "))


class Lengths(JobSettings):
    """What forecasts of a case need of its series."""

    washout_lt: float = at("washout_lt")
    interval_lt: float = at("search.interval_lt")
    single_shot_lead_steps: int = at("search.single_shot_lead_steps")
    start_spacing_lt: float = at("classification.start_spacing_lt")
    resolution_lt: float = at("classification.resolution_lt")
    window_lt: float = at("classification.window_lt")
    longest_prediction_time_lt: float = at("classification.longest_prediction_time_lt")
    calibration_spacing_lt: float = at("probability.start_spacing_lt")
    long_run_spacing_lt: float = at("statistics.start_spacing_lt")
    longest_lead_time_lt: float = at("horizon.longest_lead_time_lt")
    lead_time_step_lt: float = at("horizon.lead_time_step_lt")
    training_series: int = at("case.training.series")
    validated_series: int = at("case.recycle_validation.series")
    intervals: int | None = at("case.recycle_validation.intervals_per_series")
    fixed_point_interval_lt: float = at("statistics.fixed_point_interval_lt")
    duration: float | None = at("statistics.duration")
    quadratic_window_lt: float = at("forecasters.quadratic.window_lt")

    def misfits(
        self,
        steps: int,
        sampling_interval: float,
        samples: int | None,
        kinds: Collection[str],
        validations: Collection[str],
        long_runs: bool = True,
        training_lengths: Sequence[int] = (),
    ) -> list[str]:
        """Durations that do not fit into series of so many samples, with their settings.

        ``steps``: Of a Lyapunov time. ``sampling_interval``: In time units. ``samples``: None if
        unknown; durations are then compared with a step alone. The case has forecasters of these
        ``kinds``, and networks of these ``validations``. ``training_lengths``: Samples of training
        series of unequal lengths, the longest first.
        """
        problems: list[str] = []
        counts: dict[Any, int] = {}
        fields: list[Any] = [Lengths.washout_lt, Lengths.interval_lt, Lengths.start_spacing_lt]
        fields += [Lengths.resolution_lt, Lengths.calibration_spacing_lt]
        fields += [Lengths.long_run_spacing_lt] if long_runs else []
        fields += [Lengths.longest_lead_time_lt, Lengths.lead_time_step_lt]
        for field in fields:
            with listing(problems):
                duration = field.value(self.value_of)
                counts[field] = durations.positive_steps(duration, steps, str(field))
        if samples is None:
            return problems
        if not problems:
            washout, interval = counts[Lengths.washout_lt], counts[Lengths.interval_lt]
            training, lead = self.training_series, self.single_shot_lead_steps
            validated = min(self.validated_series, training)
            plan = ValidationPlan(washout, interval, validated, self.intervals, lead)
            if training_lengths and validations:
                with listing(problems, VALIDATED):
                    plan = plan.fitted_to(training_lengths)
            for name in dict.fromkeys([*VALIDATED_TOGETHER, *validations] if validations else []):
                with listing(problems, f"{VALIDATION} or ensemble.duration"):
                    make_strategy(name).folds(plan, training, samples)
            reach = durations.steps(self.longest_prediction_time_lt + self.window_lt, steps)
            with listing(problems, f"{FORECASTS} or ensemble.duration"):
                starting_points(1, samples, 1, washout, reach)
            with listing(problems, f"{HORIZONS} or ensemble.duration"):
                steps_before_events(samples, counts[Lengths.longest_lead_time_lt], washout)
            judged, run = durations.steps(self.fixed_point_interval_lt, steps), self.duration
            closed_loop = samples - 1 if run is None else round(run / sampling_interval)
            as_series = closed_loop == samples - 1
            advice = f"{LONG_RUNS} or ensemble.duration" if as_series else LONG_RUNS
            with listing(problems, advice):
                rest = FixedPointCriterion(variation=0.0, above=0.0, interval=judged)
                if long_runs:
                    LongTermSettings(closed_loop, np.empty(0), None, rest)
        if any("quadratic" in sections_of_kind(kind) for kind in kinds):
            with listing(problems):
                window_steps(self.quadratic_window_lt, steps, samples)
        return list(dict.fromkeys(problems))


VALIDATION = names(Lengths.intervals, Lengths.interval_lt, Lengths.washout_lt)
VALIDATED = names(Lengths.validated_series, Lengths.interval_lt, Lengths.washout_lt)
FORECASTS = names(Lengths.longest_prediction_time_lt, Lengths.window_lt, Lengths.washout_lt)
HORIZONS = names(Lengths.longest_lead_time_lt, Lengths.washout_lt)
LONG_RUNS = names(Lengths.duration, Lengths.fixed_point_interval_lt)
"""Settings of what must fit into a series together."""
