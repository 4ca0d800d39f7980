"""F-score against the number of components of the state that are observed beside the observable:
medians and quartiles over the networks of an ensemble, and forecasters to compare with.
"""

from matplotlib.figure import Figure

from burstcast.figures.observed_components import observed_components
from burstcast_workflow.harness.figures import Settings, figure
from burstcast_workflow.jobs.figures import OfCases


@figure
def draw(*, percentiles: OfCases, settings: Settings) -> Figure:
    """Draw the parts of one case, and the whole."""
    return observed_components(
        percentiles,
        settings["observed"],
        settings["figures.fixed_neurons"],
        settings["figures.reynolds_prediction_times_lt"],
    )
