"""A committee: the members of the ensembles of one or several forecasters."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from burstcast.arrays import FloatArray
from burstcast.forecast.observed_points import ObservedPoints
from burstcast.forecast.window_forecasts import member_forecasts, window_forecasts
from burstcast.forecast.windows import WindowSummaries
from burstcast.forecasters.base import Forecaster, ForecastingCase
from burstcast.probability.out_of_sample import out_of_sample_forecasts


@dataclass(frozen=True)
class Committee:
    """Forecasts of all members of a committee.

    Forecasts that overflow raise no warning; they predict no event.
    """

    #: the forecasters, all members of whose ensembles vote: a network is a single member
    forecasters: Sequence[Forecaster]

    def forecasts(self, washouts: FloatArray, steps: int) -> FloatArray:
        """States after washouts ``(series, steps, component)``, by member.

        Shape ``(member, series, steps, component)``.
        """
        batch = np.ascontiguousarray(washouts.transpose(1, 2, 0))
        states = [member_forecasts(one, batch, steps) for one in self.forecasters]
        return np.concatenate(states, axis=2).transpose(2, 3, 0, 1)

    def summaries(
        self,
        case: ForecastingCase,
        washouts: FloatArray,
        boundaries: tuple[int, ...],
        schedules: FloatArray | None = None,
    ) -> list[WindowSummaries]:
        """Window summaries of the forecasts after washouts ``(points, steps, component)``.

        Schedules are as in `burstcast.forecast.window_forecasts.window_forecasts`.
        """
        asked = case.system.observable, washouts, boundaries, schedules
        found = [window_forecasts(one, *asked) for one in self.forecasters]
        return [member for one in found for member in one.members]

    def out_of_sample(
        self,
        case: ForecastingCase,
        training: FloatArray,
        points: ObservedPoints,
        boundaries: tuple[int, ...],
        parameters: FloatArray | None = None,
    ) -> list[WindowSummaries]:
        """Window summaries of forecasts of each training series, refitted without that series.

        ``parameters`` are the schedules of the training series, ``(series, time - 1, parameters)``.
        """
        known = training, case, points.washouts.shape[1], case.system.observable
        of_points = None
        if parameters is not None:
            steps = np.arange(1 - points.washouts.shape[1], boundaries[-1])
            around = points.points.step[:, np.newaxis] + steps
            of_points = parameters[points.points.series[:, np.newaxis], around]
        asked = points.washouts, points.points.series, boundaries
        found = [
            out_of_sample_forecasts(one, *known, *asked, parameters=parameters, schedules=of_points)
            for one in self.forecasters
        ]
        return [member for one in found for member in one.members]
