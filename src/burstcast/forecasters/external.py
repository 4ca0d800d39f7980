"""Forecasts that other programs have made, read from files.

`burstcast.benchmark.forecast_files` reads the files, and says what they contain. Their forecasts
are of the starting points of the test alone: nothing is learnt, and no other washout is forecast.
"""

from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np

from burstcast.benchmark.forecast_files import Forecasts
from burstcast.benchmark.task import ForecastTask
from burstcast.files.netcdf import Variable
from burstcast.forecast.event_probabilities import EventProbabilities
from burstcast.forecast.forecast_files import forecast_variables
from burstcast.forecast.windows import WindowForecasts
from burstcast.forecasters.base import ForecasterKind, ForecasterRecord, ForecastingCase
from burstcast.probability.votes import share_of_votes


@dataclass(frozen=True)
class ExternalForecasts(ForecasterKind):
    """Forecasts of the starting points of a case."""

    has_trajectories: ClassVar[bool] = False
    from_files: ClassVar[bool] = True

    #: window summaries of a trajectory from each point; or probabilities of events, which are
    #: given, or are the shares of several members that forecast an event
    forecasts: WindowForecasts | EventProbabilities

    @classmethod
    def of(cls, given: Forecasts, task: ForecastTask, event_threshold: float) -> Self:
        """Forecasts that a campaign scores, from the forecasts in files.

        ``given``: Result of `burstcast.benchmark.forecast_files.read_forecasts`.
        """
        if len(given.members) == 1:
            (single,) = given.members
            points, count = single.first.shape
            none = np.empty((points, 0, count))
            diverged = np.zeros(points, dtype=np.bool_)
            return cls(WindowForecasts(single.first, single.largest, diverged, none, none))
        probability = given.probability
        if probability is None:
            votes = [share_of_votes(given.members, *span, event_threshold) for span in task.windows]
            probability = np.stack(votes, axis=1)
        times = np.array(task.prediction_times_lt)
        return cls(EventProbabilities(probability, times, event_threshold))

    def variables(self, name: str) -> dict[str, Variable]:
        """Variables of a file of forecasts of the observable called ``name``."""
        if isinstance(self.forecasts, EventProbabilities):
            return self.forecasts.variables()
        return forecast_variables(self.forecasts, name)

    def record(self) -> ForecasterRecord:
        """Refuse: the files are the record."""
        raise NotImplementedError("forecasts from files are read again, not restored")

    @classmethod
    def restore(cls, record: ForecasterRecord, case: ForecastingCase) -> Self:
        """Refuse: the files are the record."""
        raise NotImplementedError("forecasts from files are read again, not restored")
