"""Grids on which figures show the flow."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from burstcast.arrays import FloatArray
from burstcast.statistics.profiles import flow_modes
from burstcast.systems.mfe_modes import MoehlisFaisstEckhardtModes
from burstcast.systems.registry import make_system


@dataclass(frozen=True)
class FlowGrid:
    """Velocity modes of a flow and the lines of a grid, ends included.

    Attributes
    ----------
    modes
        Of the system.
    x, y, z
        Coordinates of the lines along each direction.
    """

    modes: MoehlisFaisstEckhardtModes
    x: FloatArray
    y: FloatArray
    z: FloatArray

    def midplane(self, states: FloatArray) -> FloatArray:
        """Velocity u in the midplane of states ``(times, component)``: ``(times, x, z)``."""
        return self.modes.midplane_velocity(states.T, self.x, self.z)


def flow_grid(settings: Mapping[str, Any]) -> FlowGrid:
    """Grid from the settings ``system``, ``parameters`` and ``flow_points`` of a job.

    Raises
    ------
    ValueError
        If the system is no flow.
    """
    modes = flow_modes(make_system(settings["system"], settings["parameters"]))
    if modes is None:
        raise ValueError(f"the system {settings['system']} has no velocity field")
    ends = ((0.0, modes.length_x), (-1.0, 1.0), (0.0, modes.length_z))
    x, y, z = (
        np.linspace(low, high, points)
        for (low, high), points in zip(ends, settings["flow_points"], strict=True)
    )
    return FlowGrid(modes, x, y, z)
