"""Systems that are nothing but a map from one state to the next: no equations in time."""

import abc

from burstcast.base.arrays import FloatArray
from burstcast.systems.base import DynamicalSystem


class FlowMap(DynamicalSystem):
    """A system that advances by a map of its own and has no right-hand side.

    A subclass says `flow_map`. Everything that only advances states works: data, exponents (the
    map is differentiated), the equations as forecasters, filters, control by other parameters.
    Control by a force needs a right-hand side.
    """

    @abc.abstractmethod
    def flow_map(self, state: FloatArray, time_step: float) -> FloatArray:
        """State one integration step later, both of shape ``(dimension, ...)``."""

    def right_hand_side(self, state: FloatArray) -> FloatArray:
        """Raise: a map has no right-hand side."""
        raise ValueError(f"{type(self).__name__} advances by a map and has no right-hand side")
