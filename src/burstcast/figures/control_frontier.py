"""Exceedance of the event threshold that control leaves, as a share of that without control: by
rules and strategies that react to a forecast, and by strategies that compare forecasts with and
without actuation, of each at most the four with most runs. Against the share of the time under
actuation, small markers are the runs with all settings, such as horizons or levels; lines join the
runs that no other run of the same strategy and forecaster betters in both. Against conditions,
curves have the setting that was tried at most values, and of several the one that leaves least. The
vertical axes are linear in the shaded strip: a marker on 0 has left nothing in these flows; how
rare an event is, long runs say (return levels). Bars: confidence intervals over flows. One network
is shown, and the committee of all networks of its size.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FixedLocator, FuncFormatter, MaxNLocator, NullFormatter, NullLocator

from burstcast.base.declared import at, read
from burstcast.figures.parts import looks, medians, style
from burstcast.figures.registry import figure
from burstcast.forecasters._labels import forecaster_label

LEFT, ACTING = "relative_exceedance", "control_fraction"
_ENDS = ("value", "low", "high")
_NO_SETTINGS = {
    *("case", "reynolds", "forecaster", "neurons", "validation", "seed", "strategy", "label"),
    *("starts", "quiet_lt", "span_lt", "delay_lt", "strength", "noise"),
    *(f"{end}_{metric}" for metric in (LEFT, ACTING) for end in _ENDS),
}


@dataclass(frozen=True)
class Condition:
    """A condition that strategies are tried under, as an axis."""

    column: str
    label: str
    logarithmic: bool = True
    unit: float = 1.0


CONDITIONS = (
    Condition("delay_lt", "Delay of the actuator [LT]", logarithmic=False),
    Condition("strength", "Strength of the actuator"),
    Condition("noise", "Noise of the observations [%]", unit=100.0),
)


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
    usual = {"delay_lt": 0.0, "strength": 1.0, "noise": noise}
    comparing = runs["strategy"].isin(looks.COMPARING)
    contents: list[tuple[Condition | None, pd.DataFrame, dict[str, Any]]] = []
    for group in (_most_runs(runs[~comparing]), _most_runs(runs[comparing])):
        curves = _looks(group)
        contents.append((None, _where(group, usual), curves))
        contents += [
            (condition, _tried_under(group, usual, condition.column), curves)
            for condition in CONDITIONS
        ]
    contents = [content for content in contents if not content[1].empty]
    if not contents:
        return style.nothing_to_show(
            "Without control no event occurred that control could prevent."
        )
    rows = math.ceil(len(contents) / 4)
    columns = math.ceil(len(contents) / rows)
    figure = style.new_figure(style.DOUBLE_COLUMN, 0.7 + 2.1 * rows)
    panels = style.grid_of(figure, len(contents), columns, sharey=True)
    frontiers: list[Axes] = []
    for axes, (condition, shown, curves) in zip(panels, contents, strict=True):
        if condition is None:
            _draw_frontier(axes, shown, curves)
            frontiers.append(axes)
        else:
            _draw_condition(axes, shown, curves, condition)
    _finish_frontiers(frontiers)
    _finish(panels, pd.concat([shown for _, shown, _ in contents]))
    for axes in panels[::columns]:
        axes.set_ylabel(rf"Exceedance left, $P({symbol} \geq {symbol}_e)$")
    style.legend_above(figure, panels, [style.bar_handle("interval over flows")], columns=2)
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


def _tried_under(runs: pd.DataFrame, conditions: Mapping[str, float], column: str) -> pd.DataFrame:
    """Runs of one setting of each strategy and forecaster at several values of one condition.

    All other conditions are as usual. The setting is the one that was tried at most values, and of
    several the one that leaves least.
    """
    runs = _where(runs, {name: value for name, value in conditions.items() if name != column})
    chosen = []
    for _, of_label in runs.groupby("label", sort=False):
        settings = [rows for _, rows in of_label.groupby(_settings(runs), dropna=False)]
        tried = [rows for rows in settings if rows[column].nunique() > 1]
        if tried:
            chosen.append(
                min(tried, key=lambda rows: (-rows[column].nunique(), rows[f"value_{LEFT}"].mean()))
            )
    return pd.concat(chosen) if chosen else runs.iloc[:0]


def _undominated(runs: pd.DataFrame) -> pd.DataFrame:
    """Runs on the frontier: no other run leaves less at a shorter time under actuation."""
    runs = runs.sort_values([f"value_{ACTING}", f"value_{LEFT}"])
    left = runs[f"value_{LEFT}"]
    return runs[left < left.cummin().shift(fill_value=np.inf)]


def _settings(runs: pd.DataFrame) -> list[str]:
    """Names of the settings that any strategy has."""
    return [name for name in runs.columns if name not in _NO_SETTINGS]


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


def _draw_curve(axes: Axes, rows: pd.DataFrame, x: Any, look: Mapping[str, Any]) -> None:
    """Draw the share left, with its interval."""
    bars = medians.lengths(rows, *(f"{end}_{LEFT}" for end in ("value", "low", "high")))
    thin: Any = {"capsize": 1.5, "elinewidth": 0.5, "capthick": 0.5}
    axes.errorbar(x, rows[f"value_{LEFT}"], yerr=bars, **thin, **look)


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
        best = _undominated(rows)
        _draw_curve(axes, best, best[f"value_{ACTING}"], {**look, "label": label})
    axes.set_xlabel("Share of the time under actuation")


def _draw_condition(
    axes: Axes, runs: pd.DataFrame, curves: Mapping[str, Any], condition: Condition
) -> None:
    """Draw the share left against a condition."""
    values = condition.unit * np.unique(runs[condition.column].to_numpy(dtype=np.float64))
    for number, (label, look) in enumerate(curves.items()):
        rows = runs[runs["label"] == label].sort_values(condition.column)
        if rows.empty:
            continue
        position = condition.unit * rows[condition.column].to_numpy(dtype=np.float64)
        # a hair apart, so that bars do not hide each other
        apart = 0.015 * (number - 0.5 * (len(curves) - 1))
        if condition.logarithmic:
            position = position * (values[-1] / values[0]) ** apart
        else:
            position = position + (values[-1] - values[0]) * apart
        _draw_curve(axes, rows, position, {**look, "label": label})
    if condition.logarithmic:
        axes.set_xscale("log")
    axes.set_xticks(values, [f"{value:g}" for value in values])
    axes.xaxis.set_minor_locator(NullLocator())
    axes.margins(x=0.12)
    axes.set_xlabel(condition.label)


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
