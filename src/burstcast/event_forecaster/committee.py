"""Who votes: several forecasters, or the members of the ensemble that one forecaster tells."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import cast

import numpy as np

from burstcast.arrays import FloatArray
from burstcast.forecast.observed_points import ObservedPoints
from burstcast.forecast.windows import WindowSummaries, forecast_summaries
from burstcast.forecasters.base import Forecaster, ForecastingCase
from burstcast.probability.members import (
    EnsembleForecaster,
    has_members,
    leave_one_out_member_summaries,
    member_forecasts,
    member_summaries,
)
from burstcast.probability.out_of_sample import leave_one_out_summaries


@dataclass(frozen=True)
class Committee:
    """Forecasts of all who vote.

    Forecasts that leave the finite numbers do so without a warning: they then foresee nothing.

    Attributes
    ----------
    forecasters
        One, where the members of its ensemble vote.
    """

    forecasters: Sequence[Forecaster]

    @property
    def _ensemble(self) -> EnsembleForecaster | None:
        first = self.forecasters[0]
        return cast(EnsembleForecaster, first) if has_members(type(first)) else None

    def forecasts(self, washouts: FloatArray, steps: int) -> FloatArray:
        """States after washouts ``(series, steps, component)``, by member.

        Returns
        -------
        ``(member, series, steps, component)``.
        """
        batch = np.ascontiguousarray(washouts.transpose(1, 2, 0))
        with np.errstate(over="ignore", invalid="ignore"):
            if (ensemble := self._ensemble) is not None:
                return member_forecasts(ensemble, batch, steps).transpose(2, 3, 0, 1)
            outputs = [one.advance(one.start(batch), steps)[0] for one in self.forecasters]
        return np.stack(outputs).transpose(0, 3, 1, 2)

    def summaries(
        self, case: ForecastingCase, washouts: FloatArray, boundaries: tuple[int, ...]
    ) -> list[WindowSummaries]:
        """Window summaries of the forecasts after washouts ``(points, steps, component)``."""
        asked = case.system.observable, washouts, boundaries
        with np.errstate(over="ignore", invalid="ignore"):
            if (ensemble := self._ensemble) is not None:
                return member_summaries(ensemble, *asked)
            return [forecast_summaries(one, *asked)[0] for one in self.forecasters]

    def out_of_sample(
        self,
        case: ForecastingCase,
        training: FloatArray,
        points: ObservedPoints,
        boundaries: tuple[int, ...],
    ) -> list[WindowSummaries]:
        """Window summaries of forecasts of the training series without what each has taught."""
        known = training, case, points.washouts.shape[1], case.system.observable
        asked = points.washouts, points.points.series, boundaries
        with np.errstate(over="ignore", invalid="ignore"):
            if (ensemble := self._ensemble) is not None:
                return leave_one_out_member_summaries(ensemble, *known, *asked)
            return [leave_one_out_summaries(one, *known, *asked)[0] for one in self.forecasters]
