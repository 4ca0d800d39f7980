"""An extreme event that control suppresses, and the velocity along x in the midplane with and
without control. t_1: start of the actuation (shaded), up to which both flows are the same; t_2:
the event begins without control; t_3: its peak; t_4: its end. Of all events that the network
predicts and control suppresses, the largest one is shown.
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
    CONTROLLED,
    DOUBLE_COLUMN,
    GREEN,
    TRUTH,
    new_figure,
    styled,
)
from burstcast.figures.registry import Declaration
from burstcast.systems.flow_grid import make_flow_grid
from burstcast.systems.registry import make_system

FIGURE = Declaration(
    section="control",
    position=20,
    inputs={"event": "suppressed_event"},
    settings={
        "system": "case.system",
        "parameters": "case.parameters",
        "flow_points": "figures.flow_points",
        "threshold": "case.event_threshold",
    },
    cases="control_example",
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
        return nothing_to_show("No event was suppressed.")
    flow = make_system(system, parameters)
    grid = make_flow_grid(flow, flow_points)
    start, stop = event["actuation_lt"]
    return suppressed_event(
        event["time_lt"],
        event["uncontrolled"],
        event["controlled"],
        (start, stop),
        event["time_lt"][event["mark"]],
        grid.x,
        grid.z,
        grid.midplane(event["uncontrolled_state"]),
        grid.midplane(event["controlled_state"]),
        threshold,
        symbol=flow.observable_symbol,
    )


@styled
def suppressed_event(
    time_lt: FloatArray,
    uncontrolled: FloatArray,
    controlled: FloatArray,
    actuation_lt: tuple[float, float],
    plane_times_lt: FloatArray,
    x: FloatArray,
    z: FloatArray,
    uncontrolled_planes: FloatArray,
    controlled_planes: FloatArray,
    threshold: float,
    *,
    symbol: str = "k",
) -> Figure:
    """Draw (a) the observable with and without control, (b, c) the midplane at the times marked.

    ``time_lt``, ``uncontrolled``, ``controlled``: Observable over the event, ``(time,)``.
    ``uncontrolled_planes``, ``controlled_planes``: Velocity along x, ``(planes, points_x,
    points_z)``.
    """
    figure = new_figure(DOUBLE_COLUMN, 3.8)
    top, bottom = figure.subfigures(2, 1, squeeze=False, height_ratios=[1.0, 1.45])[:, 0]
    evolution = top.subplots()
    evolution.axvspan(
        *actuation_lt, color=GREEN, alpha=0.13, linewidth=0, zorder=0.4, label="actuation"
    )
    evolution.plot(time_lt, uncontrolled, label="without control", **TRUTH)
    evolution.plot(time_lt, controlled, label="with control", **CONTROLLED)
    frame_evolution(
        evolution, time_lt, [uncontrolled, controlled], threshold, plane_times_lt, symbol
    )
    evolution.set_xlabel("Time from the forecast [LT]")

    norm = symmetric_norm([uncontrolled_planes, controlled_planes])
    panels = bottom.subplots(2, len(plane_times_lt), squeeze=False)
    for row, (planes, label) in enumerate(
        ((uncontrolled_planes, "without control"), (controlled_planes, "with control"))
    ):
        for column, plane in enumerate(planes):
            mesh = draw_plane(panels[row, column], x, z, plane, norm, "RdBu_r")
        panels[row, 0].set_ylabel(f"{label}\n$z$")
    label_planes(panels)
    add_row_bar(figure, mesh, list(panels.flat), "$u$ [$U_0$]", ticks=5)
    return figure
