"""Economic value of the calibrated probabilities, relative to perfect forecasts (1) and to the base
rate (0), against the ratio of the cost of protection to the loss that it prevents: who can protect
themselves does so where the probability exceeds their ratio. Bands: bootstrap intervals over the
test series. Values below -0.1 are cut off.
"""

from matplotlib.figure import Figure

from burstcast.figures.economic_value import economic_value
from burstcast_workflow.harness.figures import Settings, Table, figure


@figure
def draw(*, values: Table, settings: Settings) -> Figure:
    """Draw the values of one case."""
    return economic_value(
        values,
        settings["figures.reynolds_prediction_times_lt"],
        settings["figures.fixed_neurons"],
        settings["shown_validation"],
    )
