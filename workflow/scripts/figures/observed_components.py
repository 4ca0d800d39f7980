"""F-score against the number of components of the state that are observed beside the observable:
medians and quartiles over the networks of an ensemble, and forecasters to compare with.
"""

from matplotlib.figure import Figure

from burstcast.figures.observed_components import observed_components
from burstcast_workflow.harness.figures import run_figure
from burstcast_workflow.harness.settings import Settings
from burstcast_workflow.jobs.figures import of_cases


def draw(*, percentiles: list[str], settings: Settings) -> Figure:
    """Draw the parts of one case, and the whole."""
    return observed_components(
        of_cases(percentiles),
        settings["observed"],
        settings["figures.fixed_neurons"],
        settings["figures.reynolds_prediction_times_lt"],
    )


if __name__ == "__main__":
    run_figure(snakemake, draw)  # noqa: F821 - Snakemake puts it there
