"""How the prediction horizon of an extreme event is measured."""

from matplotlib.figure import Figure

from burstcast.figures.horizon_schematic import horizon_schematic
from burstcast_workflow.harness.figures import Settings, figure
from burstcast_workflow.jobs.systems import system_of


@figure
def draw(*, settings: Settings) -> Figure:
    """Draw it with the values of the configuration."""
    return horizon_schematic(
        longest_lead_time_lt=settings["horizon.longest_lead_time_lt"],
        lead_time_step_lt=settings["horizon.lead_time_step_lt"],
        tolerance=settings["horizon.tolerance"],
        symbol=system_of(settings).observable_symbol,
    )
