"""Forecasts of the example network with each outcome. Of all forecasts with an outcome, the one
is shown whose burst has the median height; misses and false alarms that are more than an error of
timing come first.
"""

from matplotlib.figure import Figure

from burstcast.figures.parts.nothing_to_show import nothing_to_show
from burstcast.figures.prediction_examples import PredictionExample, prediction_examples
from burstcast.forecast.examples import OUTCOMES
from burstcast_workflow.harness.figures import Arrays, Settings, figure
from burstcast_workflow.jobs.systems import system_of


@figure
def draw(*, examples: Arrays, settings: Settings) -> Figure:
    """Draw the outcomes that occurred."""
    shown = [
        PredictionExample(
            OUTCOMES[outcome],
            examples["example_time_lt"],
            examples["example_truth"][number],
            examples["example_forecast"][number],
        )
        for number, outcome in enumerate(examples["outcome"])
    ]
    if not shown:
        return nothing_to_show("No event occurred in the test set, and none was predicted.")
    return prediction_examples(
        shown,
        settings["case.event_threshold"],
        settings["figures.example_prediction_time_lt"],
        window_lt=settings["classification.window_lt"],
        symbol=system_of(settings).observable_symbol,
    )
