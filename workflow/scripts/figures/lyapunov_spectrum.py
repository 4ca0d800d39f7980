"""(a) Lyapunov exponents of the data, with confidence intervals, and of the closed loops of the
networks of one size that stay in the chaotic phase, medians and quartiles over the networks of an
ensemble. The networks have as many exponents as neurons; arrows: those beyond the flow's own are
strongly negative. (b) Kaplan-Yorke dimension against reservoir size. In grey: forecasters to
compare with.
"""

from matplotlib.figure import Figure

from burstcast.figures.lyapunov_spectrum import lyapunov_spectrum
from burstcast_workflow.harness.figures import run_figure
from burstcast_workflow.harness.settings import Settings
from burstcast_workflow.harness.tables import read_table
from burstcast_workflow.jobs.figures import of_data


def draw(
    *,
    exponents: str,
    exponent_percentiles: str,
    dimensions: str,
    dimension_percentiles: str,
    settings: Settings,
) -> Figure:
    """Draw the exponents and dimensions of one case."""
    return lyapunov_spectrum(
        of_data(exponents),
        read_table(exponent_percentiles),
        of_data(dimensions),
        read_table(dimension_percentiles),
        settings["figures.fixed_neurons"],
    )


if __name__ == "__main__":
    run_figure(snakemake, draw)  # noqa: F821 - Snakemake puts it there
