"""Draw how a forecast is made and scored, on a real one."""

from typing import Any

from burstcast.figures.nothing_to_show import nothing_to_show
from burstcast.figures.prediction_schematic import prediction_schematic
from burstcast_workflow.figure_files import write_figure
from burstcast_workflow.job import Provenance, run_job
from burstcast_workflow.storage import read_netcdf


def main(inputs: Any, outputs: Any, settings: dict[str, Any], provenance: Provenance) -> None:
    """Draw the first example: a true positive, if there was one."""
    data = read_netcdf(inputs.examples)
    if len(data["outcome"]):
        figure = prediction_schematic(
            data["example_time_lt"],
            data["example_truth"][0],
            data["example_forecast"][0],
            settings["event_threshold"],
            settings["prediction_time_lt"],
            washout_lt=settings["washout_lt"],
            window_lt=settings["window_lt"],
            symbol=settings["symbol"],
        )
    else:
        figure = nothing_to_show("No event occurred in the test set, and none was predicted.")
    write_figure(outputs, figure)


if __name__ == "__main__":
    run_job(snakemake, main)  # noqa: F821 - Snakemake puts it there
