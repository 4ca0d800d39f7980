"""Draw the long-term density of the observable, and the errors in it against reservoir size."""

from typing import Any

from burstcast.figures.energy_density import energy_density
from burstcast.published import published_percentiles
from burstcast.statistics.measures import best_network
from burstcast_workflow.figure_files import write_figure
from burstcast_workflow.gather import NETWORK, gathered
from burstcast_workflow.job import Provenance, run_job
from burstcast_workflow.statistics_files import read_statistics
from burstcast_workflow.table_files import read_table


def main(inputs: Any, outputs: Any, settings: dict[str, Any], provenance: Provenance) -> None:
    """Draw the data, the training set and the best network, and the measures of all networks."""
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
    figure = energy_density(
        data.histogram.edges,
        data.histogram.density,
        training.histogram.density,
        None if best is None else best.statistics.histogram.density,
        table[table["case"] == settings["case"]],
        settings["event_threshold"],
        network_label="" if best is None else best.label,
        symbol=settings["symbol"],
        name=settings["observable_name"],
        published=published,
    )
    write_figure(outputs, figure)


if __name__ == "__main__":
    run_job(snakemake, main)  # noqa: F821 - Snakemake puts it there
