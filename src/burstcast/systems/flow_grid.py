"""Grids on which the velocity of a flow is shown."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from burstcast.base.arrays import FloatArray
from burstcast.systems.mfe_modes import MoehlisFaisstEckhardtModes, flow_modes
from burstcast.systems.state_space import StateSpace


@dataclass(frozen=True)
class FlowGrid:
    """Velocity modes of a flow and the lines of a grid, ends included."""

    modes: MoehlisFaisstEckhardtModes  #: modes of the system
    #: x, y, z: coordinates of the lines along each direction
    x: FloatArray
    y: FloatArray
    z: FloatArray

    def midplane(self, states: FloatArray) -> FloatArray:
        """Velocity u in the midplane of states ``(times, component)``: ``(times, x, z)``."""
        return self.modes.midplane_velocity(states.T, self.x, self.z)


def make_flow_grid(system: StateSpace, points: Sequence[int]) -> FlowGrid:
    """Grid over the whole domain of a flow."""
    modes = flow_modes(system)
    if modes is None:
        raise ValueError(f"the system {type(system).__name__} has no velocity field")
    ends = ((0.0, modes.length_x), (-1.0, 1.0), (0.0, modes.length_z))
    x, y, z = (
        np.linspace(low, high, count) for (low, high), count in zip(ends, points, strict=True)
    )
    return FlowGrid(modes, x, y, z)
