"""(a) Time average of the square of the velocity along x in the midplane. Its absolute error (b)
in the long closed loops of the network that has the smallest Kantorovich metric of its ensemble,
and (c) in the training set.
Velocities are in units of U_0, the velocity of the laminar flow halfway between centre and wall,
lengths in half the distance of the walls.
"""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from burstcast.arrays import FloatArray
from burstcast.figures.parts.best_network import best_of
from burstcast.figures.parts.nothing_to_show import nothing_to_show
from burstcast.figures.parts.planes import draw_plane
from burstcast.figures.parts.style import DOUBLE_COLUMN, letter_panels, new_figure, styled
from burstcast.figures.registry import Declaration
from burstcast.statistics import profiles
from burstcast.statistics.reductions import LongTermStatistics
from burstcast.systems.flow_grid import make_flow_grid
from burstcast.systems.registry import make_system

FIGURE = Declaration(
    section="long_term",
    position=30,
    inputs={
        "data": "case/statistics_data.nc",
        "training": "case/statistics_training.nc",
        "long_term": "long_term_networks/long_term.nc",
    },
    settings={
        "system": "case.system",
        "parameters": "case.parameters",
        "flow_points": "figures.flow_points",
    },
    cases="long_term",
    only_flows=True,
)


def draw(
    *,
    data: Mapping[str, Any],
    training: Mapping[str, Any],
    long_term: Sequence[Mapping[str, Any]],
    system: str,
    parameters: Mapping[str, float],
    flow_points: Sequence[int],
) -> Figure:
    """Draw the data, and the deviations of the best network and of the training set."""
    grid = make_flow_grid(make_system(system, parameters), flow_points)
    best = best_of(data, long_term)
    if best is None:
        return nothing_to_show("No network has any long-term statistics.")
    true, trained = map(LongTermStatistics.from_arrays, (data, training))
    fields = [
        profiles.midplane_mean_square(grid.modes, statistics.moments, grid.x, grid.z)
        for statistics in (true, best.statistics, trained)
    ]
    return midplane_mean_square(grid.x, grid.z, *fields, network_label=best.label)


@styled
def midplane_mean_square(
    x: FloatArray,
    z: FloatArray,
    true: FloatArray,
    network: FloatArray,
    training: FloatArray,
    *,
    network_label: str = "echo state network",
) -> Figure:
    """Draw (a) the time average of u^2 in the data, (b) the network's error, (c) the training's.

    ``true``, ``network``, ``training``: Time averages of u^2, ``(points_x, points_z)``.
    """
    errors = [np.abs(network - true), np.abs(training - true)]
    figure = new_figure(DOUBLE_COLUMN, 2.15)
    panels = figure.subplots(1, 3, sharey=True)
    mean = draw_plane(panels[0], x, z, true, Normalize(0.0, float(true.max())), "viridis")
    # One scale for both errors: that they can be compared is the point.
    norm = Normalize(0.0, max(float(error.max()) for error in errors) or 1.0)
    for panel, error in zip(panels[1:], errors, strict=True):
        mesh = draw_plane(panel, x, z, error, norm, "inferno")
    for panel in panels:
        panel.set_xlabel("$x$")
    panels[0].set_ylabel("$z$")
    bar = figure.colorbar(mean, ax=panels[0], aspect=22, location="top", ticks=MaxNLocator(4))
    bar.set_label(r"$\overline{u^2}_{\mathrm{True}}$ [$U_0^2$]", labelpad=5)
    bar = figure.colorbar(
        mesh, ax=list(panels[1:]), aspect=46, location="top", ticks=MaxNLocator(5)
    )
    bar.set_label(
        r"$|\overline{u^2} - \overline{u^2}_{\mathrm{True}}|$ [$U_0^2$]: "
        f"(b) {network_label}, (c) training set",
        labelpad=5,
    )
    letter_panels(list(panels))
    for panel, error in zip(panels[1:], errors, strict=True):
        panel.set_title(f"max. {float(error.max()):.2g}", loc="right")
    return figure
