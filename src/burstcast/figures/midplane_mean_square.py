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

from burstcast.base.declared import at, read
from burstcast.figures.parts import errors, planes, style
from burstcast.figures.registry import figure
from burstcast.statistics.reductions import LongTermStatistics
from burstcast.systems.flow_grid import make_flow_grid
from burstcast.systems.registry import make_system


@figure(section="long_term", position=30, cases="long_term", only_flows=True)
def draw(
    *,
    data: Mapping[str, Any] = read("case/statistics_data.nc"),
    training: Mapping[str, Any] = read("case/statistics_training.nc"),
    long_term: Sequence[Mapping[str, Any]] = read("long_term_networks/long_term.nc"),
    system: str = at("case.system"),
    parameters: Mapping[str, float] = at("case.parameters"),
    flow_points: Sequence[int] = at("figures.flow_points"),
) -> Figure:
    """Draw u^2 in the data, and the errors of the best network and of the training set."""
    grid = make_flow_grid(make_system(system, parameters), flow_points)
    best = errors.best_of(data, long_term)
    if best is None:
        return style.nothing_to_show("No network has any long-term statistics.")
    true, trained = map(LongTermStatistics.from_arrays, (data, training))
    mean, *others = (
        grid.modes.midplane_mean_square(statistics.moments.mean_product, grid.x, grid.z)
        for statistics in (true, best.statistics, trained)
    )
    deviations = [np.abs(other - mean) for other in others]
    figure = style.new_figure(style.DOUBLE_COLUMN, 2.15)
    panels = list(figure.subplots(1, 3, sharey=True))
    # One scale for both errors: that they can be compared is the point.
    norms = [Normalize(0.0, float(mean.max()))]
    norms += [Normalize(0.0, max(float(error.max()) for error in deviations) or 1.0)] * 2
    colours = ("viridis", "inferno", "inferno")
    meshes = [
        planes.draw_plane(panel, grid.x, grid.z, field, norm, colour)
        for panel, field, norm, colour in zip(
            panels, [mean, *deviations], norms, colours, strict=True
        )
    ]
    for panel in panels:
        panel.set_xlabel("$x$")
    panels[0].set_ylabel("$z$")
    difference = r"$|\overline{u^2} - \overline{u^2}_{\mathrm{True}}|$ [$U_0^2$]: "
    for mesh, below, aspect, ticks, label in (
        (meshes[0], panels[:1], 22, 4, r"$\overline{u^2}_{\mathrm{True}}$ [$U_0^2$]"),
        (meshes[2], panels[1:], 46, 5, f"{difference}(b) {best.label}, (c) training set"),
    ):
        place: dict[str, Any] = {"aspect": aspect, "location": "top", "ticks": MaxNLocator(ticks)}
        figure.colorbar(mesh, ax=below, **place).set_label(label, labelpad=5)
    style.letter_panels(panels)
    for panel, error in zip(panels[1:], deviations, strict=True):
        panel.set_title(f"max. {float(error.max()):.2g}", loc="right")
    return figure
