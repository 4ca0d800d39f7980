"""Isosurfaces of plus and minus one value of the streamwise vorticity, and velocity vectors, at
the peak of the event of the midplane figure and after its breakdown. The mean flow is along x,
sheared in y between the walls.
"""

import numpy as np
from matplotlib.figure import Figure

from burstcast.figures.parts.nothing_to_show import nothing_to_show
from burstcast.figures.vorticity_isosurfaces import FlowSnapshot, vorticity_isosurfaces
from burstcast.flow_grid import make_flow_grid
from burstcast_workflow.harness.figures import Arrays, Settings, figure
from burstcast_workflow.jobs.systems import system_of

BEFORE, AFTER = 2, 3
"""Of the event's four times: the peak, and when the laminar structure has broken down."""


@figure
def draw(*, event: Arrays, settings: Settings) -> Figure:
    """Draw the true flow at the event's peak and after its breakdown."""
    if not event["mark"].size:
        return nothing_to_show("No isolated event occurred in the test set.")
    grid = make_flow_grid(system_of(settings), settings["figures.flow_points"])
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
    level = settings["figures.isosurface_level"] * largest
    return vorticity_isosurfaces(grid.x, grid.y, grid.z, snapshots, level)
