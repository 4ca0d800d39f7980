"""Mean prediction horizon of extreme events against reservoir size: medians (lines) and quartiles
(bands) over the networks of an ensemble. In grey: forecasters to compare with.
"""

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from burstcast.base.declared import read
from burstcast.figures.parts import medians, style
from burstcast.figures.parts.published import published_beside
from burstcast.figures.registry import figure


@figure(section="horizon", position=30, cases="several_sizes", needs_networks=True)
def draw(
    *,
    percentiles: pd.DataFrame = read("case/tables/horizon_percentiles.csv"),
    published: pd.DataFrame | None = None,
) -> Figure:
    """Draw the mean PH_ee, one curve for each validation strategy, at the sizes of the table."""
    metric, theirs = "mean_horizon_lt", published_beside(percentiles, published, "horizon")
    networks = percentiles[percentiles["forecaster"] == "esn"]
    sizes = np.unique(networks["neurons"].dropna().to_numpy(dtype=np.float64))
    many = percentiles["forecaster"].nunique() > 4
    figure = style.new_figure(style.SINGLE_COLUMN, 3.6 if many else 2.8)
    axes = figure.subplots()
    # a perfect forecaster reaches the longest lead time of the search
    medians.draw_references(axes, percentiles, metric, "neurons", leave_out=["equations"])
    theirs = theirs[theirs["neurons"].isin(sizes)]
    for validation, look, _ in medians.validations(networks):
        chosen = {"validation": validation, "metric": metric}
        medians.draw_both(axes, networks, theirs, chosen, "neurons", look, label=validation)
    axes.set_xticks(sizes)
    axes.margins(x=0.06)
    axes.set_xlabel(medians.NEURONS)
    axes.set_ylabel(medians.LABELS[metric])
    more = [*medians.spread_handles([axes]), *medians.published_handles([axes])]
    style.legend_above(figure, [axes], more, columns=1 if many else 2)
    medians.say_where_empty([axes])
    return figure
