"""Random decisions: the effect of an actuator without information."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from burstcast import random_streams
from burstcast.control.experiment import ControlExperiment
from burstcast.control.monitors.base import Monitor
from burstcast.control.monitors.random import RandomMonitor
from burstcast.control.sampled.strategy import SampledStrategy
from burstcast.forecasters.base import Forecaster


@dataclass(frozen=True)
class RandomDecisions(SampledStrategy):
    """Acts until the next decision with a given probability, each decision by itself.

    Attributes
    ----------
    probability
        Probability of acting: the expected share of the time under actuation.
    """

    forecasts: ClassVar[bool] = False

    probability: float

    def monitor(self, experiment: ControlExperiment, forecasters: Sequence[Forecaster]) -> Monitor:
        """Alarms at random: each flow has a stream of its own."""
        decisions = self.timing(experiment.schedule).most_forecasts
        draws = [
            random_streams.stream(
                experiment.root_seed, "random decisions", experiment.case, row
            ).random(decisions)
            for row in experiment.series
        ]
        return RandomMonitor(
            self.probability, np.array(draws).reshape(len(experiment.series), decisions)
        )
