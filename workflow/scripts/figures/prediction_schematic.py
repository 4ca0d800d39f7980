"""One forecast of the example network with its parts: washout, prediction time, and the window
that is classified.
"""

from matplotlib.figure import Figure

from burstcast.figures.parts.nothing_to_show import nothing_to_show
from burstcast.figures.prediction_schematic import prediction_schematic
from burstcast_workflow.harness.figures import Arrays, Settings, figure
from burstcast_workflow.jobs.systems import system_of


@figure
def draw(*, examples: Arrays, settings: Settings) -> Figure:
    """Draw the first example: a true positive, if there was one."""
    if not len(examples["outcome"]):
        return nothing_to_show("No event occurred in the test set, and none was predicted.")
    return prediction_schematic(
        examples["example_time_lt"],
        examples["example_truth"][0],
        examples["example_forecast"][0],
        settings["case.event_threshold"],
        settings["figures.example_prediction_time_lt"],
        washout_lt=settings["washout_lt"],
        window_lt=settings["classification.window_lt"],
        symbol=system_of(settings).observable_symbol,
    )
