"""Some components of a state, observed themselves."""

from dataclasses import dataclass

import numpy as np

from burstcast.base.arrays import FloatArray
from burstcast.data.observation.base import Observation
from burstcast.systems.state_space import StateSpace, component_names


@dataclass(frozen=True)
class ObservedComponents(Observation):
    """The components of these names; a ValueError names one that the states have not."""

    space: StateSpace
    names: tuple[str, ...]

    def __post_init__(self) -> None:
        components = component_names(self.space)
        for name in self.names:
            if name not in components or self.names.count(name) > 1:
                raise ValueError(f"components must be some of {', '.join(components)}, each once")

    @property
    def channels(self) -> tuple[str, ...]:
        """Names of the components."""
        return self.names

    @property
    def matrix(self) -> FloatArray:
        """Rows of the unit matrix, ``(observed, dimension)``."""
        components = component_names(self.space)
        return np.eye(len(components))[[components.index(name) for name in self.names]]
