"""Random alarms at the rate of a forecaster: the effect of actuation alone."""

from collections.abc import Sequence

import numpy as np

from burstcast import random_streams
from burstcast.control.experiment import ControlExperiment
from burstcast.control.monitors.random import RandomMonitor
from burstcast.control.strategies.base import ControlStrategy
from burstcast.forecasters.base import Forecaster


def monitor(
    strategy: ControlStrategy,
    experiment: ControlExperiment,
    forecasters: Sequence[Forecaster],
    alarm_rate: float,
    seed: int,
) -> RandomMonitor:
    """Return a monitor at random; each flow has a random stream of its own.

    The stream's name has the case, the seed of the network that is compared with, and the row of
    the flow's series in the ensemble.
    """
    looks = strategy.timing(experiment.schedule).most_forecasts
    draws = [
        random_streams.stream(
            experiment.root_seed, "random alarms", experiment.case, seed, row
        ).random(looks)
        for row in experiment.series
    ]
    return RandomMonitor(alarm_rate, np.array(draws).reshape(len(draws), looks))
