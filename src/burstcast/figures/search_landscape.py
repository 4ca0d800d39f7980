"""Objective of the hyperparameter search at each point, best Tikhonov parameter: interpolated
between the evaluated points (dots: the grid; numbers: points of the Bayesian search in their
order; in colour: the optimum), and how far the best value found so far lay above the final one.
"""

from collections.abc import Sequence
from typing import Any

import matplotlib
import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator
from matplotlib.tri import Triangulation

from burstcast.figures.parts.style import (
    DOUBLE_COLUMN,
    VERMILLION,
    letter_panels,
    new_figure,
    ordered_validations,
    styled,
    validation_style,
)
from burstcast.figures.registry import Declaration

FIGURE = Declaration(
    section="networks",
    position=30,
    inputs={"traces": "example_strategies/search.csv"},
)


def draw(*, traces: Sequence[pd.DataFrame]) -> Figure:
    """Draw the best Tikhonov parameter of each point, from a trace of each strategy."""
    shown = [trace.loc[trace.groupby("evaluation")["objective"].idxmin()] for trace in traces]
    return search_landscape(pd.concat(shown, ignore_index=True))


@styled
def search_landscape(trace: pd.DataFrame) -> Figure:
    """Draw the objective found at each point, one panel per strategy, and how the best one fell.

    The surface is the linear interpolation between the evaluated points (the best Tikhonov
    parameter of each). Dots are the grid, numbers the points that the Bayesian search chose, in
    their order; the optimum is in colour.

    Parameters
    ----------
    trace
        Trace of one network under each strategy, in the order of evaluation: ``validation``,
        ``source`` (``grid`` or ``bayesian``), ``spectral_radius``, ``input_scaling``, ``objective``
        (log10 of the mean square error).

    Raises
    ------
    ValueError
        If an objective is not finite, or a strategy has fewer than three points.
    """
    if not np.isfinite(trace["objective"].to_numpy(dtype=np.float64)).all():
        raise ValueError("the objective is not finite at some point of the search")
    validations = ordered_validations(trace["validation"])
    figure = new_figure(DOUBLE_COLUMN, 2.2)
    panels = figure.subplots(
        1, len(validations) + 1, squeeze=False, width_ratios=[*[1.0] * len(validations), 0.95]
    )[0]
    progress = panels[-1]
    for panel, validation in zip(panels, validations, strict=False):
        points = trace[trace["validation"] == validation].reset_index(drop=True)
        if len(points) < 3:
            raise ValueError(f"{validation} has {len(points)} points, no surface")
        _draw_surface(figure, panel, points)
        panel.set_title(validation, loc="center")
        style: dict[str, Any] = {**validation_style(validation), "marker": None}
        best = np.minimum.accumulate(points["objective"].to_numpy(dtype=np.float64))
        number = np.arange(1, len(points) + 1)
        # above its end: the strategies minimise errors over different intervals
        progress.plot(number, best - best[-1], drawstyle="steps-post", label=validation, **style)
    panels[0].set_ylabel(r"Spectral radius, $\rho$")
    grid_points = int((trace["source"] == "grid").sum()) // len(validations)
    progress.axvline(grid_points + 0.5, color="0.5", linewidth=0.6, linestyle=":")
    progress.annotate(
        "grid",
        (grid_points + 0.5, 1),
        (-3, -4),
        progress.get_xaxis_transform(),
        "offset points",
        ha="right",
        va="top",
    )
    progress.annotate(
        "Bayesian",
        (grid_points + 0.5, 1),
        (3, -4),
        progress.get_xaxis_transform(),
        "offset points",
        ha="left",
        va="top",
    )
    low, high = progress.get_ylim()
    progress.set_ylim(low, high + 0.12 * (high - low))  # room for the words
    progress.set_xlabel("Points evaluated")
    progress.set_ylabel(r"$\log_{10}$ (best MSE so far / final MSE)")
    progress.legend(loc="upper right", bbox_to_anchor=(1.0, 0.9))
    letter_panels(list(panels))
    return figure


def _draw_surface(figure: Figure, panel: Axes, points: pd.DataFrame) -> None:
    """Draw the interpolated objective, the points and the optimum."""
    x, y = (np.log10(points[name].to_numpy()) for name in ("input_scaling", "spectral_radius"))
    objective = points["objective"].to_numpy(dtype=np.float64)
    # Two searches may meet in the same point; a triangulation wants distinct ones.
    distinct = np.unique(np.round(np.column_stack([x, y]), 9), axis=0, return_index=True)[1]
    # Failures lie orders of magnitude above the rest: the colours are for the better part.
    low, high = float(objective.min()), float(np.quantile(objective, 0.75))
    high = high if high > low else low + 1.0
    levels = MaxNLocator(10, steps=[1, 2, 5, 10]).tick_values(low, high)
    surface = panel.tricontourf(
        Triangulation(x[distinct], y[distinct]),
        objective[distinct],
        levels=levels,
        cmap=matplotlib.colormaps["cividis"],
        extend="max",
    )
    bar = figure.colorbar(surface, ax=panel, pad=0.02, aspect=25)
    bar.set_ticks(list(levels[:: max(1, len(levels) // 5)]))
    bar.ax.set_title(r"$\log_{10}$ MSE")  # beside it, it would touch the next panel's label
    best = int(objective.argmin())
    grid = (points["source"] == "grid").to_numpy()
    for index in np.flatnonzero(grid):
        colour, size = (VERMILLION, 6.0) if index == best else ("white", 3.0)
        panel.plot(
            x[index], y[index], "o", color=colour, mec="black", mew=0.5, ms=size, clip_on=False
        )
    for number, index in enumerate(np.flatnonzero(~grid), start=1):
        panel.annotate(
            str(number),
            (x[index], y[index]),
            ha="center",
            va="center",
            fontsize=6,
            color="white" if index == best else "black",
            bbox={
                "boxstyle": "circle,pad=0.12",
                "facecolor": VERMILLION if index == best else "white",
                "edgecolor": "black",
                "linewidth": 0.5,
            },
            annotation_clip=False,
            zorder=7 if index == best else 6,
        )
    panel.set_xlabel(r"Input scaling, $\sigma_{\mathrm{in}}$")
    for axis, values in ((panel.xaxis, x), (panel.yaxis, y)):
        decades = [0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0]
        inside = [d for d in decades if values.min() - 1e-9 <= np.log10(d) <= values.max() + 1e-9]
        shown = inside if axis is panel.yaxis else [d for d in inside if d in (0.1, 1.0, 10.0)]
        axis.set_ticks(list(np.log10(shown)), [f"{d:g}" for d in shown])
    panel.set_xlim(x.min(), x.max())
    panel.set_ylim(y.min(), y.max())
