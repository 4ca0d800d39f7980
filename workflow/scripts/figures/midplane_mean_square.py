"""(a) Time average of the square of the velocity along x in the midplane. Its absolute error (b)
in the long closed loops of one network, that of its ensemble with the smallest Kantorovich
metric, and (c) in the training set.
Velocities are in units of U_0, that of the laminar flow halfway between centre and wall, lengths
in half the distance of the walls.
"""

from matplotlib.figure import Figure

from burstcast.figures.midplane_mean_square import midplane_mean_square
from burstcast.figures.parts.nothing_to_show import nothing_to_show
from burstcast.flow_grid import make_flow_grid
from burstcast.statistics import profiles
from burstcast_workflow.harness.figures import Settings, figure
from burstcast_workflow.jobs.best_network import best_of
from burstcast_workflow.jobs.figures import Statistics
from burstcast_workflow.jobs.systems import system_of


@figure
def draw(
    *, data: Statistics, training: Statistics, long_term: list[str], settings: Settings
) -> Figure:
    """Draw the data, and how far the best network and the training set are from them."""
    grid = make_flow_grid(system_of(settings), settings["figures.flow_points"])
    best = best_of(settings, data, long_term)
    if best is None:
        return nothing_to_show("No network has any long-term statistics.")
    fields = [
        profiles.midplane_mean_square(grid.modes, statistics.moments, grid.x, grid.z)
        for statistics in (data, best.statistics, training)
    ]
    return midplane_mean_square(grid.x, grid.z, *fields, network_label=best.label)
