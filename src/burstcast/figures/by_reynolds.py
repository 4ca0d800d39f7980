"""Prediction horizon and F-score against the Reynolds number."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from burstcast.figures.parts.percentile_curves import (
    METRIC_LABELS,
    draw_percentiles,
    draw_published,
    published_handle,
    say_where_empty,
    select,
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


@styled
def by_reynolds(
    horizon: pd.DataFrame,
    classification: pd.DataFrame,
    neurons: float,
    prediction_times_lt: Sequence[float],
    *,
    published_horizon: pd.DataFrame | None = None,
    published_classification: pd.DataFrame | None = None,
) -> Figure:
    """Draw (a) the mean PH_ee and (b, ...) F-scores against the Reynolds number, per strategy.

    Parameters
    ----------
    horizon, classification
        Percentile tables; rows without a Reynolds number are ignored.
    neurons
        Reservoir size shown.
    prediction_times_lt
        Of the F-scores shown; each has a panel of its own.
    published_horizon, published_classification
        Published percentiles in the same form, drawn as open markers.

    Raises
    ------
    ValueError
        If no network of this size has a Reynolds number.
    """
    size = float(neurons)
    horizon, classification = (
        select(table, forecaster="esn", neurons=size).dropna(subset=["reynolds"])
        for table in (horizon, classification)
    )
    reynolds = np.unique(
        np.concatenate([horizon["reynolds"], classification["reynolds"]]).astype(np.float64)
    )
    if reynolds.size == 0:
        raise ValueError(f"no network of {neurons:g} neurons has a Reynolds number")
    validations = ordered_validations(
        [*horizon["validation"].dropna(), *classification["validation"].dropna()]
    )
    # Error bars of the strategies stand side by side.
    spacing = 0.03 * (float(np.ptp(reynolds)) or 100.0)
    shifts = spacing * (np.arange(len(validations)) - 0.5 * (len(validations) - 1))

    times = list(prediction_times_lt)
    figure = new_figure(DOUBLE_COLUMN, 2.35)
    panels = list(figure.subplots(1, 1 + len(times), squeeze=False)[0])
    metrics: list[dict[str, Any]] = [
        {"metric": "mean_horizon_lt"},
        *({"metric": "f_score", "prediction_time_lt": float(time)} for time in times),
    ]
    for validation, shift in zip(validations, shifts, strict=True):
        style = validation_style(validation)
        for panel, chosen in zip(panels, metrics, strict=True):
            ours, published = (
                (horizon, published_horizon)
                if panel is panels[0]
                else (classification, published_classification)
            )
            rows = select(ours, validation=validation, **chosen)
            draw_percentiles(
                panel, rows, "reynolds", style, label=validation, band=False, shift=shift
            )
            if published is not None:
                rows = select(published, validation=validation, neurons=size, **chosen)
                draw_published(panel, rows, "reynolds", style, shift=shift)
    panels[0].set_ylabel(METRIC_LABELS["mean_horizon_lt"])
    for panel, time in zip(panels[1:], times, strict=True):
        panel.set_ylabel(METRIC_LABELS["f_score"])
        panel.set_title(f"{time:g} LT ahead", loc="center")
        panel.sharey(panels[1])
    for panel in panels:
        panel.set_xlabel("Reynolds number, Re")
        panel.set_xticks(reynolds)
        panel.margins(x=0.08, y=0.1)
    beside = published_horizon is not None and not published_horizon.empty
    legend_above(figure, panels, [published_handle()] if beside else [])
    say_where_empty(panels)
    letter_panels(panels)
    return figure
