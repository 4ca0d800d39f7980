"""Equations of a box longer than the flow's, with a filter, as a forecaster of a campaign."""

from dataclasses import dataclass, replace
from typing import ClassVar

from burstcast.forecasters.base import Forecaster
from burstcast.forecasters.equations_filtered import FilteredEquations
from burstcast.forecasters.equations_noisy import EquationsFromObservation


@dataclass(frozen=True)
class EquationsOfAnotherBox(EquationsFromObservation):
    """The equations of the case but for the length of the box."""

    factor: float = 1.0  #: length of the box in units of the flow's

    def restore(self, record, case):
        """Take the equations of the case with another length."""
        length = self.factor * case.system.length_x
        another = replace(case, system=replace(case.system, length_x=length))
        return super().restore(record, another)


@dataclass(frozen=True)
class FilteredEquationsOfAnotherBox(FilteredEquations):
    """The same, started from the estimate of a filter that uses them, too."""

    factor: float = 1.0  #: length of the box in units of the flow's

    model_class: ClassVar[type[Forecaster]] = EquationsOfAnotherBox
