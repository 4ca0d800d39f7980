"""Learnt equations that know the parameters in force, started from a filter's estimate.

The filter's model receives the parameters as well, from each observation to the next.
"""

from dataclasses import dataclass
from typing import ClassVar

from burstcast.forecasters._filtered import FilteredForecaster
from burstcast.forecasters._options import AwareOptions, QuadraticOptions
from burstcast.forecasters.base import Forecaster
from burstcast.forecasters.quadratic_aware import AwareQuadraticModel


@dataclass(frozen=True)
class FilteredAwareQuadraticModel(QuadraticOptions, AwareOptions, FilteredForecaster):
    """Integrates learnt equations under inputs from the estimate of an ensemble filter."""

    aware: ClassVar[bool] = True
    learns_parameters: ClassVar[bool] = True
    model_class: ClassVar[type[Forecaster]] = AwareQuadraticModel
