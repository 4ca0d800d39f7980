"""(a) Share of the events that an alarm warned of at least a lead time before they began, and (b)
false alarms per Lyapunov time (those who raise none have no curve), against lead time. Bands:
bootstrap intervals over the test series; of single networks, median (line) and quartiles (band)
over the ensemble.
"""

from matplotlib.figure import Figure

from burstcast.figures.alarm_lead_times import alarm_lead_times
from burstcast_workflow.harness.figures import run_figure
from burstcast_workflow.harness.settings import Settings
from burstcast_workflow.harness.tables import read_table


def draw(*, lead_times: str, settings: Settings) -> Figure:
    """Draw the lead times of one case."""
    return alarm_lead_times(
        read_table(lead_times),
        settings["figures.fixed_neurons"],
        settings["shown_validation"],
    )


if __name__ == "__main__":
    run_figure(snakemake, draw)  # noqa: F821 - Snakemake puts it there
