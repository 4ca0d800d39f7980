"""Colour maps of a quantity over a plane of the flow, and the marks of their times."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import QuadMesh
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from burstcast.figures.style import BLUE, FloatArray


def draw_plane(
    axes: Axes, x: FloatArray, z: FloatArray, values: FloatArray, norm: Normalize, colours: str
) -> QuadMesh:
    """Draw values over the plane, in its physical proportions.

    Parameters
    ----------
    axes
        Where to draw.
    x, z
        Coordinates, ``(points_x,)`` and ``(points_z,)``.
    values
        ``(points_x, points_z)``.
    norm, colours
        Scale and name of the colour map.
    """
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


def label_outer_planes(planes: np.ndarray[tuple[int, int], np.dtype[np.object_]]) -> None:
    """Leave tick labels and axis labels at the left and the bottom of a grid of planes only."""
    rows, columns = planes.shape
    for row in range(rows):
        for column in range(columns):
            axes: Axes = planes[row, column]
            axes.tick_params(labelleft=column == 0, labelbottom=row == rows - 1)
            if row == rows - 1:
                axes.set_xlabel("$x$")


def mark_times(axes: Axes, times: FloatArray) -> None:
    """Draw vertical lines at the times t_1, t_2, ... and name them above the frame."""
    for index, time in enumerate(times, start=1):
        axes.axvline(float(time), color=BLUE, linewidth=0.8, linestyle=(0, (4.0, 1.5)))
        axes.annotate(
            f"$t_{index}$",
            (float(time), 1),
            (0, 1.5),
            axes.get_xaxis_transform(),
            "offset points",
            ha="center",
            va="bottom",
            color=BLUE,
        )


def add_row_bar(
    figure: Figure, mesh: QuadMesh, row: Sequence[Axes], label: str, ticks: int = 3
) -> None:
    """Draw one colour bar for a row of planes, with few round ticks."""
    bar = figure.colorbar(mesh, ax=list(row), pad=0.01, aspect=12, fraction=0.05)
    bar.ax.yaxis.set_major_locator(MaxNLocator(ticks))
    bar.set_label(label, labelpad=2)
