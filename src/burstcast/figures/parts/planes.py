"""Colour maps of a quantity over a plane of the flow, below the observable at their times."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import QuadMesh
from matplotlib.colors import Normalize
from matplotlib.figure import Figure, SubFigure
from matplotlib.image import AxesImage
from matplotlib.ticker import MaxNLocator

from burstcast.base.arrays import FloatArray
from burstcast.figures.parts import frame, looks, style

Curves = Sequence[tuple[FloatArray, str | None, looks.LineStyle]]

# -- flows in a plane ------------------------------------------------------------------------------


def evolution_above_fields(
    height: float,
    fields_share: float,
    time_lt: FloatArray,
    curves: Curves,
    times_lt: Sequence[float] | FloatArray,
    threshold: float,
    labels: tuple[str, str],
) -> tuple[Figure, Axes, SubFigure]:
    """Draw an observable with the event threshold and the times of fields, and leave room for them.

    ``height``, ``fields_share``: Height of the figure in inches, and of the part for the fields in
    heights of the panel. Returns the figure, the panel of the observable, and the part below it.
    """
    figure = style.new_figure(style.DOUBLE_COLUMN, height)
    grid = figure.add_gridspec(2, 1, height_ratios=[1.0, fields_share])
    upper, lower = (figure.add_subfigure(grid[row]) for row in range(2))
    evolution: Axes = upper.subplots()
    for observable, label, look in curves:
        evolution.plot(time_lt, observable, label=label, **look)
    frame.draw_threshold(evolution, threshold, "event threshold", at_left=True)
    for time in times_lt:
        evolution.axvline(time, **looks.WINDOW)
    evolution.set_xlim(time_lt[0], time_lt[-1])
    evolution.set_xlabel(labels[0])
    evolution.set_ylabel(labels[1])
    return figure, evolution, lower


def vorticity_fields(flow: Any, states: FloatArray, points: int = 96) -> FloatArray:
    """Vorticity of states of a plane flow on a regular grid, ``(states, points, points)``.

    ``states``: ``(dimension, states)``.
    """
    sides = [np.linspace(0.0, side, points) for side in flow.domain]
    grid = np.stack(np.meshgrid(*sides, indexing="ij"), axis=-1).reshape(-1, 2)
    fields: FloatArray = flow.vorticity(states, grid).reshape(points, points, -1)
    return np.moveaxis(fields, -1, 0)


def draw_periodic_field(
    axes: Axes, field: FloatArray, domain: tuple[float, float], largest: float
) -> AxesImage:
    """Draw a field of a doubly periodic flow, ``(points_x, points_y)``, with diverging colours."""
    image = axes.imshow(
        field.T,
        origin="lower",
        extent=(0.0, domain[0], 0.0, domain[1]),
        cmap="RdBu_r",
        vmin=-largest,
        vmax=largest,
    )
    axes.set_xlabel("$x$")
    axes.set_xticks([0.0, np.pi, 2.0 * np.pi], ["0", r"$\pi$", r"$2\pi$"])
    axes.set_yticks([0.0, np.pi, 2.0 * np.pi], ["0", r"$\pi$", r"$2\pi$"])
    return image


def draw_rows_of_fields(
    lower: SubFigure, fields: Mapping[str, FloatArray], domain: Any, titles: Sequence[str]
) -> list[Axes]:
    """Draw vorticity in rows of panels, by their labels, with one scale and one colour bar."""
    panels = lower.subplots(len(fields), len(titles), sharex=True, sharey=True, squeeze=False)
    largest = float(np.nanmax(np.abs(np.stack([*fields.values()]))))
    for row, (label, of_row) in zip(panels, fields.items(), strict=True):
        for axes, field, title in zip(row, of_row, titles, strict=True):
            drawn = draw_periodic_field(axes, field, domain, largest)
            axes.label_outer()
            axes.set_title(title, loc="right")
        row[0].set_ylabel(label)
    lower.colorbar(drawn, ax=list(panels.flat), label="Vorticity", shrink=0.7)
    return list(panels.flat)


# -- the midplane of a channel ---------------------------------------------------------------------


def draw_plane(
    axes: Axes, x: FloatArray, z: FloatArray, values: FloatArray, norm: Normalize, colours: str
) -> QuadMesh:
    """Draw values over the plane, ``(points_x, points_z)``, in its physical proportions."""
    mesh = axes.pcolormesh(
        x, z, values.T, norm=norm, cmap=colours, shading="gouraud", rasterized=True
    )
    axes.set_aspect("equal")
    axes.set_xlim(float(x[0]), float(x[-1]))
    axes.set_ylim(float(z[0]), float(z[-1]))
    axes.set_xticks(*_multiples_of_pi(x))
    axes.set_yticks(*_multiples_of_pi(z))
    axes.tick_params(direction="out", top=False, right=False)
    # The labels at the ends of neighbouring panels would run into each other.
    axes.get_xticklabels()[0].set_horizontalalignment("left")
    axes.get_xticklabels()[-1].set_horizontalalignment("right")
    return mesh


def _multiples_of_pi(coordinate: FloatArray) -> tuple[list[float], list[str]]:
    """Ticks at the ends of a periodic domain and in its middle, written as multiples of pi."""
    first, last = float(coordinate[0]), float(coordinate[-1])
    ticks = [first, 0.5 * (first + last), last]
    multiples = np.array(ticks) / np.pi
    if np.allclose(multiples, np.round(multiples), atol=1e-9):
        names = {0: "0", 1: r"$\pi$", -1: r"$-\pi$"}
        return ticks, [names.get(m, rf"${m}\pi$") for m in np.round(multiples).astype(int)]
    return ticks, [f"{tick:.3g}" for tick in ticks]


def symmetric_norm(fields: Sequence[FloatArray]) -> Normalize:
    """Scale from minus to plus the largest magnitude, for a diverging colour map."""
    largest = max(float(np.abs(field).max()) for field in fields)
    return Normalize(-largest or -1.0, largest or 1.0)


def evolution_above_planes(
    size: tuple[float, float],
    rows: int,
    time_lt: FloatArray,
    curves: Curves,
    times_lt: FloatArray,
    threshold: float,
    symbol: str,
    shaded: Mapping[str, Any] | None = None,
) -> tuple[Figure, Axes, np.ndarray[Any, Any]]:
    """Draw an observable with the times t_1, t_2, ... marked, above rows of empty planes.

    ``size``: Height of the figure in inches, and of the planes in heights of the panel.
    ``shaded``: Keywords of a span of time that is shaded. Returns the figure, the panel of the
    observable, and the panels of the planes, ``(rows, times)``.
    """
    figure = style.new_figure(style.DOUBLE_COLUMN, size[0])
    top, bottom = figure.subfigures(2, 1, squeeze=False, height_ratios=[1.0, size[1]])[:, 0]
    evolution: Axes = top.subplots()
    if shaded is not None:
        evolution.axvspan(**shaded)
    for observable, label, look in curves:
        evolution.plot(time_lt, observable, label=label, **look)
    frame.draw_threshold(evolution, threshold, f"${symbol}_e$", at_left=True)
    for index, time in enumerate(times_lt, start=1):
        evolution.axvline(float(time), color=style.BLUE, linewidth=0.8, linestyle=(0, (4.0, 1.5)))
        evolution.annotate(
            f"$t_{index}$",
            (float(time), 1),
            (0, 1.5),
            evolution.get_xaxis_transform(),
            "offset points",
            ha="center",
            va="bottom",
            color=style.BLUE,
        )
    evolution.set_xlim(float(time_lt[0]), float(time_lt[-1]))
    # room for the name of the threshold, however low the event is
    highest = float(np.nanmax([observable for observable, _, _ in curves]))
    evolution.set_ylim(0, 1.2 * max(threshold, highest))
    evolution.set_ylabel(frame.observable_label(symbol))
    evolution.set_title("(a)", loc="left")
    evolution.legend(loc="upper left")
    panels: np.ndarray[Any, Any] = bottom.subplots(rows, len(times_lt), squeeze=False)
    return figure, evolution, panels


def label_planes(panels: Any) -> None:
    """Name a grid of planes: times t_1, t_2, ... above it, rows (b), (c), ..., its outer axes."""
    for row, column in np.ndindex(panels.shape):
        axes = panels[row][column]
        axes.tick_params(labelleft=column == 0, labelbottom=row == len(panels) - 1)
        if row == 0:
            axes.set_title(f"$t_{column + 1}$", loc="center")
        if column == 0:
            axes.set_title(f"({chr(ord('b') + row)})", loc="left")
        if row == len(panels) - 1:
            axes.set_xlabel("$x$")


def add_row_bar(
    figure: Figure, mesh: QuadMesh, row: Sequence[Axes], label: str, ticks: int = 3
) -> None:
    """Draw one colour bar for a row of planes, with few round ticks."""
    bar = figure.colorbar(mesh, ax=list(row), pad=0.01, aspect=12, fraction=0.05)
    bar.ax.yaxis.set_major_locator(MaxNLocator(ticks))
    bar.set_label(label, labelpad=2)
