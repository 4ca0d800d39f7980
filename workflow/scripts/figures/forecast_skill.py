"""(a) F-score of the alarms, whose threshold was chosen on the calibration series, and (b) Brier
skill of the calibrated probabilities, against prediction time. Bands: bootstrap intervals over the
test series; of single networks, median (line) and quartiles (band) over the ensemble. The committee
is the share of these networks that forecast an event. Skills below -0.1 are cut off.
"""

from matplotlib.figure import Figure

from burstcast.figures.forecast_skill import forecast_skill
from burstcast_workflow.harness.figures import Settings, Table, figure


@figure
def draw(*, scores: Table, settings: Settings) -> Figure:
    """Draw the scores of one case."""
    return forecast_skill(scores, settings["figures.fixed_neurons"], settings["shown_validation"])
