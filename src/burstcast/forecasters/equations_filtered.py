"""The equations, started from the estimate of a filter over the washout.

The limit for forecasts from noisy observations: a perfect model and a nearly perfect estimate.
"""

from dataclasses import dataclass
from typing import ClassVar

from burstcast.forecasters._filtered import FilteredForecaster
from burstcast.forecasters.base import Forecaster
from burstcast.forecasters.equations_noisy import EquationsFromObservation


@dataclass(frozen=True)
class FilteredEquations(FilteredForecaster):
    """Integrates the equations from the estimate of an ensemble filter."""

    needs_equations: ClassVar[bool] = True
    aware: ClassVar[bool] = True
    model_class: ClassVar[type[Forecaster]] = EquationsFromObservation
