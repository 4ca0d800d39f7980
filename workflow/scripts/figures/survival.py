"""(a) Share of the series, and of the long closed loops of the networks of one size, that have not
laminarised (nor diverged, nor come to rest) by a time: data with confidence intervals, medians and
quartiles over the networks of an ensemble. (b) Escape rate against reservoir size: escapes after
the first quarter of each run per time unit that the runs are still in the chaotic phase. In grey:
forecasters to compare with.
"""

from matplotlib.figure import Figure

from burstcast.figures.survival import survival
from burstcast_workflow.harness.figures import run_figure
from burstcast_workflow.harness.settings import Settings
from burstcast_workflow.harness.tables import read_table
from burstcast_workflow.jobs.figures import of_data


def draw(
    *, curves: str, curve_percentiles: str, rates: str, rate_percentiles: str, settings: Settings
) -> Figure:
    """Draw the survival curves and escape rates of one case."""
    return survival(
        of_data(curves),
        read_table(curve_percentiles),
        of_data(rates),
        read_table(rate_percentiles),
        settings["figures.fixed_neurons"],
    )


if __name__ == "__main__":
    run_figure(snakemake, draw)  # noqa: F821 - Snakemake puts it there
