"""Draw a suppressed event and the velocity in the midplane, with and without control."""

from typing import Any

from burstcast.figures.nothing_to_show import nothing_to_show
from burstcast.figures.suppressed_event import suppressed_event
from burstcast_workflow.figure_files import write_figure
from burstcast_workflow.flow_fields import flow_grid
from burstcast_workflow.job import Provenance, run_job
from burstcast_workflow.storage import read_netcdf


def main(inputs: Any, outputs: Any, settings: dict[str, Any], provenance: Provenance) -> None:
    """Draw the event."""
    event = read_netcdf(inputs.event)
    if event["mark"].size:
        grid = flow_grid(settings)
        figure = suppressed_event(
            event["time_lt"],
            event["uncontrolled"],
            event["controlled"],
            tuple(event["actuation_lt"]),
            event["time_lt"][event["mark"]],
            grid.x,
            grid.z,
            grid.midplane(event["uncontrolled_state"]),
            grid.midplane(event["controlled_state"]),
            settings["event_threshold"],
            symbol=settings["symbol"],
        )
    else:
        figure = nothing_to_show("No event was suppressed.")
    write_figure(outputs, figure)


if __name__ == "__main__":
    run_job(snakemake, main)  # noqa: F821 - Snakemake puts it there
