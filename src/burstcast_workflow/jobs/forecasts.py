"""Forecasts of a job's case: the sets of their starting points, their windows."""

import numpy as np

from burstcast.base.arrays import FloatArray
from burstcast.base.files.netcdf import read_rows
from burstcast.forecasts.forecast_files import point_variables, schedule_variables
from burstcast.forecasts.horizon import HorizonSearch
from burstcast.forecasts.observed_points import observed_points
from burstcast.forecasts.windows import window_boundaries
from burstcast_workflow.harness.job import tell
from burstcast_workflow.harness.settings import at, concerning
from burstcast_workflow.harness.storage import read_json, write_netcdf
from burstcast_workflow.jobs.data import Observed, Tested, known_rows
from burstcast_workflow.jobs.systems import System
from burstcast_workflow.jobs.time_unit import Clock, Washed


class Windows(Clock):
    """How forecasts are cut into windows."""

    resolution_lt: float = at("classification.resolution_lt")
    window_lt: float = at("classification.window_lt")
    longest_prediction_time_lt: float = at("classification.longest_prediction_time_lt")

    @property
    def boundaries(self) -> tuple[int, ...]:
        """Boundaries of the windows of a forecast, in steps."""
        reach = self.longest_prediction_time_lt + self.window_lt
        count = round(reach / self.resolution_lt) - 1
        return window_boundaries(self.resolution_lt, count, self.lyapunov_time)


class Horizons(Washed):
    """How prediction horizons are measured."""

    longest_lead_time_lt: float = at("horizon.longest_lead_time_lt")
    lead_time_step_lt: float = at("horizon.lead_time_step_lt")
    tolerance: float = at("horizon.tolerance")
    event_threshold: float = at("case.event_threshold")

    def horizon_search(self, summary: str) -> HorizonSearch:
        """Search for prediction horizons, with the mean of all data from their summary."""
        mean = read_json(summary)["mean_observable"]
        return HorizonSearch(
            longest_lead_time_lt=self.longest_lead_time_lt,
            lead_time_step_lt=self.lead_time_step_lt,
            tolerance=self.tolerance * (self.event_threshold - mean),
            washout=self.washout,
            steps_per_lyapunov_time=self.lyapunov_time,
        )


class Points(System, Washed, Windows, Observed):
    """Starting points of forecasts."""

    def write_point_set(self, path: str, ensemble: str, rows: range, spacing: int) -> None:
        """Write starting points in kept series of an ensemble (see `write_points`)."""
        states = read_rows(ensemble, "state", rows.start, rows.stop)
        observed = self.observed_rows(ensemble, rows.start, states)
        observable = read_rows(ensemble, "observable", rows.start, rows.stop)
        schedules = known_rows(ensemble, rows.start, rows.stop)
        self.write_points(path, (states, observed, observable), spacing, schedules)

    def write_points(
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
        space, boundaries = self.space, self.boundaries
        with concerning(Windows.longest_prediction_time_lt, Windows.window_lt, Washed.washout_lt):
            points = observed_points(
                observed,
                observable,
                space.observable,
                spacing=spacing,
                washout=self.washout,
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


class EvaluationPoints(Points, Tested):
    """Starting points in the test series."""

    start_spacing_lt: float = at("classification.start_spacing_lt")

    @property
    def spacing(self) -> int:
        """Steps between two of them."""
        return self.positive_steps(EvaluationPoints.start_spacing_lt)
