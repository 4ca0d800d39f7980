"""Reactive control: act while what is observed now is high. It needs no forecast.

The baseline of every strategy that forecasts: what is gained by looking ahead is what is left
against the best threshold on the observable now.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

from burstcast.control.experiment import ControlExperiment
from burstcast.control.monitors.base import Monitor
from burstcast.control.monitors.observed import ObservedMonitor
from burstcast.control.sampled.strategy import SampledStrategy
from burstcast.forecasters.base import Forecaster


@dataclass(frozen=True)
class Reactive(SampledStrategy):
    """Acts until the next decision while the observed observable is at or above a level.

    Attributes
    ----------
    level
        In units of the observable; below the event threshold, or it acts too late.
    """

    forecasts: ClassVar[bool] = False

    level: float

    def monitor(self, experiment: ControlExperiment, forecasters: Sequence[Forecaster]) -> Monitor:
        """Alarms where the observable is high now."""
        return ObservedMonitor(experiment.system.observable, self.level)
