"""(a) Density of the observable over all data, the training set and the long closed loops of one
network: of those of the size and strategy shown, the one with the smallest Kantorovich metric.
(b) Kantorovich metric and (c) mean logarithmic error against reservoir size, medians and
quartiles over the networks of an ensemble. Thin bars: the bootstrap interval of one
network over its closed loops, in the median. In grey: the same measures between two random halves
of the data, in the median.
"""

from matplotlib.figure import Figure

from burstcast.figures.long_term_density import long_term_density
from burstcast_workflow.harness.figures import run_figure
from burstcast_workflow.harness.settings import Settings
from burstcast_workflow.harness.tables import read_table
from burstcast_workflow.jobs.best_network import best_of
from burstcast_workflow.jobs.figures import published_beside
from burstcast_workflow.jobs.statistics_files import read_statistics
from burstcast_workflow.jobs.systems import system_of


def draw(
    *,
    data: str,
    training: str,
    long_term: list[str],
    percentiles: str,
    intervals: str,
    settings: Settings,
    published: str | None = None,
) -> Figure:
    """Draw the data, the training set and the best network, and the measures of all networks."""
    true, trained, system = read_statistics(data), read_statistics(training), system_of(settings)
    table = read_table(percentiles)
    best = best_of(settings, true, long_term)
    return long_term_density(
        true.histogram.edges,
        true.histogram.density,
        trained.histogram.density,
        None if best is None else best.statistics.histogram.density,
        table,
        read_table(intervals),
        settings["case.event_threshold"],
        network_label="" if best is None else best.label,
        symbol=system.observable_symbol,
        name=system.observable_name,
        published=published_beside(table, published, "statistics"),
    )


if __name__ == "__main__":
    run_figure(snakemake, draw)  # noqa: F821 - Snakemake puts it there
