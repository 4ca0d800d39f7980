"""Objective of the hyperparameter search at each point, best Tikhonov parameter: interpolated
between the evaluated points (dots: the grid; numbers: points of the Bayesian search in their
order; in colour: the optimum), and how far the best value found so far lay above the final one.
"""

import pandas as pd
from matplotlib.figure import Figure

from burstcast.figures.search_landscape import search_landscape
from burstcast_workflow.harness.figures import figure
from burstcast_workflow.harness.tables import read_table


@figure
def draw(*, traces: list[str]) -> Figure:
    """Draw the best Tikhonov parameter of each point, for each strategy."""
    shown = []
    for path in traces:
        trace = read_table(path)
        shown.append(trace.loc[trace.groupby("evaluation")["objective"].idxmin()])
    return search_landscape(pd.concat(shown, ignore_index=True))
