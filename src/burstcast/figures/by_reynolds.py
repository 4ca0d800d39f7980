"""Prediction horizon and F-score against the Reynolds number."""

from collections.abc import Sequence

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
    MarkerStyle,
    letter_panels,
    new_figure,
    ordered_validations,
    styled,
    validation_style,
)

_FILLED_BY_PREDICTION_TIME = ("o", "s", "^", "D", "v", "P")


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
    """Draw (a) the mean PH_ee and (b) the F-score against the Reynolds number, per strategy.

    Parameters
    ----------
    horizon, classification
        Percentile tables; rows without a Reynolds number are ignored.
    neurons
        Reservoir size shown.
    prediction_times_lt
        Of the F-scores shown; each has a marker of its own.
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

    figure = new_figure(DOUBLE_COLUMN, 2.5)
    left, right = figure.subplots(1, 2)
    for validation, shift in zip(validations, shifts, strict=True):
        style = validation_style(validation)
        chosen = {"validation": validation, "metric": "mean_horizon_lt"}
        draw_percentiles(
            left,
            select(horizon, **chosen),
            "reynolds",
            style,
            label=validation,
            band=False,
            shift=shift,
        )
        if published_horizon is not None:
            rows = select(published_horizon, **chosen, neurons=size)
            draw_published(left, rows, "reynolds", style, shift=shift)
        for index, prediction_time in enumerate(prediction_times_lt):
            marker = _FILLED_BY_PREDICTION_TIME[index % len(_FILLED_BY_PREDICTION_TIME)]
            at_time = {
                "validation": validation,
                "metric": "f_score",
                "prediction_time_lt": float(prediction_time),
            }
            with_marker: MarkerStyle = {**style, "marker": marker}
            draw_percentiles(
                right,
                select(classification, **at_time),
                "reynolds",
                with_marker,
                label=f"{validation}, PT = {prediction_time:g} LT",
                band=False,
                shift=shift,
            )
            if published_classification is not None:
                rows = select(published_classification, **at_time, neurons=size)
                draw_published(right, rows, "reynolds", with_marker, shift=shift)
    left.set_ylabel(METRIC_LABELS["mean_horizon_lt"])
    right.set_ylabel(METRIC_LABELS["f_score"])
    for panel in (left, right):
        panel.set_xlabel("Reynolds number, Re")
        panel.set_xticks(reynolds)
        panel.margins(x=0.08, y=0.1)
    handles, _ = left.get_legend_handles_labels()
    if published_horizon is not None and not published_horizon.empty:
        handles.append(published_handle())
    if handles:
        left.legend(handles=handles, loc="best")
    low, high = right.get_ylim()
    # Room for the legend below the curves, where no ticks tempt to read scores.
    right.set_yticks([tick for tick in right.get_yticks() if max(0.0, low) <= tick <= high])
    right.set_ylim(low - 0.35 * (high - low), high)
    if right.has_data():
        right.legend(loc="lower center", ncols=max(1, len(validations)))
    say_where_empty([left, right])
    letter_panels([left, right])
    return figure
