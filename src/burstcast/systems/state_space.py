"""State spaces: components and observable, on which forecasts and scores depend.

Dynamical systems have a state space, and so have measured series, whose equations are unknown
(`burstcast.systems.measured`).
"""

from collections.abc import Mapping
from typing import Any, Protocol

import burstcast.systems
from burstcast.base.arrays import FloatArray
from burstcast.base.discovery import concrete_classes

MEASURED = "measured"
"""Name of what stands where a system's name does, for series that were measured."""


class StateSpace(Protocol):
    """Space of states with a number of components and a scalar observable."""

    @property
    def dimension(self) -> int:
        """Number of components of a state."""

    @property
    def observable_name(self) -> str:
        """Name of the observable for axes and tables, such as "kinetic energy"."""

    @property
    def observable_symbol(self) -> str:
        """Symbol of the observable in TeX, without dollars: "k"."""

    def observable(self, state: FloatArray) -> FloatArray:
        """Observable of states ``(dimension, ...)``, of shape ``(...)``."""


def component_names(space: StateSpace) -> tuple[str, ...]:
    """Names of the components: the attribute ``component_names``, or else a1, a2, ..."""
    names = getattr(space, "component_names", None)
    return tuple(names) if names else tuple(f"a{i}" for i in range(1, space.dimension + 1))


def make_measured(description: Mapping[str, Any]) -> StateSpace:
    """Make a `MeasuredSeries`, found by name so that code of other cases does not depend on it."""
    (measured,) = concrete_classes(burstcast.systems, MEASURED, object)
    series: StateSpace = measured(**description)  # type: ignore[assignment]
    return series
