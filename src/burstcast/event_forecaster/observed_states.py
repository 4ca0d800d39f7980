"""States of series without equations, with an observable given by the user."""

from collections.abc import Callable, Sequence

import numpy as np

from burstcast.base.arrays import FloatArray, float_array
from burstcast.event_forecaster.components import Components
from burstcast.systems.base import DynamicalSystem
from burstcast.systems.state_space import StateSpace

Observable = int | str | Callable[[FloatArray], FloatArray] | DynamicalSystem
"""A component by its number or its label, a function from states ``(..., component)`` to ``(...)``,
or a system.
"""


class ObservedStates:
    """Series of which an observable is known, and no equations (a `StateSpace`)."""

    observable_name = "observable"
    observable_symbol = "q"

    def __init__(
        self, observable: int | str | Callable[[FloatArray], FloatArray], components: Components
    ) -> None:
        self._given = observable if callable(observable) else components.place(observable)
        self._components = components

    @property
    def dimension(self) -> int:
        """Number of components."""
        return self._components.count

    def observable(self, state: FloatArray) -> FloatArray:
        """Observable of states ``(component, ...)``."""
        if not callable(self._given):
            component: FloatArray = state[self._given]
            return component
        # a copy of the same layout: the function may work in place
        states = self._components.as_given(np.moveaxis(state, 0, -1)).copy(order="K")
        value = float_array(self._given(states), "the observable")
        if value.shape != state.shape[1:]:
            raise ValueError(
                f"the function of the observable must make (...) of states (..., component): of "
                f"{(*state.shape[1:], state.shape[0])} it made {value.shape}"
            )
        return value


def state_space(observable: Observable, components: Components) -> StateSpace:
    """State space of some components with a given observable."""
    if not isinstance(observable, DynamicalSystem):
        return ObservedStates(observable, components)
    if observable.dimension != components.count:
        raise ValueError(
            f"the series have {components.count} components, states of the observable's system "
            f"have {observable.dimension}"
        )
    return observable


def check_order(observable: Observable, labels: Sequence[str] | None) -> None:
    """Check that labels are not those of the states of a system in another order."""
    names = getattr(observable, "component_names", None)
    if not isinstance(observable, DynamicalSystem) or labels is None or names is None:
        return
    if tuple(labels) != tuple(names) and sorted(labels) == sorted(names):
        raise ValueError(
            f"the series have the components {', '.join(labels)}, but the states of the "
            f"observable's system have the order {', '.join(names)}: bring them into it "
            f"(table[{list(names)}])"
        )
