"""Exceedance of the event threshold that control leaves, as a share of that without control, with
confidence intervals over flows: (a) against the share of the time under actuation, along the
horizon, the prediction time, the level or the probability of actuation that is written at the ends
of some curves; "every" is the interval between decisions. The other panels: against the delay and
the strength of the actuator and the noise of the observations, for settings that were tried at
several values. The axis is linear in the shaded strip: a marker on 0 has left nothing, and its bar
ends at the bound of the rule of three.
Colours and fillings say who forecasts; of the networks, one is shown, and the committee of those of
its size, whose votes decide.
"""

import pandas as pd
from matplotlib.figure import Figure

from burstcast.figures.control_frontier import control_frontier
from burstcast_workflow.harness.figures import run_figure
from burstcast_workflow.harness.settings import Settings
from burstcast_workflow.harness.tables import read_table
from burstcast_workflow.jobs.systems import system_of


def draw(*, scores: str, settings: Settings) -> Figure:
    """Draw all strategies with one network, and the forecasters to compare it with."""
    table = read_table(scores)
    shown = ~table["forecaster"].isin(["esn", "esn_committee", "random"])
    network = settings["frontier_network"]
    if network is not None:
        shown |= (table[list(network)] == pd.Series(network)).all(axis="columns")
        # of committees, that of the networks of its size and strategy
        size = pd.Series(network)[["neurons", "validation"]]
        alike = (table[list(size.index)] == size).all(axis="columns")
        shown |= alike & (table["forecaster"] == "esn_committee")
    return control_frontier(
        table[shown],
        {"span_lt": settings["control.span_lt"], "noise": settings["case.training.noise"]},
        symbol=system_of(settings).observable_symbol,
    )


if __name__ == "__main__":
    run_figure(snakemake, draw)  # noqa: F821 - Snakemake puts it there
