"""Errors in long-term statistics against reservoir size, beside the training set and the floor."""

from collections.abc import Mapping

import numpy as np
import pandas as pd
from matplotlib.axes import Axes

from burstcast.figures.parts.percentile_curves import (
    METRIC_LABELS,
    NEURONS_LABEL,
    draw_percentiles,
    draw_published,
    draw_published_level,
    draw_single_intervals,
    select,
)
from burstcast.figures.parts.style import (
    FLOOR,
    TRAINING,
    ordered_validations,
    validation_style,
)

LARGEST_LINEAR_RATIO = 20.0
"""Values of a panel that differ by more than this factor make all axes logarithmic."""


def draw_statistics_by_size(
    panels: Mapping[str, Axes],
    percentiles: pd.DataFrame,
    intervals: pd.DataFrame,
    published: pd.DataFrame | None = None,
) -> None:
    """Draw statistics' errors against reservoir size, with the training set and the floor.

    ``panels``: Where to draw, by metric; all have axes of one kind, so that they can be compared.
    ``percentiles``: Percentiles of one case; rows of forecaster ``training`` and ``floor`` are
    horizontal lines.
    """
    for metric, axes in panels.items():
        _draw(axes, percentiles, metric, intervals, published)
    logarithmic = any(_spread(percentiles, metric) > LARGEST_LINEAR_RATIO for metric in panels)
    for axes in panels.values():
        if logarithmic:
            axes.set_yscale("log")
        else:
            axes.set_ylim(0, 1.08 * axes.dataLim.y1)


def _spread(percentiles: pd.DataFrame, metric: str) -> float:
    """Largest over least of what is shown of a metric; 1 where there is nothing, or a zero."""
    shown = percentiles.loc[percentiles["metric"] == metric, ["p25", "p50", "p75"]].to_numpy()
    least, largest = np.nanmin(shown, initial=np.inf), np.nanmax(shown, initial=0.0)
    return float(largest / least) if 0.0 < least <= largest else 1.0


def _draw(
    axes: Axes,
    percentiles: pd.DataFrame,
    metric: str,
    intervals: pd.DataFrame,
    published: pd.DataFrame | None,
) -> None:
    """Draw one statistic's error."""
    networks = percentiles[percentiles["forecaster"] == "esn"]
    for validation in ordered_validations(networks["validation"].dropna()):
        style = validation_style(validation)
        rows = select(networks, metric=metric, validation=validation)
        draw_percentiles(axes, rows, "neurons", style, label=f"ESN, {validation}")
        draw_single_intervals(axes, intervals, metric, validation, style)
        if published is not None:
            rows = select(published, metric=metric, validation=validation)
            rows = rows[rows["neurons"].isin(networks["neurons"])]
            draw_published(axes, rows, "neurons", style)
    for forecaster, line, label in (
        ("training", TRAINING, "Train"),
        ("floor", FLOOR, "half of the data against the other half"),
    ):
        for value in select(percentiles, metric=metric, forecaster=forecaster)["p50"]:
            axes.axhline(float(value), label=label, **line)
    if published is not None:
        rows = select(published, metric=metric, forecaster="training")
        draw_published_level(axes, rows, TRAINING["color"])
    axes.set_xticks(sorted(networks["neurons"].dropna().unique()))
    if networks["neurons"].nunique() > 4:
        for index, tick in enumerate(axes.get_xticklabels()):
            tick.set_visible(index % 2 == 1)
    axes.set_xlabel(NEURONS_LABEL)
    axes.set_ylabel(METRIC_LABELS[metric])
