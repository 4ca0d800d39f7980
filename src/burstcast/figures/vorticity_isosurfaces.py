"""Isosurfaces of plus and minus one value of the streamwise vorticity, and velocity vectors, at
the peak of the event of the midplane figure and after its breakdown. The mean flow is along x,
sheared in y between the walls. Lengths are in units of h, half the distance of the walls,
velocities in units of U_0, the velocity of the laminar flow halfway between centre and wall.
"""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
import scipy
import skimage
from matplotlib.cm import ScalarMappable
from matplotlib.colors import LightSource, Normalize, to_rgb
from matplotlib.figure import Figure
from mpl_toolkits.mplot3d import Axes3D  # type: ignore[import-untyped]
from mpl_toolkits.mplot3d.art3d import (  # type: ignore[import-untyped]
    Line3DCollection,
    Poly3DCollection,
)

from burstcast.base.arrays import FloatArray, IntArray
from burstcast.base.declared import at, read
from burstcast.figures.parts import planes, style
from burstcast.figures.registry import figure
from burstcast.systems.flow_grid import make_flow_grid
from burstcast.systems.registry import make_system

_COLOURS = {1: style.VERMILLION, -1: style.BLUE}
_VELOCITY = "PRGn"
_OPACITY = 0.75
_ARROWS = 12
_LEVEL = 0.5  # of the isosurfaces, as a share of the largest vorticity
# of the event's four times: the peak, and when the laminar structure has broken down
_SHOWN = {2: "before", 3: "after"}


@figure(section="forecasts", position=60, only_flows=True, needs_networks=True)
def draw(
    *,
    event: Mapping[str, Any] = read("example/flow_event.nc"),
    system: str = at("case.system"),
    parameters: Mapping[str, float] = at("case.parameters"),
    flow_points: Sequence[int] = at("figures.flow_points"),
) -> Figure:
    """Draw the true flow at the event's peak and after its breakdown.

    The box has its physical proportions, the walls above and below. Colours on its far side and
    its left end are the velocity along x; vectors there are the velocity in these planes. Surfaces
    are closed where the box cuts them. Their level is relative to the largest vorticity.
    """
    if not event["mark"].size:
        return style.nothing_to_show("No isolated event occurred in the test set.")
    grid = make_flow_grid(make_system(system, parameters), flow_points)
    x, y, z = grid.x, grid.y, grid.z
    points = np.meshgrid(x, y, z, indexing="ij", sparse=True)
    states = [event["true_state"][time] for time in _SHOWN]
    velocities = [grid.modes.velocity(state, *points) for state in states]
    vorticities = [grid.modes.vorticity(state, *points)[0] for state in states]
    level = _LEVEL * max(float(np.abs(field).max()) for field in vorticities)
    streamwise = planes.symmetric_norm([velocity[0] for velocity in velocities])
    largest = max(float(np.sqrt((field**2).sum(axis=0)).max()) for field in velocities)
    figure = style.new_figure(style.DOUBLE_COLUMN, 2.35, layout=None)
    width = 1.0 / len(states)
    # Matplotlib draws in the largest square of the frame and cuts off the rest: the square is made
    # as wide as the panel, and higher than the figure.
    height = width * figure.get_figwidth() / figure.get_figheight()
    for index, (time, when) in enumerate(_SHOWN.items()):
        axes = figure.add_axes(
            (index * width, 0.5 - 0.5 * height, width, height),
            projection="3d",
            computed_zorder=False,
        )
        _draw_box(axes, x, y, z)
        _draw_velocity(axes, x, y, z, velocities[index][0], streamwise)
        _draw_vectors(axes, x, y, z, velocities[index], largest)
        _draw_surfaces(axes, x, y, z, vorticities[index], level)
        title = f"({chr(ord('a') + index)}) $t_{time + 1}$, {when} the breakdown"
        figure.text(index * width + 0.015, 0.97, title, va="top")
    figure.colorbar(
        ScalarMappable(streamwise, _VELOCITY),
        cax=figure.add_axes((0.36, 0.1, 0.28, 0.035)),
        orientation="horizontal",
        alpha=_OPACITY,
    )
    box = ", ".join(f"${name}/h$: {_extent(axis)}" for name, axis in (("x", x), ("y", y), ("z", z)))
    figure.text(0.985, 0.04, box, ha="right", va="center")
    figure.text(0.345, 0.1175, "Velocity along $x$, $u$ [$U_0$]", ha="right", va="center")
    signs = [1, -1] if any(field.min() < -level for field in vorticities) else [1]
    for place, sign in enumerate(signs):
        text = rf"Vorticity $\omega_x = {sign * level:.2g}\,U_0/h$"
        look: dict[str, Any] = {"color": _COLOURS[sign], "ha": "right", "va": "top"}
        figure.text(0.985, 0.97 - 0.085 * place, text, **look)
    return figure


def _draw_box(axes: Axes3D, x: FloatArray, y: FloatArray, z: FloatArray) -> None:
    """Set up the box: y points up, x to the right, z away from the viewer."""
    axes.set_proj_type("persp", focal_length=0.6)
    axes.view_init(elev=24, azim=-62)
    axes.set_xlim(x[0], x[-1])
    axes.set_ylim(z[0], z[-1])
    axes.set_zlim(y[0], y[-1])
    axes.set_box_aspect((float(np.ptp(x)), float(np.ptp(z)), float(np.ptp(y))), zoom=0.92)
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


def _extent(axis: FloatArray) -> str:
    """First and last value of an axis, for a text; multiples of pi as such."""
    ends = []
    for end in (float(axis[0]), float(axis[-1])):
        number = round(end / np.pi)
        is_multiple = number and np.isclose(end, number * np.pi)
        ends.append(rf"${number if number != 1 else ''}\pi$" if is_multiple else f"${end:.3g}$")
    return " to ".join(ends)


def _draw_velocity(
    axes: Axes3D, x: FloatArray, y: FloatArray, z: FloatArray, u: FloatArray, norm: Normalize
) -> None:
    """Colour the far side of the box and its left end by the velocity along x."""
    colours = ScalarMappable(norm, _VELOCITY)
    for plane, coordinates in (
        (u[:, :, -1], (x[:, np.newaxis], np.full((1, 1), z[-1]), y)),
        (u[0], (np.full((1, 1), x[0]), z, y[:, np.newaxis])),
    ):
        points = np.stack(np.broadcast_arrays(*coordinates), axis=-1)
        quads = np.stack(
            [points[:-1, :-1], points[1:, :-1], points[1:, 1:], points[:-1, 1:]], axis=2
        )
        middle = 0.25 * (plane[:-1, :-1] + plane[1:, :-1] + plane[1:, 1:] + plane[:-1, 1:])
        collection = Poly3DCollection(
            quads.reshape(-1, 4, 3),
            facecolors=_OPACITY * colours.to_rgba(middle.ravel())[:, :3] + 1.0 - _OPACITY,
            edgecolors="none",
            antialiased=False,
            rasterized=True,
            zorder=0.5,
        )
        axes.add_collection3d(collection)


def _draw_vectors(
    axes: Axes3D, x: FloatArray, y: FloatArray, z: FloatArray, velocity: FloatArray, largest: float
) -> None:
    """Draw the in-plane velocity on the far side of the box and on its left end."""
    scale = 1.1 * float(np.ptp(x)) / (_ARROWS * largest)

    def inner(axis: FloatArray, count: int) -> IntArray:
        """Give indices of evenly spaced points, away from the ends."""
        return np.round((np.arange(count) + 0.5) / count * (len(axis) - 1)).astype(np.int64)

    rows = inner(y, _ARROWS // 2)
    columns = inner(x, _ARROWS)
    along, up = np.meshgrid(x[columns], y[rows], indexing="ij")
    u, v = (velocity[i][:, :, -1][np.ix_(columns, rows)] * scale for i in (0, 1))
    _draw_arrows(axes, along, up, u, v, lambda p, q: (p, np.full_like(p, z[-1]), q))
    columns = inner(z, 2 * _ARROWS // 3)
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
    light = LightSource(azdeg=300, altdeg=50)
    triangles: list[FloatArray] = []
    colours: list[FloatArray] = []
    for sign, colour in _COLOURS.items():
        if not (sign * scalar).max() > level:
            continue
        corners, normal = _closed_surface(x, y, z, sign * scalar, level)
        triangles.append(corners[..., [0, 2, 1]])
        colours.append(_shade(normal[:, [0, 2, 1]], np.array(to_rgb(colour)), light))
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


def _closed_surface(
    x: FloatArray, y: FloatArray, z: FloatArray, scalar: FloatArray, level: float
) -> tuple[FloatArray, FloatArray]:
    """Surface of the region above the level, closed at the ends of the box.

    Returns corners of the triangles, ``(triangles, 3, 3)``, and their normals, ``(triangles, 3)``.
    """
    # So low beyond the box that the surface closes right at its ends.
    outside = level - 1e6 * (float(scalar.max()) - level)
    vertices, faces, _, _ = skimage.measure.marching_cubes(  # type: ignore[no-untyped-call]
        np.pad(scalar, 1, constant_values=outside), level
    )
    last = np.array(scalar.shape) - 1.0
    index: FloatArray = np.clip(vertices.astype(np.float64) - 1, 0, last)
    spacing = np.array([axis[1] - axis[0] for axis in (x, y, z)])
    # Smooth normals from the field itself, but flat ones where the box cuts the surface.
    parts: list[FloatArray] = list(np.gradient(scalar, *spacing.tolist()))
    gradient = [scipy.ndimage.map_coordinates(part, index.T, order=1) for part in parts]
    normal = -np.stack(gradient, axis=-1)[faces].mean(axis=1)
    for end, sign in ((np.zeros(3), -1.0), (last, 1.0)):
        on_end = (np.abs(index - end) < 1e-3)[faces].all(axis=1)
        for direction in range(3):
            normal[on_end[:, direction]] = sign * np.eye(3)[direction]
    corners: FloatArray = (index * spacing + np.array([x[0], y[0], z[0]]))[faces]
    return corners, normal


def _shade(normal: FloatArray, colour: FloatArray, light: LightSource) -> FloatArray:
    """Colours of faces under a lamp: ambient, diffuse and a highlight, ``(faces, 3)``."""
    length = np.linalg.norm(normal, axis=1, keepdims=True)
    towards = (normal / np.maximum(length, np.finfo(np.float64).tiny)) @ light.direction
    # Also what faces away from the lamp keeps its shape.
    diffuse = 0.5 * (1.0 + towards)
    highlight = np.maximum(towards, 0.0) ** 24
    shaded: FloatArray = colour * (0.35 + 0.65 * diffuse)[:, None] + 0.25 * highlight[:, None]
    return np.clip(shaded, 0.0, 1.0)
