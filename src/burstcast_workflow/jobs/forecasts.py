"""Forecasts of a job's case: the sets of their starting points, their windows."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from burstcast.base.arrays import FloatArray
from burstcast.base.files.netcdf import read_netcdf, read_rows
from burstcast.base.series_lengths import series_lengths
from burstcast.data.starting_points import segments
from burstcast.forecasters.base import Forecaster
from burstcast.forecasts.forecast_files import forecasts_from, point_variables, schedule_variables
from burstcast.forecasts.horizon import HorizonSearch
from burstcast.forecasts.points import ForecastPoints, observed_points
from burstcast.forecasts.windows import window_boundaries
from burstcast.statistics.densities import SETTLED
from burstcast.statistics.long_term import (
    FixedPointCriterion,
    LongTermSettings,
    long_term_starting_points,
)
from burstcast_workflow.harness.job import tell
from burstcast_workflow.harness.settings import JobSettings, at, computed, concerning
from burstcast_workflow.harness.storage import read_json, write_netcdf
from burstcast_workflow.jobs.cases import Clock, Density, System, Washout
from burstcast_workflow.jobs.forecasters import seen_rows
from burstcast_workflow.jobs.origins import origins
from burstcast_workflow.jobs.series import Observed, Tested, known_rows


class Windows(JobSettings):
    """How forecasts are cut into windows."""

    clock: Clock
    resolution_lt: float = at("classification.resolution_lt")
    window_lt: float = at("classification.window_lt")
    longest_prediction_time_lt: float = at("classification.longest_prediction_time_lt")

    @property
    def boundaries(self) -> tuple[int, ...]:
        """Boundaries of the windows of a forecast, in steps."""
        reach = self.longest_prediction_time_lt + self.window_lt
        count = round(reach / self.resolution_lt) - 1
        return window_boundaries(self.resolution_lt, count, self.clock.lyapunov_time)


class Horizons(JobSettings):
    """How prediction horizons are measured."""

    washout: Washout
    longest_lead_time_lt: float = at("horizon.longest_lead_time_lt")
    lead_time_step_lt: float = at("horizon.lead_time_step_lt")
    tolerance: float = at("horizon.tolerance")
    event_threshold: float = computed("event_threshold.event_threshold")

    def search(self, summary: str) -> HorizonSearch:
        """Search for prediction horizons, with the mean of all data from their summary.

        The tolerance is a share of the distance from that mean to the event threshold.
        """
        mean = read_json(summary)["mean_observable"]
        return HorizonSearch(
            longest_lead_time_lt=self.longest_lead_time_lt,
            lead_time_step_lt=self.lead_time_step_lt,
            largest_error=self.tolerance * (self.event_threshold - mean),
            washout=self.washout.steps,
            steps_per_lyapunov_time=self.washout.clock.lyapunov_time,
        )


class Points(JobSettings):
    """Starting points of forecasts."""

    system: System
    washout: Washout
    windows: Windows
    observed: Observed

    def write_set(self, path: str, ensemble: str, rows: range, spacing: int) -> None:
        """Write starting points in kept series of an ensemble (see `write`)."""
        states = read_rows(ensemble, "state", rows.start, rows.stop)
        observed = self.observed.rows(ensemble, rows.start, states)
        observable = read_rows(ensemble, "observable", rows.start, rows.stop)
        schedules = known_rows(ensemble, rows.start, rows.stop)
        self.write(path, (states, observed, observable), spacing, schedules)

    def write(
        self,
        path: str,
        series: tuple[FloatArray, FloatArray, FloatArray],
        spacing: int,
        schedules: FloatArray | None = None,
    ) -> None:
        """Write starting points, observed washouts, and the true window summaries.

        ``series``: True states and observed ones, ``(series, time, dimension)`` each, and the true
        observable, ``(series, time)``. ``spacing``: Steps between two points. ``schedules``:
        Parameters in force in each step, ``(series, time - 1, parameters)``; None: the parameters
        of the case.
        """
        states, observed, observable = series
        space, boundaries = self.system.space, self.windows.boundaries
        with concerning(Windows.longest_prediction_time_lt, Windows.window_lt, Washout.lt):
            points = observed_points(
                observed,
                observable,
                space.observable,
                spacing=spacing,
                washout=self.washout.steps,
                boundaries=boundaries,
            )
        without = len(states) - len(np.unique(points.points.series))
        if without:
            tell(
                f"{without} of {len(states)} series have no starting point: they are shorter than "
                f"a washout and the longest forecast"
            )
        variables = point_variables(points, states, space.observable_name)
        if schedules is not None:
            variables |= schedule_variables(points, schedules, boundaries[-1])
        write_netcdf(path, variables, self.provenance)


class EvaluationPoints(JobSettings):
    """Starting points in the test series."""

    points: Points
    tested: Tested
    start_spacing_lt: float = at("classification.start_spacing_lt")

    @property
    def spacing(self) -> int:
        """Steps between two of them."""
        clock = self.points.washout.clock
        return clock.positive_steps(self.start_spacing_lt, EvaluationPoints.start_spacing_lt)


class ScoredForecasts(JobSettings):
    """Forecasts of events, which are scored at some prediction times."""

    event_threshold: float = computed("event_threshold.event_threshold")
    prediction_times_lt: list[float] = at("classification.prediction_times_lt")
    window_lt: float = at("classification.window_lt")
    resolution_lt: float = at("classification.resolution_lt")

    def points(self, point_set: str, forecasts: Sequence[str] = ()) -> ForecastPoints:
        """Read the starting points of a case, and the forecasts from them."""
        return ForecastPoints(
            read_netcdf(point_set),
            {
                origin.name.identifier: forecasts_from(read_netcdf(origin.path))
                for origin in origins(forecasts)
            },
            self.window_lt,
            self.resolution_lt,
        )


class LongRuns(JobSettings):
    """Where long runs start, and how long they are."""

    washout: Washout
    observed: Observed
    starting_points: int = at("statistics.starting_points")
    start_spacing_lt: float = at("statistics.start_spacing_lt")
    duration: float | None = at("statistics.duration")

    def washouts(self, ensemble: str, forecaster: Forecaster) -> FloatArray:
        """Washouts of a forecaster before each of its long runs, ``(points, steps, dimension)``."""
        clock, training = self.washout.clock, self.observed.training.states(ensemble)
        states = seen_rows(forecaster, self.observed, ensemble, 0, training)
        points = long_term_starting_points(
            len(states),
            states.shape[1],
            clock.positive_steps(self.start_spacing_lt, LongRuns.start_spacing_lt),
            self.washout.steps,
            self.starting_points,
            series_lengths(states),
        )
        return segments(states, points, self.washout.steps - 1, 0)

    def run_steps(self, ensemble: str) -> int:
        """Steps of each run; without a duration, as many as the longest series has."""
        if self.duration is None:
            return len(read_netcdf(ensemble, "time")["time"]) - 1
        return round(self.duration / self.washout.clock.sampling_interval)


class LongTerm(JobSettings):
    """Long runs, and when they are discarded."""

    runs: LongRuns
    density: Density
    laminarisation_threshold: float | None = at("case.laminarisation_threshold")
    fixed_point: dict[str, Any] | None = at("case.fixed_point")
    fixed_point_interval_lt: float = at("statistics.fixed_point_interval_lt")

    def settings(self, ensemble: str) -> LongTermSettings:
        """Settings of long runs.

        A run has settled where it varies less than a hundredth of the bins' range, unless the
        config says otherwise.
        """
        edges = self.density.edges(ensemble)
        settled = SETTLED * (edges[-1] - edges[0])
        fixed_point = self.fixed_point or {"variation": settled, "above": edges[0]}
        interval = self.runs.washout.clock.steps(self.fixed_point_interval_lt)
        with concerning(LongRuns.duration, LongTerm.fixed_point_interval_lt):
            return LongTermSettings(
                steps=self.runs.run_steps(ensemble),
                edges=edges,
                laminarisation_threshold=self.laminarisation_threshold,
                fixed_point=FixedPointCriterion(
                    fixed_point["variation"], fixed_point["above"], interval
                ),
            )
