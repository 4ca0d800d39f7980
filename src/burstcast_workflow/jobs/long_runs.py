"""Long runs of a job's forecaster: where they start, and how they are made."""

from typing import Any

from burstcast.base.arrays import FloatArray
from burstcast.base.files.netcdf import read_netcdf
from burstcast.base.series_lengths import series_lengths
from burstcast.data.starting_points import segments
from burstcast.forecasters.base import Forecaster
from burstcast.statistics.densities import SETTLED
from burstcast.statistics.long_term import (
    FixedPointCriterion,
    LongTermSettings,
    long_term_starting_points,
)
from burstcast_workflow.harness.settings import at, concerning
from burstcast_workflow.jobs.data import Density, Observed
from burstcast_workflow.jobs.forecasters import seen_rows
from burstcast_workflow.jobs.systems import System
from burstcast_workflow.jobs.time_unit import Washed


class LongRuns(System, Washed, Observed):
    """Where long runs start, and how long they are."""

    starting_points: int = at("statistics.starting_points")
    start_spacing_lt: float = at("statistics.start_spacing_lt")
    duration: float | None = at("statistics.duration")

    def washouts(self, ensemble: str, forecaster: Forecaster) -> FloatArray:
        """Washouts of a forecaster before each of its long runs, ``(points, steps, dimension)``."""
        states = seen_rows(forecaster, self, ensemble, 0, self.training_states(ensemble))
        points = long_term_starting_points(
            len(states),
            states.shape[1],
            self.steps(self.start_spacing_lt),
            self.washout,
            self.starting_points,
            series_lengths(states),
        )
        return segments(states, points, self.washout - 1, 0)

    def run_steps(self, ensemble: str) -> int:
        """Steps of each run; without a duration, as many as the longest series has."""
        if self.duration is None:
            return len(read_netcdf(ensemble, "time")["time"]) - 1
        return round(self.duration / self.sampling_interval)


class LongTerm(LongRuns, Density):
    """Long runs, and when they are discarded."""

    divergence_bound: float | None = at("forecaster.divergence_bound")
    laminarisation_threshold: float | None = at("case.laminarisation_threshold")
    fixed_point: dict[str, Any] | None = at("case.fixed_point")
    fixed_point_interval_lt: float = at("statistics.fixed_point_interval_lt")

    def long_term(self, ensemble: str) -> LongTermSettings:
        """Settings of long runs.

        A run has settled where it varies less than a hundredth of the bins' range, unless the
        config says otherwise.
        """
        edges = self.edges(ensemble)
        settled = SETTLED * (edges[-1] - edges[0])
        fixed_point = self.fixed_point or {"variation": settled, "above": edges[0]}
        interval = self.steps(self.fixed_point_interval_lt)
        with concerning(LongRuns.duration, LongTerm.fixed_point_interval_lt):
            return LongTermSettings(
                steps=self.run_steps(ensemble),
                edges=edges,
                laminarisation_threshold=self.laminarisation_threshold,
                fixed_point=FixedPointCriterion(
                    fixed_point["variation"], fixed_point["above"], interval
                ),
            )
