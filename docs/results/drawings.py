"""Figures of the pages of results that no campaign draws by itself."""

from typing import Any

import numpy as np
from comparisons import HORIZON, f_score, over_sets
from kept_tables import Tables, published_rows
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from burstcast.figures.parts import looks, style

RV = {"forecaster": "esn", "validation": "RV"}
SIZES = (500, 1000, 2000)


@style.styled
def draw_published_scores(tables: Tables) -> Figure:
    """Draw published medians over ours with the interval of one network, Re = 400, RV."""
    figure = style.new_figure(style.DOUBLE_COLUMN, 4.2)
    panels = figure.subplots(2, 2).ravel()
    scores = {"precision": "precision", "recall": "recall", "f_score": "F-score"}
    for axes, (metric, title) in zip(panels, scores.items(), strict=False):
        for size, look in zip(SIZES, looks.sequence(len(SIZES)), strict=True):
            of = {"neurons": size, **RV}
            ours = tables.medians("classification", metric, case="Re400", **of)
            theirs = published_rows("classification", metric, reynolds=400, **of)
            _both(axes, "prediction_time_lt", ours, theirs, look)
            last = ours.sort_values("prediction_time_lt").iloc[-1]
            beside = (4, {1000: -5, 2000: 5}.get(size, 0))
            axes.annotate(
                f"{size}",
                (last["prediction_time_lt"], last["p50"]),
                beside,
                textcoords="offset points",
                va="center",
                color=look["color"],
            )
        axes.set_xlabel("prediction time [LT]")
        axes.set_ylabel(title)
        axes.set_ylim(0, 1.03)
        axes.set_xlim(right=5.6)
    (look,) = looks.sequence(1)
    ours = tables.medians("horizon", "mean_horizon_lt", case="Re400", **RV)
    theirs = published_rows("horizon", "mean_horizon_lt", reynolds=400, **RV)
    _both(panels[3], "neurons", ours, theirs, look)
    panels[3].set_xlabel("neurons")
    panels[3].set_ylabel("mean PH_ee [LT]")
    panels[3].legend(loc="lower right")
    style.letter_panels(panels)
    return figure


def _both(axes: Axes, x: str, ours: Any, theirs: Any, look: Any) -> None:
    ours, theirs = ours.sort_values(x), theirs.sort_values(x)
    axes.fill_between(
        ours[x].to_numpy(float), ours["low"], ours["high"], alpha=0.25, lw=0, color=look["color"]
    )
    axes.plot(ours[x], ours["p50"], color=look["color"], label="burstcast")
    axes.plot(
        theirs[x],
        theirs["p50"],
        color=look["color"],
        marker="o",
        linestyle="none",
        markerfacecolor="white",
        label="published",
    )


@style.styled
def draw_readouts(tables: Tables) -> Figure:
    """Draw F-score and PH_ee against the size, a curve for each readout, with 95 % intervals."""
    figure = style.new_figure(style.DOUBLE_COLUMN, 2.6)
    panels = figure.subplots(1, 2)
    for axes, score in zip(panels, (f_score(3.0), HORIZON), strict=True):
        found = over_sets(tables, score)
        found = found[found["forecaster"].isin(["esn", "esn_bias", "esn_quadratic"])]
        curves = found.groupby("readout", sort=False)
        for (name, curve), look in zip(curves, looks.sequence(curves.ngroups), strict=True):
            sizes = curve["neurons"].to_numpy(dtype=np.float64)
            axes.fill_between(
                sizes, curve["low"], curve["high"], alpha=0.2, lw=0, color=look["color"]
            )
            axes.plot(
                sizes,
                curve["mean"],
                color=look["color"],
                marker=look["marker"],
                linestyle=look["linestyle"],
                label=str(name),
            )
        axes.set_xscale("log", base=2)
        ticks = sorted(found["neurons"].unique())
        axes.set_xticks(ticks, [f"{size:g}" for size in ticks])
        axes.set_xlabel("neurons")
        axes.set_ylabel(score.title)
    panels[0].legend(loc="lower right")
    style.letter_panels(panels)
    return figure


@style.styled
def draw_late_actuator(tables: Tables) -> Figure:
    """Draw what the best rule and plans leave, and their duty cycles, by the actuator's delay."""
    runs = tables.runs("control_choices", case="Re400", strength=1.0, noise=0.01)
    runs = runs.sort_values("left", kind="stable")
    kinds = {
        "rule": runs[runs["strategy"] == "reactive"],
        "plans, learnt equations": runs[
            (runs["strategy"] == "planned") & (runs["forecaster"] == "quadratic_aware_filtered")
        ],
        "plans, network": runs[
            (runs["strategy"] == "planned") & (runs["forecaster"] == "esn_aware")
        ],
    }
    figure = style.new_figure(style.DOUBLE_COLUMN, 2.4)
    panels = figure.subplots(1, 2)
    for (name, rows), look in zip(kinds.items(), looks.sequence(len(kinds)), strict=True):
        best = rows.drop_duplicates("delay_lt").sort_values("delay_lt")
        for axes, of in zip(panels, ("left", "acting"), strict=True):
            value, low, high = (100 * best[f"{of}{end}"] for end in ("", "_low", "_high"))
            axes.errorbar(
                best["delay_lt"], value, (value - low, high - value), label=name, capsize=2, **look
            )
    for axes, title in zip(panels, ("exceedance left [%]", "under actuation [%]"), strict=True):
        axes.set_xlabel("delay [LT]")
        axes.set_ylabel(title)
        axes.set_ylim(bottom=-2)
    panels[0].legend(loc="upper left")
    style.letter_panels(panels)
    return figure
