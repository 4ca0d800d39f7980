"""The learnt polynomial model, started from the estimate of a filter over the washout."""

from dataclasses import dataclass
from typing import ClassVar

from burstcast.forecasters._filtered import FilteredForecaster
from burstcast.forecasters._options import QuadraticOptions
from burstcast.forecasters.base import Forecaster
from burstcast.forecasters.quadratic import QuadraticModel


@dataclass(frozen=True)
class FilteredQuadraticModel(QuadraticOptions, FilteredForecaster):
    """Integrates the learnt equations from the estimate of an ensemble filter."""

    model_class: ClassVar[type[Forecaster]] = QuadraticModel
