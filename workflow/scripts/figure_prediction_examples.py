"""Draw a true positive, a false positive and a false negative."""

from typing import Any

from burstcast.figures.nothing_to_show import nothing_to_show
from burstcast.figures.prediction_examples import PredictionExample, prediction_examples
from burstcast.forecast.examples import OUTCOMES
from burstcast_workflow.figure_files import write_figure
from burstcast_workflow.job import Provenance, run_job
from burstcast_workflow.storage import read_netcdf


def main(inputs: Any, outputs: Any, settings: dict[str, Any], provenance: Provenance) -> None:
    """Draw the outcomes that occurred."""
    data = read_netcdf(inputs.examples)
    examples = [
        PredictionExample(OUTCOMES[outcome], data["example_time_lt"], true, forecast)
        for outcome, true, forecast in zip(
            data["outcome"], data["example_truth"], data["example_forecast"], strict=True
        )
    ]
    if examples:
        figure = prediction_examples(
            examples,
            settings["event_threshold"],
            settings["prediction_time_lt"],
            window_lt=settings["window_lt"],
            symbol=settings["symbol"],
        )
    else:
        figure = nothing_to_show("No event occurred in the test set, and none was predicted.")
    write_figure(outputs, figure)


if __name__ == "__main__":
    run_job(snakemake, main)  # noqa: F821 - Snakemake puts it there
