"""Mean square of the streamwise velocity in the midplane, and the errors in it."""

import numpy as np
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from burstcast.arrays import FloatArray
from burstcast.figures.parts.planes import draw_plane
from burstcast.figures.parts.style import DOUBLE_COLUMN, letter_panels, new_figure, styled


@styled
def midplane_mean_square(
    x: FloatArray,
    z: FloatArray,
    true: FloatArray,
    network: FloatArray,
    training: FloatArray,
    *,
    network_label: str = "echo state network",
) -> Figure:
    """Draw (a) the time average of u^2 in the data, (b) the network's error, (c) the training's.

    Parameters
    ----------
    x, z
        Coordinates in the plane, ``(points_x,)`` and ``(points_z,)``.
    true, network, training
        Time averages of u^2, ``(points_x, points_z)``.
    network_label
        What the network is called.
    """
    errors = [np.abs(network - true), np.abs(training - true)]
    figure = new_figure(DOUBLE_COLUMN, 2.15)
    panels = figure.subplots(1, 3, sharey=True)
    mean = draw_plane(panels[0], x, z, true, Normalize(0.0, float(true.max())), "viridis")
    # One scale for both errors: that they can be compared is the point.
    norm = Normalize(0.0, max(float(error.max()) for error in errors) or 1.0)
    for panel, error in zip(panels[1:], errors, strict=True):
        mesh = draw_plane(panel, x, z, error, norm, "inferno")
    for panel in panels:
        panel.set_xlabel("$x$")
    panels[0].set_ylabel("$z$")
    bar = figure.colorbar(mean, ax=panels[0], aspect=22, location="top", ticks=MaxNLocator(4))
    bar.set_label(r"$\overline{u^2}_{\mathrm{True}}$ [$U_0^2$]", labelpad=5)
    bar = figure.colorbar(
        mesh, ax=list(panels[1:]), aspect=46, location="top", ticks=MaxNLocator(5)
    )
    bar.set_label(
        r"$|\overline{u^2} - \overline{u^2}_{\mathrm{True}}|$ [$U_0^2$]: "
        f"(b) {network_label}, (c) training set",
        labelpad=5,
    )
    letter_panels(list(panels))
    for panel, error in zip(panels[1:], errors, strict=True):
        panel.set_title(f"max. {float(error.max()):.2g}", loc="right")
    return figure
