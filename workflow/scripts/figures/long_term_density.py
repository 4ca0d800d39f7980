"""(a) Density of the observable over all data, the training set and the long closed loops of one
network: of those of the size and strategy shown, the one with the smallest Kantorovich metric.
(b) Kantorovich metric and (c) mean logarithmic error against reservoir size, medians and
quartiles over the networks of an ensemble. Thin bars: the bootstrap interval of one
network over its closed loops, in the median. In grey: the same measures between two random halves
of the data, in the median. Open markers, if any: published values, those of the training set as
diamonds on the right edge.
"""

from matplotlib.figure import Figure

from burstcast.figures.long_term_density import long_term_density
from burstcast_workflow.harness.figures import Settings, Table, figure
from burstcast_workflow.jobs.best_network import best_of
from burstcast_workflow.jobs.figures import Statistics, published_beside
from burstcast_workflow.jobs.systems import system_of


@figure
def draw(
    *,
    data: Statistics,
    training: Statistics,
    long_term: list[str],
    percentiles: Table,
    intervals: Table,
    settings: Settings,
    published: Table | None = None,
) -> Figure:
    """Draw the data, the training set and the best network, and the measures of all networks."""
    system = system_of(settings)
    best = best_of(settings, data, long_term)
    return long_term_density(
        data.histogram.edges,
        data.histogram.density,
        training.histogram.density,
        None if best is None else best.statistics.histogram.density,
        percentiles,
        intervals,
        settings["case.event_threshold"],
        network_label="" if best is None else best.label,
        symbol=system.observable_symbol,
        name=system.observable_name,
        published=published_beside(percentiles, published, "statistics"),
    )
