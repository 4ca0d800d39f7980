"""Observed part of a state: components, and quantities computed from components."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from burstcast.base.arrays import FloatArray
from burstcast.data.measured_data import Quantity
from burstcast.systems.measured import MeasuredSeries
from burstcast.systems.state_space import StateSpace, component_names

OBSERVABLE = "observable"
"""Name of the observable among the columns of another state."""


@dataclass(frozen=True)
class ObservedPart:
    """Observed part of states: components, expressions of components, and the observable.

    Examples
    --------
    >>> from burstcast.systems.mfe import MoehlisFaisstEckhardt
    >>> flow = MoehlisFaisstEckhardt(400.0, 4 * np.pi, 2 * np.pi)
    >>> part = ObservedPart.of(flow, ["a1", "profile = a1 - a9"], "observable")
    >>> part.space.component_names
    ('a1', 'profile', 'observable')
    >>> part(np.ones((9, 5))).shape
    (3, 5)
    """

    source: StateSpace  #: of the whole states
    space: MeasuredSeries  #: of the observed part
    #: components of `space`, from the components of `source` and ``observable``
    quantities: tuple[Quantity, ...]

    @classmethod
    def of(cls, source: StateSpace, declarations: Sequence[str], observable: str) -> "ObservedPart":
        """Observe components of a state, or ``name = expression`` of components.

        ``observable``: One of the observed components, an expression of them, or ``observable``.
        """
        quantities = [Quantity(text) for text in declarations]
        space = MeasuredSeries([quantity.name for quantity in quantities], observable)
        if space.appended:
            quantities.append(Quantity(observable))
        for quantity in quantities:
            quantity.columns([*component_names(source), OBSERVABLE])
        return cls(source, space, tuple(quantities))

    def __call__(self, states: FloatArray) -> FloatArray:
        """Observe states ``(dimension, ...)``: ``(observed, ...)``, without noise."""
        columns = dict(zip(component_names(self.source), states, strict=True))
        columns[OBSERVABLE] = self.source.observable(states)
        values = [quantity.values(columns) for quantity in self.quantities]
        return np.stack(np.broadcast_arrays(*values))
