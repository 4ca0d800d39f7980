"""The grid of a figure of the flow, from its settings."""

from collections.abc import Mapping
from typing import Any

from burstcast.flow_grid import FlowGrid, make_flow_grid
from burstcast.systems.registry import make_system


def flow_grid(settings: Mapping[str, Any]) -> FlowGrid:
    """Grid from the settings ``system``, ``parameters`` and ``flow_points`` of a job.

    Raises
    ------
    ValueError
        If the system is no flow.
    """
    system = make_system(settings["system"], settings["parameters"])
    return make_flow_grid(system, settings["flow_points"])
