"""Reliability diagrams of forecast probabilities, as shares of votes and calibrated on
series other than the test series: observed frequency of events against the mean probability, in
bins. Grey bars: where the frequency would lie, at the level of confidence of the intervals, if the
calibrated probabilities were right. Below: how many calibrated forecasts lie in each bin. Shown are
the forecasters that tell more than two probabilities, if there are any.
"""

from matplotlib.figure import Figure

from burstcast.figures.reliability import reliability
from burstcast_workflow.harness.figures import Settings, Table, figure


@figure
def draw(*, bins: Table, settings: Settings) -> Figure:
    """Draw the diagrams of one case."""
    return reliability(
        bins,
        settings["figures.reynolds_prediction_times_lt"],
        settings["figures.fixed_neurons"],
        settings["shown_validation"],
    )
