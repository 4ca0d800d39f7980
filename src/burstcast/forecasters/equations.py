"""The equations as a forecaster, started from the true state: the bound for all others."""

from dataclasses import dataclass
from typing import ClassVar

from burstcast.forecasters.equations_noisy import EquationsFromObservation


@dataclass(frozen=True)
class EquationsFromTruth(EquationsFromObservation):
    """Integrates the equations from the true state: a perfect forecast."""

    sees_truth: ClassVar[bool] = True
