"""Remaining exceedance of the event threshold, as a share of that without control, against the
actuation duty cycle: by strategies that react to the observable or to a forecast, and by strategies
that compare forecasts with and without actuation, of each at most the four with most runs, under
the usual conditions (no delay, full strength). Small open markers are the runs with all settings,
such as horizons or levels; lines join the runs that no other run of the same strategy and
forecaster betters in both. The vertical axis is linear in the grey strip; at 0 no event was
observed: how rare an event is there, long runs say (return levels). Bars: confidence intervals over
flows. One network is shown, and the committee of all networks of its size.
"""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import FixedLocator, FuncFormatter, MaxNLocator, NullFormatter

from burstcast.base.declared import at, read
from burstcast.figures.parts import looks, medians, style
from burstcast.figures.registry import figure
from burstcast.forecasters._labels import forecaster_label

LEFT, ACTING = "relative_exceedance", "control_fraction"
_ENDS = ("value", "low", "high")
_IN_STRIP: Any = {"ha": "right", "va": "bottom", "color": style.GREY}


@figure(section="control", position=50, cases="other_control")
def draw(
    *,
    scores: pd.DataFrame = read("case/tables/control_strategies.csv"),
    network: Mapping[str, Any] | None = at("shown.frontier_network"),
    span_lt: float = at("control.span_lt"),
    noise: float = at("case.training.noise"),
    symbol: str = at("case.space.observable_symbol"),
) -> Figure:
    """Draw all strategies with one network at most, and the forecasters to compare it with.

    ``span_lt``, ``noise``: Usual length of a run and noise of the observations.
    """
    runs = _runs_of(_of_network(scores, network), span_lt)
    runs = _where(runs, {"delay_lt": 0.0, "strength": 1.0, "noise": noise})
    if runs.empty:
        return style.nothing_to_show(
            "Without control no event occurred that control could prevent."
        )
    comparing = runs["strategy"].isin(looks.COMPARING)
    groups = [group for group in (runs[~comparing], runs[comparing]) if len(group)]
    figure = style.new_figure(style.DOUBLE_COLUMN, 3.4)
    panels = figure.subplots(1, len(groups), sharey=True, squeeze=False)[0]
    for axes, group in zip(panels, map(_most_runs, groups), strict=True):
        _draw_frontier(axes, group, _looks(group))
    _finish_frontiers(panels)
    _finish(panels, runs)
    panels[0].set_ylabel(rf"Remaining share of $P({symbol} \geq {symbol}_e)$")
    small: Any = {"marker": "o", "markersize": 2.2, "markeredgewidth": 0.5, "linestyle": "none"}
    others = Line2D(
        [], [], color=style.GREY, markerfacecolor="white", label="other settings", **small
    )
    style.legend_above(figure, panels, [others, style.bar_handle("interval over flows")], columns=2)
    style.letter_panels(panels)
    return figure


def _of_network(scores: pd.DataFrame, network: Mapping[str, Any] | None) -> pd.DataFrame:
    """Rows of one network, of the committee of its size, and of all other forecasters."""
    shown = ~scores["forecaster"].isin(["esn", "esn_committee", "random"])
    if network is not None:
        shown |= (scores[list(network)] == pd.Series(network)).all(axis="columns")
        size = pd.Series(network)[["neurons", "validation"]]
        alike = (scores[list(size.index)] == size).all(axis="columns")
        shown |= alike & (scores["forecaster"] == "esn_committee")
    return scores[shown]


def _runs_of(scores: pd.DataFrame, span_lt: float) -> pd.DataFrame:
    """A row for each run of the flows that are shown, with both scores and its ``label``.

    These start quietly, last so long, and have the quiet that most runs have.
    """
    keys = [name for name in scores.columns if name not in ("metric", *_ENDS)]
    parts = []
    for metric in (LEFT, ACTING):
        rows = scores[scores["metric"] == metric].drop(columns="metric").drop_duplicates(keys)
        parts.append(rows.rename(columns={end: f"{end}_{metric}" for end in _ENDS}))
    runs = parts[0].merge(parts[1], on=keys)
    shown = (runs["starts"] == "quiet") & np.isclose(runs["span_lt"], span_lt)
    runs = runs.loc[shown & runs[f"value_{LEFT}"].notna()]
    runs = runs.loc[runs["quiet_lt"].isin(runs["quiet_lt"].mode()[-1:])]
    return runs.assign(label=_labels(runs))


def _where(runs: pd.DataFrame, conditions: Mapping[str, float]) -> pd.DataFrame:
    """Runs under these conditions."""
    matching = np.ones(len(runs), dtype=bool)
    for name, value in conditions.items():
        matching &= np.isclose(runs[name].astype(np.float64), value)
    return runs.loc[matching]


def _undominated(runs: pd.DataFrame) -> pd.DataFrame:
    """Runs on the frontier: no other run leaves less at a shorter time under actuation."""
    runs = runs.sort_values([f"value_{ACTING}", f"value_{LEFT}"])
    left = runs[f"value_{LEFT}"]
    return runs[left < left.cummin().shift(fill_value=np.inf)]


def _labels(runs: pd.DataFrame) -> list[str]:
    """Strategy and forecaster in words, and what it observes where its runs differ in that."""
    labels = []
    for strategy, forecaster in zip(runs["strategy"], runs["forecaster"], strict=True):
        title, _ = looks.strategy(strategy)
        labels.append(title if forecaster == "none" else f"{title}, {forecaster_label(forecaster)}")
    if "observed" not in runs:
        return labels
    observed = runs["observed"].fillna("")
    counts = observed.groupby(labels).nunique()
    return [
        f"{label}, observed {modes.replace('_', ' ')}" if counts[label] > 1 and modes else label
        for label, modes in zip(labels, observed, strict=True)
    ]


def _most_runs(runs: pd.DataFrame) -> pd.DataFrame:
    """Runs of the strategies and forecasters that have most of them, as many as a row shows."""
    counts = runs.groupby("label", sort=False).size().sort_values(ascending=False, kind="stable")
    return runs[runs["label"].isin(counts.index[: looks.MOST_CURVES])]


def _looks(runs: pd.DataFrame) -> dict[str, Any]:
    """Look of each strategy and forecaster of a row, in the order of the legend."""
    strategies = looks.ordered_strategies(runs["strategy"])
    forecasters = looks.ordered_forecasters(runs["forecaster"])

    def place(run: dict[Any, Any]) -> tuple[int, int]:
        return strategies.index(run["strategy"]), forecasters.index(run["forecaster"])

    first = sorted(runs.drop_duplicates("label").to_dict("records"), key=place)
    return {
        run["label"]: {**look, "marker": looks.strategy(run["strategy"])[1], "markersize": 4.0}
        for run, look in zip(first, looks.categories(len(first)), strict=True)
    }


def _draw_curve(axes: Axes, rows: pd.DataFrame, look: Mapping[str, Any]) -> None:
    """Draw the share left, with its interval where an event was observed."""
    ends = rows[f"value_{LEFT}"] > 0
    bars = (
        medians.lengths(rows, *(f"{end}_{LEFT}" for end in ("value", "low", "high")))
        * ends.to_numpy()
    )
    thin: Any = {"capsize": 1.5, "elinewidth": 0.5, "capthick": 0.5}
    axes.errorbar(rows[f"value_{ACTING}"], rows[f"value_{LEFT}"], yerr=bars, **thin, **look)


def _draw_frontier(axes: Axes, runs: pd.DataFrame, curves: Mapping[str, Any]) -> None:
    """Draw the share left against the time under actuation."""
    for label, look in curves.items():
        rows = runs[runs["label"] == label]
        if rows.empty:
            continue
        small: dict[str, Any] = {
            **look,
            "linestyle": "none",
            "markersize": 2.2,
            "markeredgewidth": 0.5,
        }
        axes.plot(rows[f"value_{ACTING}"], rows[f"value_{LEFT}"], **small, markerfacecolor="white")
        _draw_curve(axes, _undominated(rows), {**look, "label": label})
    axes.set_xlabel("Actuation duty cycle")


def _finish_frontiers(panels: Sequence[Axes]) -> None:
    """Make the axes of the time under actuation logarithmic, with the same limits."""
    for axes in panels:
        axes.set_xscale("log")
        axes.margins(x=0.08)
    limits = [axes.get_xlim() for axes in panels]
    for axes in panels:
        low, high = min(limits)[0], max(end for _, end in limits)
        axes.set_xlim(low, high)
        steps = (1, 2, 5) if high > 5 * low else (1, 1.5, 2, 3, 4, 5, 7)
        ticks = [step * unit for unit in (0.01, 0.1, 1.0) for step in steps]
        ticks = [tick for tick in ticks if low <= tick <= high]
        # of a narrow range, at least two that are nice between its ends
        axes.xaxis.set_major_locator(FixedLocator(ticks) if len(ticks) > 1 else MaxNLocator(5))
        axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        axes.xaxis.set_minor_formatter(NullFormatter())


def _finish(panels: Sequence[Axes], runs: pd.DataFrame) -> None:
    """Make the vertical axes logarithmic down to the least share that is left, linear below it."""
    shares = runs[f"value_{LEFT}"]
    # a power of ten, not above the least share but for tiny ones
    end = 10.0 ** np.clip(np.floor(np.log10(shares[shares > 0].min())), -5, -1)
    end = 0.1 if np.isnan(end) else end
    highest = max(1.0, float(shares.max()), float(runs[f"high_{LEFT}"].max()))
    for axes in panels:
        axes.set_yscale("symlog", linthresh=end, linscale=0.6)
        axes.set_ylim(-0.25 * end, 3.0 * highest)
        axes.axhspan(-0.25 * end, end, color=style.LIGHT_GREY, alpha=0.5, linewidth=0, zorder=0.2)
        axes.axhline(1.0, color=style.GREY, linewidth=0.5, zorder=0.5)
        if (shares == 0).any():
            place = {**_IN_STRIP, "transform": axes.get_yaxis_transform()}
            axes.text(0.98, 0.3 * end, "0: no event observed", **place)
