"""Isosurfaces of the vorticity and velocity vectors before and after an event."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from matplotlib.colors import LightSource, to_rgb
from matplotlib.figure import Figure
from mpl_toolkits.mplot3d import Axes3D  # type: ignore[import-untyped]
from mpl_toolkits.mplot3d.art3d import (  # type: ignore[import-untyped]
    Line3DCollection,
    Poly3DCollection,
)
from skimage.measure import marching_cubes

from burstcast.figures.style import BLUE, DOUBLE_COLUMN, VERMILLION, FloatArray, new_figure, styled

_COLOURS = {1: VERMILLION, -1: BLUE}


@dataclass(frozen=True)
class FlowSnapshot:
    """The flow in a box at one time, on a regular grid.

    Attributes
    ----------
    title
        Of the panel.
    velocity
        u, v, w: ``(3, points_x, points_y, points_z)``.
    scalar
        The field whose isosurfaces are drawn: ``(points_x, points_y, points_z)``.
    """

    title: str
    velocity: FloatArray
    scalar: FloatArray


@styled
def vorticity_isosurfaces(
    x: FloatArray,
    y: FloatArray,
    z: FloatArray,
    snapshots: Sequence[FlowSnapshot],
    level: float,
    *,
    scalar_label: str = r"\omega_x",
    arrows: int = 12,
) -> Figure:
    """Draw one panel per snapshot: surfaces of plus and minus the level, and the velocity.

    The box has its physical proportions, the walls above and below. Velocity vectors lie on the
    far side of the box (u and v) and on its left end (w and v).

    Parameters
    ----------
    x, y, z
        Coordinates, regular.
    snapshots
        The flow at several times, on one scale.
    level
        Of the isosurfaces; drawn where the scalar attains ``level`` and ``-level``.
    scalar_label
        The scalar in TeX without dollars.
    arrows
        Vectors along x.

    Raises
    ------
    ValueError
        If the level is not positive.
    """
    if not level > 0:
        raise ValueError(f"the level of an isosurface must be positive, not {level}")
    figure = new_figure(DOUBLE_COLUMN, 2.2, layout=None)
    largest = max(
        float(np.sqrt((snapshot.velocity**2).sum(axis=0)).max()) for snapshot in snapshots
    )
    width = 1.0 / len(snapshots)
    # Matplotlib draws in the largest square of the frame and cuts off the rest: the square is made
    # as wide as the panel, and higher than the figure.
    height = width * figure.get_figwidth() / figure.get_figheight()
    for index, snapshot in enumerate(snapshots):
        axes = figure.add_axes(
            (index * width, 0.47 - 0.5 * height, width, height),
            projection="3d",
            computed_zorder=False,
        )
        _draw_box(axes, x, y, z)
        _draw_vectors(axes, x, y, z, snapshot.velocity, largest, arrows)
        _draw_surfaces(axes, x, y, z, snapshot.scalar, level)
        letter = chr(ord("a") + index)
        figure.text(index * width + 0.015, 0.97, f"({letter}) {snapshot.title}", va="top")
    signs = [1, -1] if any(snapshot.scalar.min() < -level for snapshot in snapshots) else [1]
    for place, sign in enumerate(signs):
        figure.text(
            0.985,
            0.97 - 0.085 * place,
            rf"${scalar_label} = {sign * level:.2g}$",
            color=_COLOURS[sign],
            ha="right",
            va="top",
        )
    return figure


def _draw_box(axes: Axes3D, x: FloatArray, y: FloatArray, z: FloatArray) -> None:
    """Set up the box: y points up, x to the right, z away from the viewer."""
    axes.set_proj_type("persp", focal_length=0.6)
    axes.view_init(elev=24, azim=-62)
    axes.set_xlim(x[0], x[-1])
    axes.set_ylim(z[0], z[-1])
    axes.set_zlim(y[0], y[-1])
    axes.set_box_aspect((float(np.ptp(x)), float(np.ptp(z)), float(np.ptp(y))), zoom=0.84)
    axes.set_axis_off()
    corners = np.array([[i, j, k] for i in (0, -1) for j in (0, -1) for k in (0, -1)])
    for first in corners:
        for second in corners:
            if (first != second).sum() == 1 and tuple(first) < tuple(second):
                # The edges that meet in the nearest lower corner are in front of everything.
                near = all(np.all(end[:2] == (-1, 0)) or end[1] == 0 for end in (first, second))
                axes.plot(
                    x[[first[0], second[0]]],
                    z[[first[1], second[1]]],
                    y[[first[2], second[2]]],
                    color="0.25" if near else "0.6",
                    linewidth=0.7 if near else 0.5,
                    zorder=3 if near else 0,
                )
    middle = [0.5 * (axis[0] + axis[-1]) for axis in (x, y, z)]
    axes.text(middle[0], z[0], y[0] - 0.5, "$x$", ha="center", va="top")
    axes.text(x[-1] + 0.5, middle[2], y[0] - 0.4, "$z$", ha="left", va="top")
    axes.text(x[0] - 0.4, z[0], middle[1], "$y$", ha="right", va="center")


def _draw_vectors(
    axes: Axes3D,
    x: FloatArray,
    y: FloatArray,
    z: FloatArray,
    velocity: FloatArray,
    largest: float,
    arrows: int,
) -> None:
    """Draw the in-plane velocity on the far side of the box and on its left end."""
    scale = 1.1 * float(np.ptp(x)) / (arrows * largest)

    def inner(axis: FloatArray, count: int) -> npt.NDArray[np.int64]:
        """Give indices of evenly spaced points, away from the ends."""
        return np.round((np.arange(count) + 0.5) / count * (len(axis) - 1)).astype(np.int64)

    rows = inner(y, max(3, arrows // 2))
    columns = inner(x, arrows)
    along, up = np.meshgrid(x[columns], y[rows], indexing="ij")
    u, v = (velocity[i][:, :, -1][np.ix_(columns, rows)] * scale for i in (0, 1))
    _draw_arrows(axes, along, up, u, v, lambda p, q: (p, np.full_like(p, z[-1]), q))
    columns = inner(z, max(3, 2 * arrows // 3))
    along, up = np.meshgrid(z[columns], y[rows], indexing="ij")
    w, v = (velocity[i][0][np.ix_(rows, columns)].T * scale for i in (2, 1))
    _draw_arrows(axes, along, up, w, v, lambda p, q: (np.full_like(p, x[0]), p, q))


def _draw_arrows(
    axes: Axes3D,
    along: FloatArray,
    up: FloatArray,
    du: FloatArray,
    dv: FloatArray,
    place: Callable[[FloatArray, FloatArray], tuple[FloatArray, FloatArray, FloatArray]],
) -> None:
    """Draw arrows that lie in a plane, heads included; ``place`` puts the plane into the box."""
    tip = np.stack([along + 0.5 * du, up + 0.5 * dv])
    tail = np.stack([along - 0.5 * du, up - 0.5 * dv])
    back = 0.3 * (tail - tip)
    side = 0.5 * np.stack([-back[1], back[0]])
    strokes = np.stack([tail, tip, tip + back + side, tip, tip + back - side])
    points = np.stack(place(strokes[:, 0], strokes[:, 1]), axis=-1)
    lines = points.reshape(5, -1, 3).transpose(1, 0, 2)
    axes.add_collection3d(Line3DCollection(lines, colors="0.3", linewidths=0.55, zorder=1))


def _draw_surfaces(
    axes: Axes3D, x: FloatArray, y: FloatArray, z: FloatArray, scalar: FloatArray, level: float
) -> None:
    """Draw both isosurfaces as one collection, so that faces hide each other correctly."""
    spacing = tuple(float(axis[1] - axis[0]) for axis in (x, y, z))
    origin = np.array([x[0], y[0], z[0]])
    light = LightSource(azdeg=300, altdeg=50)
    triangles: list[FloatArray] = []
    colours: list[FloatArray] = []
    for sign, colour in _COLOURS.items():
        if not (sign * scalar).max() > level:
            continue
        vertices, faces, normals, _ = marching_cubes(  # type: ignore[no-untyped-call]
            sign * scalar, level, spacing=spacing, gradient_direction="descent"
        )
        corners: npt.NDArray[np.float64] = (vertices + origin)[:, [0, 2, 1]][faces]
        normal = normals[:, [0, 2, 1]][faces].mean(axis=1)
        triangles.append(corners)
        colours.append(_shade(normal, np.array(to_rgb(colour)), light))
    if triangles:
        collection = Poly3DCollection(
            np.concatenate(triangles),
            facecolors=np.concatenate(colours),
            edgecolors="none",
            antialiased=False,
            rasterized=True,
            zorder=2,
        )
        axes.add_collection3d(collection)


def _shade(normal: FloatArray, colour: FloatArray, light: LightSource) -> FloatArray:
    """Colours of faces under a lamp: ambient, diffuse and a highlight, ``(faces, 3)``."""
    normal = normal / np.linalg.norm(normal, axis=1, keepdims=True)
    # Both sides of a surface are lit: the box cuts surfaces open.
    diffuse = np.abs(normal @ light.direction)
    shaded: FloatArray = colour * (0.42 + 0.58 * diffuse)[:, None] + 0.25 * diffuse[:, None] ** 24
    return np.clip(shaded, 0.0, 1.0)
