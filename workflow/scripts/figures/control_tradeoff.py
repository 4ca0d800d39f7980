"""Draw what control achieves against how early it acts and how much it acts."""

from matplotlib.figure import Figure

from burstcast.figures.control_tradeoff import control_tradeoff
from burstcast_workflow.harness.figures import run_figure
from burstcast_workflow.harness.settings import Settings
from burstcast_workflow.jobs.figures import of_case
from burstcast_workflow.jobs.systems import system_of


def draw(*, percentiles: str, settings: Settings) -> Figure:
    """Draw the networks of one kind, and the forecasters to compare them with."""
    table = of_case(settings, percentiles)
    of_kind = (table["neurons"] == settings["neurons"]) & (
        table["validation"] == settings["validation"]
    )
    shown = table[table["neurons"].isna() | of_kind]
    return control_tradeoff(shown, symbol=system_of(settings).observable_symbol)


if __name__ == "__main__":
    run_figure(snakemake, draw)  # noqa: F821 - Snakemake puts it there
