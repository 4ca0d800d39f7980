"""Draw the mean square velocity in the midplane, and the errors of network and training set."""

from typing import Any

from burstcast.figures.midplane_mean_square import midplane_mean_square
from burstcast.figures.nothing_to_show import nothing_to_show
from burstcast.statistics import profiles
from burstcast.statistics.measures import best_network
from burstcast_workflow.figure_files import write_figure
from burstcast_workflow.flow_fields import flow_grid
from burstcast_workflow.gather import NETWORK, gathered
from burstcast_workflow.job import Provenance, run_job
from burstcast_workflow.statistics_files import read_statistics


def main(inputs: Any, outputs: Any, settings: dict[str, Any], provenance: Provenance) -> None:
    """Draw the data, and how far the best network and the training set are from them."""
    grid = flow_grid(settings)
    data, training = read_statistics(inputs.data), read_statistics(inputs.training)
    best = best_network(
        data,
        {
            (network["neurons"], network["seed"]): read_statistics(path)
            for network, path in gathered(settings["networks"], inputs.climates, NETWORK)
        },
    )
    if best is None:
        figure = nothing_to_show("No network has any long-term statistics.")
    else:
        figure = midplane_mean_square(
            grid.x,
            grid.z,
            *(
                profiles.midplane_mean_square(grid.modes, statistics.moments, grid.x, grid.z)
                for statistics in (data, best.statistics, training)
            ),
            network_label=best.label,
        )
    write_figure(outputs, figure)


if __name__ == "__main__":
    run_job(snakemake, main)  # noqa: F821 - Snakemake puts it there
