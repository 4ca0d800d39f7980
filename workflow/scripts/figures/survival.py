"""(a) Share of the series, and of the long closed loops of the networks of one size, that have not
laminarised (nor diverged, nor come to rest) by a time: data with confidence intervals, medians and
quartiles over the networks of an ensemble. (b) Escape rate against reservoir size: escapes after
the first quarter of each run per time unit that the runs are still in the chaotic phase. In grey:
forecasters to compare with.
"""

from matplotlib.figure import Figure

from burstcast.figures.survival import survival
from burstcast_workflow.harness.figures import Settings, Table, figure
from burstcast_workflow.jobs.figures import OfData


@figure
def draw(
    *,
    curves: OfData,
    curve_percentiles: Table,
    rates: OfData,
    rate_percentiles: Table,
    settings: Settings,
) -> Figure:
    """Draw the survival curves and escape rates of one case."""
    return survival(
        curves, curve_percentiles, rates, rate_percentiles, settings["figures.fixed_neurons"]
    )
