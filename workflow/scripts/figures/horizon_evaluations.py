"""The last evaluations of the example network before an event is predicted: the forecast starts
ever later until it stays within the tolerance up to the event.
"""

from matplotlib.figure import Figure

from burstcast.figures.horizon_evaluations import HorizonEvaluation, horizon_evaluations
from burstcast.figures.parts.nothing_to_show import nothing_to_show
from burstcast_workflow.harness.figures import Arrays, Settings, figure
from burstcast_workflow.jobs.systems import system_of


@figure
def draw(*, examples: Arrays, settings: Settings) -> Figure:
    """Draw the forecasts of the example event."""
    time_lt = examples["evaluation_time_lt"]
    evaluations = [
        HorizonEvaluation(
            float(lead_time),
            time_lt,
            examples["evaluation_forecast"][number],
            float(examples["evaluation_horizon_lt"][number]),
        )
        for number, lead_time in enumerate(examples["evaluation_lead_time_lt"])
    ]
    if not evaluations:
        return nothing_to_show("No event was predicted from any start.")
    shown = time_lt >= -evaluations[0].lead_time_lt - settings["washout_lt"]
    return horizon_evaluations(
        time_lt[shown],
        examples["evaluation_truth"][shown],
        evaluations,
        settings["case.event_threshold"],
        float(examples["allowed_error"]),
        symbol=system_of(settings).observable_symbol,
    )
