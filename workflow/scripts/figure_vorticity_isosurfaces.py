"""Draw vorticity and velocity of the flow before and after an event."""

from typing import Any

import numpy as np

from burstcast.figures.nothing_to_show import nothing_to_show
from burstcast.figures.vorticity_isosurfaces import FlowSnapshot, vorticity_isosurfaces
from burstcast_workflow.figure_files import write_figure
from burstcast_workflow.flow_fields import flow_grid
from burstcast_workflow.job import Provenance, run_job
from burstcast_workflow.storage import read_netcdf

BEFORE, AFTER = 2, 3
"""Of the event's four times: the peak, and when the laminar structure has broken down."""


def main(inputs: Any, outputs: Any, settings: dict[str, Any], provenance: Provenance) -> None:
    """Draw the true flow at the event's peak and after its breakdown."""
    event = read_netcdf(inputs.event)
    if event["mark"].size:
        grid = flow_grid(settings)
        axes = np.meshgrid(grid.x, grid.y, grid.z, indexing="ij", sparse=True)
        snapshots = [
            FlowSnapshot(
                f"$t_{index + 1}$, {title} the breakdown",
                grid.modes.velocity(event["true_state"][index], *axes),
                grid.modes.vorticity(event["true_state"][index], *axes)[0],
            )
            for index, title in ((BEFORE, "before"), (AFTER, "after"))
        ]
        largest = max(float(np.abs(snapshot.scalar).max()) for snapshot in snapshots)
        figure = vorticity_isosurfaces(
            grid.x, grid.y, grid.z, snapshots, settings["isosurface_level"] * largest
        )
    else:
        figure = nothing_to_show("No isolated event occurred in the test set.")
    write_figure(outputs, figure)


if __name__ == "__main__":
    run_job(snakemake, main)  # noqa: F821 - Snakemake puts it there
