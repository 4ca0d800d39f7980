"""Components of the training series of an event forecaster: their labels and their order."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from burstcast.base.arrays import FloatArray, IntArray
from burstcast.base.natural_order import natural_order
from burstcast.data.series_layout import nearly_the_same


@dataclass(frozen=True)
class Components:
    """Components as a user gives them, and the order that forecasters have them in.

    Labelled components are sorted by their labels, so that series whose components come in another
    order make the same forecaster.
    """

    count: int  #: number of components
    labels: tuple[str, ...] | None = None  #: in the order of the training series; None: none
    keep_order: bool = False  #: whether a system, whose states are the series, sets the order

    @cached_property
    def order(self) -> IntArray:
        """Place in the training series of each component of a forecaster."""
        if self.labels is None or self.keep_order:
            return np.arange(self.count)
        labels = self.labels
        return np.array(sorted(range(self.count), key=lambda place: natural_order(labels[place])))

    @property
    def names(self) -> tuple[str, ...]:
        """Labels, or numbers in the training series, of the components of a forecaster."""
        labels = self.labels or tuple(f"component {place}" for place in range(self.count))
        return tuple(labels[place] for place in self.order)

    @cached_property
    def places(self) -> IntArray:
        """Place in a forecaster of each component of the training series."""
        return np.argsort(self.order)

    def place(self, component: int | str) -> int:
        """Place in a forecaster of a component by its number or its label in the series."""
        if isinstance(component, str):
            if component not in (self.labels or ()):
                described = f"labels {', '.join(self.labels)}" if self.labels else "no labels"
                hint = nearly_the_same(self.labels or (), [component])
                raise ValueError(
                    f"observable is {component!r}, but the series have {described}{hint}"
                )
            component = list(self.labels or ()).index(component)
        elif not -self.count <= component < self.count:
            raise ValueError(
                f"observable is component {component}, but the series have {self.count}: 0 to "
                f"{self.count - 1}"
            )
        return int(self.places[component])

    def arranged(
        self, states: FloatArray, labels: Sequence[str] | None, what: str = "the series"
    ) -> FloatArray:
        """States ``(..., component)`` of a user in the order of a forecaster, by label."""
        if labels is not None and self.labels is not None and tuple(labels) != self.labels:
            if sorted(labels) != sorted(self.labels):
                raise ValueError(
                    f"the components of {what} are {', '.join(labels)}; those of the training "
                    f"series were {', '.join(self.labels)}{nearly_the_same(self.labels, labels)}"
                )
            states = states[..., [list(labels).index(label) for label in self.labels]]
        if states.shape[-1] != self.count:
            raise ValueError(
                f"{what} have {states.shape[-1]} components, the training series had {self.count}"
            )
        return states if self._is_given else np.ascontiguousarray(states[..., self.order])

    def units_for(
        self, labels: Sequence[str] | None, units: tuple[str, ...] | None
    ) -> tuple[str, ...] | None:
        """Units of the training series in the order of other labels."""
        if units is None or labels is None or self.labels is None:
            return units
        return tuple(units[self.labels.index(label)] for label in labels)

    def as_given(self, states: FloatArray) -> FloatArray:
        """States ``(..., component)`` of a forecaster in the order of the training series."""
        return states if self._is_given else states[..., self.places]

    @cached_property
    def _is_given(self) -> bool:
        """Whether forecasters have the components in the order of the training series."""
        return bool((self.order == np.arange(self.count)).all())
