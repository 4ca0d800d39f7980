"""F-score against the number of components of the state that are observed beside the observable:
medians and quartiles over the networks of an ensemble, and forecasters to compare with.
"""

from collections.abc import Mapping, Sequence

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from burstcast.figures.parts.percentile_curves import (
    METRIC_LABELS,
    draw_percentiles,
    say_where_empty,
    select,
    spread_handles,
)
from burstcast.figures.parts.reference_forecasters import (
    forecaster_style,
    ordered_forecasters,
)
from burstcast.figures.parts.style import (
    DOUBLE_COLUMN,
    legend_above,
    letter_panels,
    new_figure,
    ordered_validations,
    styled,
    validation_style,
)
from burstcast.figures.registry import Declaration

FIGURE = Declaration(
    section="forecasts",
    position=40,
    inputs={"percentiles": "parts/tables/classification_percentiles.csv"},
    settings={
        "observed": "shown.observed",
        "neurons": "figures.fixed_neurons",
        "prediction_times_lt": "figures.reynolds_prediction_times_lt",
    },
    cases="parts",
)


@styled
def draw(
    percentiles: Sequence[pd.DataFrame],
    observed: Mapping[str, int],
    neurons: float,
    prediction_times_lt: Sequence[float],
) -> Figure:
    """Draw the F-scores of networks and of others against the number of observed components.

    Parameters
    ----------
    percentiles
        Tables of the cases, with F-scores: case, forecaster, neurons, validation, metric,
        prediction_time_lt, p25, p50, p75.
    observed
        How many components are observed in each case, beside the observable; other cases are not
        shown.
    neurons
        Size of the networks shown.
    prediction_times_lt
        Each has a panel of its own.

    Raises
    ------
    ValueError
        If nothing is known of these cases.
    """
    table = pd.concat(percentiles, ignore_index=True)
    table = table[table["case"].isin(observed)]
    table = table[(table["forecaster"] != "esn") | (table["neurons"] == neurons)]
    if table.empty:
        raise ValueError(f"no forecaster has scores in the cases {', '.join(observed)}")
    table = table.assign(observed=table["case"].map(observed))
    times = list(prediction_times_lt)
    figure = new_figure(DOUBLE_COLUMN, 2.6)
    panels = list(figure.subplots(1, len(times), sharey=True, squeeze=False)[0])
    for panel, time in zip(panels, times, strict=True):
        scores = select(table, metric="f_score", prediction_time_lt=float(time))
        for kind in ordered_forecasters(set(table["forecaster"]) - {"esn"}):
            rows = select(scores, forecaster=kind).sort_values("observed")
            panel.plot(rows["observed"], rows["p50"], **forecaster_style(kind))
        networks = select(scores, forecaster="esn")
        for validation in ordered_validations(networks["validation"].dropna()):
            draw_percentiles(
                panel,
                select(networks, validation=validation),
                "observed",
                validation_style(validation),
                label=f"networks, {validation}",
            )
        panel.set_title(f"{time:g} LT ahead", loc="center")
        panel.set_xlabel("observed components, beside the observable")
        panel.set_xticks(np.unique(table["observed"].to_numpy()))
        panel.margins(x=0.06)
    panels[0].set_ylabel(METRIC_LABELS["f_score"])
    legend_above(figure, panels, spread_handles(panels))
    say_where_empty(panels)
    letter_panels(panels)
    return figure
