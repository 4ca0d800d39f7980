"""(a) Lyapunov exponents of the data, with confidence intervals, and of the closed loops of the
networks of one size that stay in the chaotic phase, medians and quartiles over the networks of an
ensemble. The networks have as many exponents as neurons; arrows: those beyond the flow's own are
strongly negative. (b) Kaplan-Yorke dimension against reservoir size. In grey: forecasters to
compare with.
"""

from matplotlib.figure import Figure

from burstcast.figures.lyapunov_spectrum import lyapunov_spectrum
from burstcast_workflow.harness.figures import Settings, Table, figure
from burstcast_workflow.jobs.figures import OfData


@figure
def draw(
    *,
    exponents: OfData,
    exponent_percentiles: Table,
    dimensions: OfData,
    dimension_percentiles: Table,
    settings: Settings,
) -> Figure:
    """Draw the exponents and dimensions of one case."""
    return lyapunov_spectrum(
        exponents,
        exponent_percentiles,
        dimensions,
        dimension_percentiles,
        settings["figures.fixed_neurons"],
    )
