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

from burstcast.base.declared import at, read
from burstcast.figures.parts import frame, looks, planes, style
from burstcast.figures.registry import figure
from burstcast.systems.flow_grid import make_flow_grid
from burstcast.systems.registry import make_system


@figure(section="forecasts", position=50, only_flows=True, needs_networks=True)
def draw(
    *,
    event: Mapping[str, Any] = read("example/flow_event.nc"),
    system: str = at("case.system"),
    parameters: Mapping[str, float] = at("case.parameters"),
    flow_points: Sequence[int] = at("figures.flow_points"),
    threshold: float = read("case/event_threshold.json:event_threshold"),
) -> Figure:
    """Draw the observable over the event, and below it the planes at the times marked."""
    if not event["mark"].size:
        return style.nothing_to_show("No isolated event occurred in the test set.")
    flow = make_system(system, parameters)
    grid = make_flow_grid(flow, flow_points)
    labels = frame.true_and_forecast(flow.observable_symbol)
    curves = [
        (event["true"], labels[0], looks.TRUTH),
        (event["forecast"], labels[1], looks.NETWORK),
    ]
    time_lt = event["time_lt"]
    figure, evolution, panels = planes.evolution_above_planes(
        (4.6, 2.1), 3, time_lt, curves, time_lt[event["mark"]], threshold, flow.observable_symbol
    )
    evolution.set_xlabel("Time from the start of the forecast [LT]")
    true, forecast = (grid.midplane(event[f"{name}_state"]) for name in ("true", "forecast"))
    velocity = planes.symmetric_norm([true, forecast])
    deviation = planes.symmetric_norm([forecast - true])
    names = r"u_{\mathrm{True}}", r"u_{\mathrm{ESN}}", r"u_{\mathrm{ESN}} - u_{\mathrm{True}}"
    # Another colour map tells that the differences have a scale of their own.
    shown = (true, velocity, "RdBu_r"), (forecast, velocity, "RdBu_r")
    for row, name, (fields, norm, colours) in zip(
        panels, names, (*shown, (forecast - true, deviation, "PuOr_r")), strict=True
    ):
        for axes, field in zip(row, fields, strict=True):
            mesh = planes.draw_plane(axes, grid.x, grid.z, field, norm, colours)
        row[0].set_ylabel("$z$")
        planes.add_row_bar(figure, mesh, row, f"${name}$ [$U_0$]")
    planes.label_planes(panels)
    return figure
