"""An extreme event of the test set and the velocity along x in the midplane: data, forecast of
the example network, and their difference. t_1: last time that the observable is at or below its
mean; t_2: half-way up; t_3: peak; t_4: first time after it below the threshold. Of the isolated
events whose state the network predicts within a tolerance from before t_1 to t_4, the one is
shown whose peak is nearest to the configured one.
Velocities are in units of U_0, the velocity of the laminar flow halfway between centre and wall,
lengths in half the distance of the walls.
"""

from collections.abc import Mapping, Sequence
from typing import Any

from matplotlib.figure import Figure

from burstcast.arrays import FloatArray
from burstcast.figures.parts.nothing_to_show import nothing_to_show
from burstcast.figures.parts.planes import (
    add_row_bar,
    draw_plane,
    frame_evolution,
    label_planes,
    symmetric_norm,
)
from burstcast.figures.parts.style import (
    DOUBLE_COLUMN,
    NETWORK,
    TRUTH,
    new_figure,
    styled,
)
from burstcast.figures.registry import Declaration
from burstcast.systems.flow_grid import make_flow_grid
from burstcast.systems.registry import make_system

FIGURE = Declaration(
    section="forecasts",
    position=50,
    inputs={"event": "example/flow_event.nc"},
    settings={
        "system": "case.system",
        "parameters": "case.parameters",
        "flow_points": "figures.flow_points",
        "threshold": "case.event_threshold",
    },
    only_flows=True,
)


def draw(
    *,
    event: Mapping[str, Any],
    system: str,
    parameters: Mapping[str, float],
    flow_points: Sequence[int],
    threshold: float,
) -> Figure:
    """Draw the event."""
    if not event["mark"].size:
        return nothing_to_show("No isolated event occurred in the test set.")
    flow = make_system(system, parameters)
    grid = make_flow_grid(flow, flow_points)
    return midplane_planes(
        event["time_lt"],
        event["true"],
        event["forecast"],
        event["time_lt"][event["mark"]],
        grid.x,
        grid.z,
        grid.midplane(event["true_state"]),
        grid.midplane(event["forecast_state"]),
        threshold,
        symbol=flow.observable_symbol,
    )


@styled
def midplane_planes(
    time_lt: FloatArray,
    true: FloatArray,
    forecast: FloatArray,
    plane_times_lt: FloatArray,
    x: FloatArray,
    z: FloatArray,
    true_planes: FloatArray,
    forecast_planes: FloatArray,
    threshold: float,
    *,
    symbol: str = "k",
) -> Figure:
    """Draw (a) the observable with the times marked, below it the planes at these times.

    ``time_lt``, ``true``, ``forecast``: Observable over the event, ``(time,)``. ``true_planes``,
    ``forecast_planes``: Velocity along x, ``(planes, points_x, points_z)``.
    """
    figure = new_figure(DOUBLE_COLUMN, 4.6)
    top, bottom = figure.subfigures(2, 1, squeeze=False, height_ratios=[1.0, 2.1])[:, 0]
    evolution = top.subplots()
    evolution.plot(time_lt, true, label=rf"${symbol}_{{\mathrm{{True}}}}$", **TRUTH)
    evolution.plot(time_lt, forecast, label=rf"${symbol}_{{\mathrm{{ESN}}}}$", **NETWORK)
    frame_evolution(evolution, time_lt, [true, forecast], threshold, plane_times_lt, symbol)
    evolution.set_xlabel("Time from the start of the forecast [LT]")

    differences = forecast_planes - true_planes
    velocity = symmetric_norm([true_planes, forecast_planes])
    rows = (
        (true_planes, velocity, r"$u_{\mathrm{True}}$ [$U_0$]"),
        (forecast_planes, velocity, r"$u_{\mathrm{ESN}}$ [$U_0$]"),
        (
            differences,
            symmetric_norm([differences]),
            r"$u_{\mathrm{ESN}} - u_{\mathrm{True}}$ [$U_0$]",
        ),
    )
    panels = bottom.subplots(3, len(plane_times_lt), squeeze=False)
    for row, (planes, norm, label) in enumerate(rows):
        for column, plane in enumerate(planes):
            # Another colour map tells that the differences have a scale of their own.
            colours = "RdBu_r" if row < 2 else "PuOr_r"
            mesh = draw_plane(panels[row, column], x, z, plane, norm, colours)
        add_row_bar(figure, mesh, list(panels[row]), label)
        panels[row, 0].set_ylabel("$z$")
    label_planes(panels)
    return figure
