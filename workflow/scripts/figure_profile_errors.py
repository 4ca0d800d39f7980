"""Draw the velocity profiles, and the errors in them against reservoir size."""

from typing import Any

import numpy as np

from burstcast.figures.profile_errors import profile_errors
from burstcast.published import published_percentiles
from burstcast.statistics.measures import best_network
from burstcast.statistics.profiles import flow_modes, velocity_profiles
from burstcast.systems.registry import make_system
from burstcast_workflow.figure_files import write_figure
from burstcast_workflow.gather import NETWORK, gathered
from burstcast_workflow.job import Provenance, run_job
from burstcast_workflow.statistics_files import read_statistics
from burstcast_workflow.table_files import read_table


def main(inputs: Any, outputs: Any, settings: dict[str, Any], provenance: Provenance) -> None:
    """Draw the data, the training set and the best network, and the errors of all networks."""
    y = np.linspace(-1.0, 1.0, settings["profile_points"])
    matrices = flow_modes(make_system(settings["system"], settings["parameters"])).profile_matrices(
        y
    )

    def profiles(statistics):
        found = velocity_profiles(matrices, statistics.moments)
        return np.stack([found.u, found.uu, found.uv])

    data, training = read_statistics(inputs.data), read_statistics(inputs.training)
    best = best_network(
        data,
        {
            (network["neurons"], network["seed"]): read_statistics(path)
            for network, path in gathered(settings["networks"], inputs.climates, NETWORK)
        },
    )
    table = read_table(inputs.percentiles)
    published = None
    if settings["published_overlay"]:
        published = published_percentiles(read_table(inputs.published), "statistics")
        published = published[published["reynolds"] == settings["reynolds"]]
    figure = profile_errors(
        y,
        profiles(data),
        profiles(training),
        None if best is None else profiles(best.statistics),
        table[table["case"] == settings["case"]],
        network_label="" if best is None else best.label,
        published=published,
    )
    write_figure(outputs, figure)


if __name__ == "__main__":
    run_job(snakemake, main)  # noqa: F821 - Snakemake puts it there
