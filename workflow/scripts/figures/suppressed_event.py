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
from burstcast_workflow.harness.figures import run_figure
from burstcast_workflow.harness.settings import Settings
from burstcast_workflow.harness.storage import read_netcdf
from burstcast_workflow.jobs.systems import system_of


def draw(*, event: str, settings: Settings) -> Figure:
    """Draw the event."""
    data, system = read_netcdf(event), system_of(settings)
    if not data["mark"].size:
        return nothing_to_show("No event was suppressed.")
    grid = make_flow_grid(system, settings["figures.flow_points"])
    start, stop = data["actuation_lt"]
    return suppressed_event(
        data["time_lt"],
        data["uncontrolled"],
        data["controlled"],
        (start, stop),
        data["time_lt"][data["mark"]],
        grid.x,
        grid.z,
        grid.midplane(data["uncontrolled_state"]),
        grid.midplane(data["controlled_state"]),
        settings["case.event_threshold"],
        symbol=system.observable_symbol,
    )


if __name__ == "__main__":
    run_figure(snakemake, draw)  # noqa: F821 - Snakemake puts it there
