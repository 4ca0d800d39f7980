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

from burstcast.base.declared import at, read
from burstcast.figures.parts import looks, planes, style
from burstcast.figures.registry import figure
from burstcast.systems.flow_grid import make_flow_grid
from burstcast.systems.registry import make_system


@figure(section="control", position=20, cases="control_example", only_flows=True)
def draw(
    *,
    event: Mapping[str, Any] = read("suppressed_event"),
    system: str = at("case.system"),
    parameters: Mapping[str, float] = at("case.parameters"),
    flow_points: Sequence[int] = at("figures.flow_points"),
    threshold: float = read("case/event_threshold.json:event_threshold"),
) -> Figure:
    """Draw the observable with and without control, and the midplane at the times marked."""
    if not event["mark"].size:
        return style.nothing_to_show("No event was suppressed.")
    flow = make_system(system, parameters)
    grid = make_flow_grid(flow, flow_points)
    looks_of = {"uncontrolled": looks.TRUTH, "controlled": looks.CONTROLLED}
    labels = {"uncontrolled": "without control", "controlled": "with control"}
    start, stop = event["actuation_lt"]
    shaded = {"xmin": start, "xmax": stop, "color": style.GREEN, "alpha": 0.13, "linewidth": 0}
    figure, evolution, panels = planes.evolution_above_planes(
        (3.8, 1.45),
        2,
        event["time_lt"],
        [(event[name], labels[name], look) for name, look in looks_of.items()],
        event["time_lt"][event["mark"]],
        threshold,
        flow.observable_symbol,
        {**shaded, "zorder": 0.4, "label": "actuation"},
    )
    evolution.set_xlabel("Time from the forecast [LT]")
    fields = {name: grid.midplane(event[f"{name}_state"]) for name in labels}
    norm = planes.symmetric_norm([*fields.values()])
    for row, (name, label) in zip(panels, labels.items(), strict=True):
        for axes, field in zip(row, fields[name], strict=True):
            mesh = planes.draw_plane(axes, grid.x, grid.z, field, norm, "RdBu_r")
        row[0].set_ylabel(f"{label}\n$z$")
    planes.label_planes(panels)
    planes.add_row_bar(figure, mesh, list(panels.flat), "$u$ [$U_0$]", ticks=5)
    return figure
