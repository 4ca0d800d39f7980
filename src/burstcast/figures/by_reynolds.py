"""(a) Mean prediction horizon of extreme events and (b, ...) F-score some time ahead, against the
Reynolds number; last row: F-score against prediction time, a panel for each validation strategy.
Medians and quartiles over the networks of an ensemble.
"""

from collections.abc import Mapping, Sequence
from math import lcm

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MultipleLocator

from burstcast.figures.parts.percentile_curves import (
    METRIC_LABELS,
    PREDICTION_TIME_LABEL,
    draw_percentiles,
    draw_published,
    published_handles,
    say_where_empty,
    select,
    spread_handles,
)
from burstcast.figures.parts.style import (
    DOUBLE_COLUMN,
    legend_above,
    letter_panels,
    new_figure,
    ordered_validations,
    sequence_styles,
    styled,
    validation_style,
)
from burstcast.figures.registry import Declaration
from burstcast.tables.published import published_beside

FIGURE = Declaration(
    section="horizon",
    position=40,
    inputs={
        "horizons": "reynolds_cases/tables/horizon_percentiles.csv",
        "scores": "reynolds_cases/tables/classification_percentiles.csv",
    },
    settings={
        "neurons": "figures.fixed_neurons",
        "prediction_times_lt": "figures.reynolds_prediction_times_lt",
    },
    cases="several_reynolds",
    published=True,
)


def draw(
    *,
    horizons: Sequence[pd.DataFrame],
    scores: Sequence[pd.DataFrame],
    neurons: int,
    prediction_times_lt: Sequence[float],
    published: pd.DataFrame | None = None,
) -> Figure:
    """Draw the networks of one size, from the percentile tables of each case."""
    horizon = pd.concat(horizons, ignore_index=True)
    classification = pd.concat(scores, ignore_index=True)
    return by_reynolds(
        horizon,
        classification,
        neurons,
        prediction_times_lt,
        published_horizon=published_beside(horizon, published, "horizon"),
        published_classification=published_beside(classification, published, "classification"),
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
    """Draw scores of networks of one size at each Reynolds number.

    The upper row has the mean PH_ee and F-scores against the Reynolds number, a curve for each
    strategy; the lower one F-scores against the prediction time, a panel for each strategy and a
    curve for each Reynolds number.

    ``horizon``, ``classification``: Percentile tables; rows without a Reynolds number are ignored.
    Cases may have other prediction times than each other. ``prediction_times_lt``: Prediction times
    of the F-scores in the upper row; each has a panel of its own. ``published_horizon``,
    ``published_classification``: Published percentiles in the same form, drawn as open markers
    where we have networks of the same strategy and Reynolds number.
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
    published_horizon, published_classification = (
        ours.iloc[:0]
        if theirs is None
        else select(theirs[theirs["reynolds"].isin(reynolds)], forecaster="esn", neurons=size)
        for ours, theirs in (
            (horizon, published_horizon),
            (classification, published_classification),
        )
    )
    validations = ordered_validations(
        [*horizon["validation"].dropna(), *classification["validation"].dropna()]
    )

    times = list(prediction_times_lt)
    figure = new_figure(DOUBLE_COLUMN, 4.9)
    above, below = 1 + len(times), len(validations)
    columns = lcm(above, below)
    grid = figure.add_gridspec(2, columns, height_ratios=[1.0, 1.25])
    upper, lower = (
        [
            figure.add_subplot(grid[row, columns * index // count : columns * (index + 1) // count])
            for index in range(count)
        ]
        for row, count in enumerate((above, below))
    )
    # Error bars of the strategies stand side by side.
    spacing = 0.03 * (float(np.ptp(reynolds)) or 100.0)
    places = spacing * (np.arange(len(validations)) - 0.5 * (len(validations) - 1))
    shifts = dict(zip(validations, places, strict=True))
    _against_reynolds(
        upper[:1], [{"metric": "mean_horizon_lt"}], horizon, published_horizon, shifts
    )
    _against_reynolds(
        upper[1:],
        [{"metric": "f_score", "prediction_time_lt": float(time)} for time in times],
        classification,
        published_classification,
        shifts,
    )
    for panel, time in zip(upper[1:], times, strict=True):
        panel.set_title(f"{time:g} LT ahead", loc="center")
        panel.sharey(upper[1])
    for panel in upper:
        panel.set_xlabel("Reynolds number, Re")
        panel.set_xticks(reynolds)
        panel.margins(x=0.08, y=0.1)
    styles = dict(zip(reynolds, sequence_styles(len(reynolds)), strict=True))
    for panel, validation in zip(lower, validations, strict=True):
        for number, style in styles.items():
            chosen = {"metric": "f_score", "validation": validation, "reynolds": float(number)}
            rows = select(classification, **chosen)
            draw_percentiles(panel, rows, "prediction_time_lt", style, label=f"{number:g}")
            rows = select(published_classification, **chosen)
            draw_published(panel, rows, "prediction_time_lt", style)
        panel.set_title(validation, loc="center")
        panel.set_xlabel(PREDICTION_TIME_LABEL)
        panel.set_ylabel(METRIC_LABELS["f_score"])
        panel.xaxis.set_major_locator(MultipleLocator(1))
        panel.sharex(lower[0])
        panel.sharey(lower[0])
        if panel.has_data():
            panel.legend(title="Re", loc="best")
    # panels that share an axis have the limits of the last one that was drawn
    drawn = [panel.dataLim for panel in lower if panel.has_data()]
    if drawn:
        low, high = min(box.y0 for box in drawn), max(box.y1 for box in drawn)
        lower[0].set_ylim(low - 0.05 * (high - low), high + 0.05 * (high - low))
    legend_above(figure, upper, [*spread_handles(upper), *published_handles([*upper, *lower])])
    say_where_empty([*upper, *lower])
    letter_panels([*upper, *lower])
    return figure


def _against_reynolds(
    panels: Sequence[Axes],
    metrics: Sequence[dict[str, object]],
    ours: pd.DataFrame,
    published: pd.DataFrame,
    shifts: Mapping[str, float],
) -> None:
    """Draw a metric in each panel, the strategies by their shifts beside each other."""
    for panel, chosen in zip(panels, metrics, strict=True):
        panel.set_ylabel(METRIC_LABELS[str(chosen["metric"])])
        for validation, shift in shifts.items():
            style = validation_style(validation)
            rows = select(ours, validation=validation, **chosen)
            draw_percentiles(
                panel, rows, "reynolds", style, label=validation, band=False, shift=shift
            )
            rows = select(published, validation=validation, **chosen)
            draw_published(panel, rows, "reynolds", style, shift=shift)
