"""(a) Share of the events that an alarm warned of at least a lead time before they began, and (b)
false alarms per Lyapunov time (those who raise none have no curve), against lead time. Bands:
bootstrap intervals over the test series; of single networks, median (line) and quartiles (band)
over the ensemble.
"""

from matplotlib.figure import Figure

from burstcast.figures.alarm_lead_times import alarm_lead_times
from burstcast_workflow.harness.figures import Settings, Table, figure


@figure
def draw(*, lead_times: Table, settings: Settings) -> Figure:
    """Draw the lead times of one case."""
    return alarm_lead_times(
        lead_times, settings["figures.fixed_neurons"], settings["shown_validation"]
    )
