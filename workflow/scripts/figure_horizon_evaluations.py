"""Draw the last evaluations of the prediction horizon before an event is predicted."""

from typing import Any

from burstcast.figures.horizon_evaluations import HorizonEvaluation, horizon_evaluations
from burstcast.figures.nothing_to_show import nothing_to_show
from burstcast_workflow.figure_files import write_figure
from burstcast_workflow.job import Provenance, run_job
from burstcast_workflow.storage import read_netcdf


def main(inputs: Any, outputs: Any, settings: dict[str, Any], provenance: Provenance) -> None:
    """Draw the forecasts of the example event."""
    data = read_netcdf(inputs.examples)
    time_lt = data["evaluation_time_lt"]
    evaluations = [
        HorizonEvaluation(float(start), time_lt, forecast, float(horizon))
        for start, forecast, horizon in zip(
            data["evaluation_start_lt"],
            data["evaluation_forecast"],
            data["evaluation_horizon_lt"],
            strict=True,
        )
    ]
    if evaluations:
        shown = time_lt >= -evaluations[0].lead_time_lt - settings["washout_lt"]
        figure = horizon_evaluations(
            time_lt[shown],
            data["evaluation_truth"][shown],
            evaluations,
            settings["event_threshold"],
            float(data["allowed_error"]),
            symbol=settings["symbol"],
        )
    else:
        figure = nothing_to_show("No event was predicted from any start.")
    write_figure(outputs, figure)


if __name__ == "__main__":
    run_job(snakemake, main)  # noqa: F821 - Snakemake puts it there
