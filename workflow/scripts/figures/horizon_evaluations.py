"""The last evaluations of the example network before an event is predicted: the forecast starts
ever later until it stays within the tolerance up to the event.
"""

from matplotlib.figure import Figure

from burstcast.figures.horizon_evaluations import HorizonEvaluation, horizon_evaluations
from burstcast.figures.parts.nothing_to_show import nothing_to_show
from burstcast_workflow.harness.figures import run_figure
from burstcast_workflow.harness.settings import Settings
from burstcast_workflow.harness.storage import read_netcdf
from burstcast_workflow.jobs.systems import system_of


def draw(*, examples: str, settings: Settings) -> Figure:
    """Draw the forecasts of the example event."""
    data = read_netcdf(examples)
    time_lt = data["evaluation_time_lt"]
    evaluations = [
        HorizonEvaluation(
            float(lead_time),
            time_lt,
            data["evaluation_forecast"][number],
            float(data["evaluation_horizon_lt"][number]),
        )
        for number, lead_time in enumerate(data["evaluation_lead_time_lt"])
    ]
    if not evaluations:
        return nothing_to_show("No event was predicted from any start.")
    shown = time_lt >= -evaluations[0].lead_time_lt - settings["washout_lt"]
    return horizon_evaluations(
        time_lt[shown],
        data["evaluation_truth"][shown],
        evaluations,
        settings["case.event_threshold"],
        float(data["allowed_error"]),
        symbol=system_of(settings).observable_symbol,
    )


if __name__ == "__main__":
    run_figure(snakemake, draw)  # noqa: F821 - Snakemake puts it there
