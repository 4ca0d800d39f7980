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
from burstcast_workflow.harness.figures import Settings, Table, figure
from burstcast_workflow.jobs.systems import system_of


@figure
def draw(*, scores: Table, settings: Settings) -> Figure:
    """Draw all strategies with one network, and the forecasters to compare it with."""
    shown = ~scores["forecaster"].isin(["esn", "esn_committee", "random"])
    network = settings["frontier_network"]
    if network is not None:
        shown |= (scores[list(network)] == pd.Series(network)).all(axis="columns")
        # of committees, that of the networks of its size and strategy
        size = pd.Series(network)[["neurons", "validation"]]
        alike = (scores[list(size.index)] == size).all(axis="columns")
        shown |= alike & (scores["forecaster"] == "esn_committee")
    return control_frontier(
        scores[shown],
        {"span_lt": settings["control.span_lt"], "noise": settings["case.training.noise"]},
        symbol=system_of(settings).observable_symbol,
    )
