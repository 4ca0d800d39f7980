"""The published medians of the paper (open markers) and ours (lines): (a) precision, (b) recall and
(c) F-score against the prediction time, by the number of neurons; (d) mean prediction horizon of
extreme events against the number of neurons, where there are several. Bands and bars: 95 %
intervals of a single network over test series and events.
"""

from collections.abc import Iterable

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from burstcast.base.declared import at, read
from burstcast.figures.parts import looks, medians, style
from burstcast.figures.parts.published import published_beside
from burstcast.figures.registry import figure
from burstcast.forecasters._labels import forecaster_label

_SCORES = ("precision", "recall", "f_score")
_TIME, _HORIZON = "prediction_time_lt", "mean_horizon_lt"


@figure(section="forecasts", position=25, cases="networks", only_flows=True, needs_networks=True)
def draw(
    *,
    scores: pd.DataFrame = read("case/tables/classification_percentiles.csv"),
    score_intervals: pd.DataFrame = read("case/tables/classification_intervals.csv"),
    horizons: pd.DataFrame = read("case/tables/horizon_percentiles.csv"),
    horizon_intervals: pd.DataFrame = read("case/tables/horizon_intervals.csv"),
    validation: str = at("shown.example.name.validation"),
    published: pd.DataFrame,
) -> Figure:
    """Draw networks of one strategy: sizes of which each is at least twice the one before."""
    scores = medians.with_intervals(scores, score_intervals)
    horizons = medians.with_intervals(horizons, horizon_intervals)
    curves = _curves(medians.select(scores, validation=validation))
    sizes = np.unique(medians.select(horizons, validation=validation)["neurons"].astype(float))
    several = len(sizes[np.isfinite(sizes)]) > 1
    figure = style.new_figure(style.DOUBLE_COLUMN, 4.4 if several else 2.4)
    panels = figure.subplots(*((2, 2) if several else (1, 3))).ravel()
    theirs = published_beside(scores, published, "classification")
    for axes, metric in zip(panels, _SCORES, strict=False):
        of: dict[str, object] = {"metric": metric, "validation": validation}
        for (kind, neurons), look in curves.items():
            label = forecaster_label(kind).replace("network", f"{neurons:g} neurons")
            network = {**of, "forecaster": kind, "neurons": neurons}
            _draw(axes, scores, theirs, network, _TIME, look, label)
        axes.set_ylim(0.0, 1.03)
        axes.set_xlabel(medians.PREDICTION_TIME)
        axes.set_ylabel(medians.LABELS[metric])
    if several:
        _draw_horizons(panels[3], horizons, published, validation, curves)
    spread = medians.spread_handles(panels, "interval of a network")
    style.legend_above(figure, [], [*spread, *medians.published_handles(panels)])
    style.letter_panels(panels)
    style.label_ends(figure, panels if several else panels[2:])
    return figure


def _draw_horizons(
    axes: Axes,
    horizons: pd.DataFrame,
    published: pd.DataFrame,
    validation: str,
    curves: dict[tuple[str, float], looks.MarkerStyle],
) -> None:
    """Draw the mean prediction horizon against the size."""
    theirs = published_beside(horizons, published, "horizon")
    of: dict[str, object] = {"metric": _HORIZON, "validation": validation}
    for kind in dict.fromkeys(kind for kind, _ in curves):
        look = next(look for (name, _), look in curves.items() if name == kind)
        networks = {**of, "forecaster": kind}
        _draw(axes, horizons, theirs, networks, "neurons", look, forecaster_label(kind))
    axes.set_xticks(np.unique(medians.select(horizons, **of)["neurons"].astype(float)))
    axes.set_xlabel(medians.NEURONS)
    axes.set_ylabel(medians.LABELS[_HORIZON])


def _curves(networks: pd.DataFrame) -> dict[tuple[str, float], looks.MarkerStyle]:
    """Looks of kinds of networks by their size, as many as panels show."""
    sizes = networks.groupby("forecaster")["neurons"].unique()
    curves = [
        (kind, size)
        for kind in looks.ordered_forecasters(sizes.index)
        for size in _doubling(sorted(sizes[kind].astype(float)))
    ][: looks.MOST_CURVES]
    return dict(zip(curves, looks.sequence(len(curves)), strict=True))


def _doubling(sizes: Iterable[float]) -> list[float]:
    chosen: list[float] = []
    for size in sizes:
        if not chosen or size >= 2 * chosen[-1]:
            chosen.append(size)
    return chosen


def _draw(
    axes: Axes,
    ours: pd.DataFrame,
    theirs: pd.DataFrame,
    of: dict[str, object],
    x: str,
    look: looks.MarkerStyle,
    label: str,
) -> None:
    """Draw the rows of some networks, ours as a line and the published ones as markers."""
    rows = medians.select(ours, **of)
    band = rows.assign(p25=rows["low"], p75=rows["high"])
    medians.draw(axes, band, x, {**look, "marker": "."}, label=label)
    beside = medians.select(theirs, **of)
    beside = beside[beside[x].isin(rows[x])].drop(columns=["p25", "p75"])
    medians.draw_published(axes, beside, x, {**look, "marker": "o"})
