"""An extreme event that control suppresses, and the velocity along x in the midplane with and
without control. t_1: start of the actuation (shaded), up to which both flows are the same; t_2:
the event begins without control; t_3: its peak; t_4: its end. Of all events that the network
predicts and control suppresses, the largest one is shown.
Velocities are in units of U_0, that of the laminar flow halfway between centre and wall, lengths
in half the distance of the walls.
"""

from matplotlib.figure import Figure

from burstcast.figures.parts.nothing_to_show import nothing_to_show
from burstcast.figures.suppressed_event import suppressed_event
from burstcast.flow_grid import make_flow_grid
from burstcast_workflow.harness.figures import Arrays, Settings, figure
from burstcast_workflow.jobs.systems import system_of


@figure
def draw(*, event: Arrays, settings: Settings) -> Figure:
    """Draw the event."""
    system = system_of(settings)
    if not event["mark"].size:
        return nothing_to_show("No event was suppressed.")
    grid = make_flow_grid(system, settings["figures.flow_points"])
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
        settings["case.event_threshold"],
        symbol=system.observable_symbol,
    )
