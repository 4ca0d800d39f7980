"""Mean prediction horizon of extreme events against reservoir size, or by forecaster where there is
one size: medians and quartiles over the networks of an ensemble. In grey: forecasters to compare
with.
"""

from typing import Any

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from burstcast.base.declared import read
from burstcast.base.names import described
from burstcast.figures.parts import looks, medians, style
from burstcast.figures.parts.published import published_beside
from burstcast.figures.registry import figure
from burstcast.forecasters._labels import forecaster_label


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
    if len(sizes) == 1:
        return _by_forecaster(percentiles, theirs, float(sizes[0]))
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


def _by_forecaster(percentiles: pd.DataFrame, theirs: pd.DataFrame, neurons: float) -> Figure:
    """Draw a row for each forecaster, the best one first."""
    rows = medians.select(percentiles, metric="mean_horizon_lt")
    rows = rows[rows["forecaster"] != "equations"].sort_values("p50", ascending=False)
    labels = [
        described(forecaster_label(kind), float(size) if pd.notna(size) else None, validation)
        for kind, size, validation in rows[["forecaster", "neurons", "validation"]].itertuples(
            index=False
        )
    ]
    figure = style.new_figure(style.SINGLE_COLUMN, 0.8 + 0.22 * len(rows))
    axes = figure.subplots()
    lengths = medians.lengths(rows, "p50", "p25", "p75").T
    for place, (row, bars) in enumerate(zip(rows.to_dict("records"), lengths, strict=True)):
        networks = row["forecaster"] == "esn"
        look = looks.validation(row["validation"]) if networks else looks.TRUTH
        marks: dict[str, Any] = {"color": look["color"], "marker": "o", "linestyle": "none"}
        axes.errorbar(row["p50"], place, xerr=bars[:, np.newaxis], **style.BARS, **marks)
        if networks:
            of = {"validation": row["validation"], "neurons": neurons}
            for value in medians.select(theirs, metric="mean_horizon_lt", **of)["p50"]:
                opened = {**marks, "markerfacecolor": "none", "markersize": 6.0}
                axes.plot(value, place, gid=medians.PUBLISHED, **opened)
    axes.set_yticks(range(len(rows)), labels)
    axes.set_ylim(len(rows) - 0.5, -0.5)
    axes.set_xlim(left=0)
    axes.set_xlabel(medians.LABELS["mean_horizon_lt"])
    more = [style.bar_handle("quartiles over networks"), *medians.published_handles([axes])]
    style.legend_above(figure, [], more)
    return figure
