"""Control by one forecaster, or by a strategy that asks none."""

from collections.abc import Sequence

from burstcast.control.experiment import ControlExperiment
from burstcast.control.monitors.base import Monitor
from burstcast.control.strategies.base import ControlStrategy
from burstcast.forecasters.base import Forecaster


def monitor(
    strategy: ControlStrategy,
    experiment: ControlExperiment,
    forecasters: Sequence[Forecaster],
    alarm_rate: float,
    seed: int,
) -> Monitor:
    """Return the strategy's own monitor."""
    return strategy.monitor(experiment, forecasters)
