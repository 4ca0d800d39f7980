"""An extreme event of the test set and the velocity along x in the midplane: data, forecast of
the example network, and their difference. t_1: last time that the observable is at or below its
mean; t_2: half-way up; t_3: peak; t_4: first time after it below the threshold. Of the isolated
events whose state the network predicts within a tolerance from before t_1 to t_4, the one is
shown whose peak is nearest to the configured one.
Velocities are in units of U_0, that of the laminar flow halfway between centre and wall, lengths
in half the distance of the walls.
"""

from matplotlib.figure import Figure

from burstcast.figures.midplane_planes import midplane_planes
from burstcast.figures.parts.nothing_to_show import nothing_to_show
from burstcast.flow_grid import make_flow_grid
from burstcast_workflow.harness.figures import Arrays, Settings, figure
from burstcast_workflow.jobs.systems import system_of


@figure
def draw(*, event: Arrays, settings: Settings) -> Figure:
    """Draw the event."""
    system = system_of(settings)
    if not event["mark"].size:
        return nothing_to_show("No isolated event occurred in the test set.")
    grid = make_flow_grid(system, settings["figures.flow_points"])
    return midplane_planes(
        event["time_lt"],
        event["true"],
        event["forecast"],
        event["time_lt"][event["mark"]],
        grid.x,
        grid.z,
        grid.midplane(event["true_state"]),
        grid.midplane(event["forecast_state"]),
        settings["case.event_threshold"],
        symbol=system.observable_symbol,
    )
