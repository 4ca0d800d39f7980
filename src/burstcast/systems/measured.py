"""Measured series: states without equations."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from burstcast.base.arrays import FloatArray
from burstcast.base.expressions import Expression


@dataclass(frozen=True)
class MeasuredSeries:
    """Measured series as a `burstcast.systems.state_space.StateSpace`.

    The observable is a component or an expression of components, and then evaluated on whatever
    states are asked about, measured or forecast. If it is something else, it was measured beside
    the components, and is the last component of the state: it is forecast as all others are.
    """

    components: Sequence[str]  #: names of what was measured, in the order of a state
    observable_of: str  #: one of these names, an expression of them, or something else
    #: what it is, for axes and tables; the observable as it is written if left out
    observable_name: str = ""
    observable_symbol: str = ""  #: its symbol in TeX, without dollars; made of its name if left out

    def __post_init__(self) -> None:
        # lists of JSON, as tuples: equal descriptions are equal
        object.__setattr__(self, "components", tuple(self.components))
        object.__setattr__(self, "observable_name", self.observable_name or self.observable_of)
        symbol = self.observable_symbol or _symbol(self.observable_name)
        object.__setattr__(self, "observable_symbol", symbol)

    @property
    def appended(self) -> bool:
        """Whether the observable is a component of its own, after all others."""
        if self.observable_of in self.components:
            return False
        return not set(Expression(self.observable_of).names) <= set(self.components)

    @property
    def component_names(self) -> tuple[str, ...]:
        """Names of all components of a state."""
        more = (self.observable_of,) if self.appended else ()
        return (*self.components, *more)

    @property
    def dimension(self) -> int:
        """Number of components of a state."""
        return len(self.component_names)

    def observable(self, state: FloatArray) -> FloatArray:
        """Observable of states ``(dimension, ...)``, of shape ``(...)``."""
        names = self.component_names
        if self.observable_of in names:
            return np.array(state[names.index(self.observable_of)])
        return Expression(self.observable_of)(dict(zip(names, state, strict=True)))


def _symbol(text: str) -> str:
    """Name as TeX shows it; an expression has no symbol by itself."""
    sign, name = ("-", text[1:]) if text.startswith("-") else ("", text)
    if len(name) == 1 and name.isalpha():
        return text
    name = name if len(name) > 1 and name.isidentifier() else "observable"
    return (sign if name != "observable" else "") + rf"\mathrm{{{name}}}".replace("_", r"\_")
