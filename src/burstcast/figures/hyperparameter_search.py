"""Objective of the search for hyperparameters against spectral radius and input scaling, of the
network that examples are taken from: log10 of the mean square error of the observable in the
validation intervals, with the best Tikhonov parameter of each point. Squares: the grid; circles:
points that Bayesian optimisation chose after it; star: the minimum, which the network has. Shades
between the points are interpolated, and end at the objective that half of the grid exceeds.
"""

from typing import Any

import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from matplotlib.ticker import NullFormatter
from matplotlib.tri import Triangulation

from burstcast.base.declared import read
from burstcast.figures.parts import style
from burstcast.figures.registry import figure

_AXES = ["spectral_radius", "input_scaling"]
_MARKERS = {"grid": "s", "bayesian": "o"}
_SHADES = 24


@figure(section="networks", position=30, needs_networks=True)
def draw(*, trace: pd.DataFrame = read("example/search.csv")) -> Figure:
    """Draw the points of a search, and the objective between them."""
    points = trace.sort_values("objective", kind="stable").drop_duplicates(_AXES)
    radius, scaling = (points[name].to_numpy(dtype=np.float64) for name in _AXES)
    grid = points.loc[points["source"] == "grid", "objective"]
    least, most = float(points["objective"].min()), float(grid.median())
    figure = style.new_figure(style.SINGLE_COLUMN, 2.8)
    axes = figure.subplots()
    shades: dict[str, Any] = {"cmap": "viridis", "vmin": least, "vmax": most}
    if len(set(radius)) > 1 and len(set(scaling)) > 1 and most > least:
        triangles = Triangulation(np.log(radius), np.log(scaling)).triangles
        between = Triangulation(radius, scaling, triangles)
        levels = np.linspace(least, most, _SHADES)
        axes.tricontourf(between, points["objective"], levels, extend="max", **shades)
    for source, marker in _MARKERS.items():
        rows = points[points["source"] == source]
        shown = axes.scatter(
            rows[_AXES[0]],
            rows[_AXES[1]],
            c=rows["objective"],
            marker=marker,
            s=22,
            edgecolors="white",
            linewidths=0.6,
            **shades,
        )
    axes.plot(
        radius[0], scaling[0], "*", color=style.VERMILLION, markersize=9, markeredgecolor="white"
    )
    figure.colorbar(shown, ax=axes, extend="max", label=r"Objective, $\log_{10}$ MSE")
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.use_sticky_edges = False  # shades end at the outermost points
    axes.margins(0.08)
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_minor_formatter(NullFormatter())
    axes.set_xlabel(r"Spectral radius, $\rho$")
    axes.set_ylabel(r"Input scaling, $\sigma_\mathrm{in}$")
    return figure
