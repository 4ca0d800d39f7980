"""Share of the exceedance of the event threshold that control removes, (a) against the prediction
time and (b) against the share of the time under actuation, with medians and quartiles over the
networks of an ensemble. For comparison: alarms by the equations themselves, started from the true
state, and random alarms at the rate of the networks'.
"""

from matplotlib.figure import Figure

from burstcast.figures.control_tradeoff import control_tradeoff
from burstcast_workflow.harness.figures import run_figure
from burstcast_workflow.harness.settings import Settings
from burstcast_workflow.harness.tables import read_table
from burstcast_workflow.jobs.systems import system_of


def draw(*, percentiles: str, settings: Settings) -> Figure:
    """Draw the networks of one kind, and the forecasters to compare them with."""
    table = read_table(percentiles)
    of_kind = (table["neurons"] == settings["controlling"]["neurons"]) & (
        table["validation"] == settings["controlling"]["validation"]
    )
    shown = table[table["neurons"].isna() | of_kind]
    return control_tradeoff(shown, symbol=system_of(settings).observable_symbol)


if __name__ == "__main__":
    run_figure(snakemake, draw)  # noqa: F821 - Snakemake puts it there
