"""States of series without equations, with an observable given by the user."""

from collections.abc import Callable

import numpy as np

from burstcast.arrays import FloatArray, float_array
from burstcast.systems.base import DynamicalSystem
from burstcast.systems.state_space import StateSpace

Observable = int | Callable[[FloatArray], FloatArray] | DynamicalSystem
"""A component, a function from states ``(..., component)`` to ``(...)``, or a system."""


class ObservedStates:
    """Series of which an observable is known, and no equations (a `StateSpace`)."""

    observable_name = "observable"
    observable_symbol = "q"

    def __init__(
        self, observable: int | Callable[[FloatArray], FloatArray], components: int
    ) -> None:
        if not callable(observable) and not -components <= observable < components:
            raise ValueError(
                f"observable is component {observable}, but the series have {components}: 0 to "
                f"{components - 1}"
            )
        self._given, self._components = observable, components

    @property
    def dimension(self) -> int:
        """Number of components."""
        return self._components

    def observable(self, state: FloatArray) -> FloatArray:
        """Observable of states ``(component, ...)``."""
        if not callable(self._given):
            component: FloatArray = state[self._given]
            return component
        # a copy of the same layout: the function may work in place
        states = np.moveaxis(state, 0, -1).copy(order="K")
        value = float_array(self._given(states), "the observable")
        if value.shape != state.shape[1:]:
            raise ValueError(
                f"the function of the observable must make (...) of states (..., component): of "
                f"{(*state.shape[1:], state.shape[0])} it made {value.shape}"
            )
        return value


def state_space(observable: Observable, components: int) -> StateSpace:
    """State space of a number of components with a given observable."""
    if not isinstance(observable, DynamicalSystem):
        return ObservedStates(observable, components)
    if observable.dimension != components:
        raise ValueError(
            f"the series have {components} components, states of the observable's system have "
            f"{observable.dimension}"
        )
    return observable
