"""The echo state network with the sizes and hyperparameters of the example network; open loop and
closed loop.
"""

import math
from collections.abc import Mapping

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle, FancyBboxPatch, Polygon

from burstcast.figures.parts.style import (
    BLUE,
    DOUBLE_COLUMN,
    GREEN,
    GREY,
    LIGHT_GREY,
    VERMILLION,
    new_figure,
    styled,
)
from burstcast.figures.registry import Declaration

FIGURE = Declaration(
    section="networks",
    position=10,
    inputs={"hyperparameters": "example_hyperparameters"},
    settings={
        "inputs": "shown.dimension",
        "neurons": "shown.neurons",
        "connectivity": "forecasters.esn.connectivity",
        "input_bias": "forecasters.esn.input_bias",
    },
)


@styled
def draw(
    *,
    inputs: int,
    neurons: int,
    connectivity: float,
    input_bias: float,
    hyperparameters: Mapping[str, float],
) -> Figure:
    """Draw (a) the network with its real sizes, (b) the open loop and (c) the closed loop.

    ``hyperparameters``: Its ``spectral_radius``, ``input_scaling`` and ``tikhonov``: rho, sigma_in
    and beta.
    """
    figure = new_figure(DOUBLE_COLUMN, 4.1)
    whole, loops = figure.subfigures(2, 1, squeeze=False, height_ratios=[1.25, 1.0])[:, 0]
    network = whole.subplots()
    _draw_network(
        network,
        inputs,
        neurons,
        [
            rf"$d = {connectivity:g}$",
            rf"$\rho = {hyperparameters['spectral_radius']:.3g}$",
            rf"$\sigma_{{\mathrm{{in}}}} = {hyperparameters['input_scaling']:.3g}$",
            rf"$b_{{\mathrm{{in}}}} = {input_bias:g}$",
            rf"$\beta = 10^{{{math.log10(hyperparameters['tikhonov']):g}}}$",
        ],
    )
    network.set_title("(a)", loc="left")
    open_loop, closed_loop = loops.subplots(1, 2)
    _draw_loop(open_loop, closed=False)
    open_loop.set_title("(b) Open loop: washout and training", loc="left")
    _draw_loop(closed_loop, closed=True)
    closed_loop.set_title("(c) Closed loop: validation and forecast", loc="left")
    return figure


def _arrow(
    axes: Axes,
    start: tuple[float, float],
    end: tuple[float, float],
    colour: str,
    connection: str = "arc3",
) -> None:
    """Draw an arrow between two points in data coordinates."""
    axes.annotate(
        "",
        end,
        start,
        arrowprops={
            "arrowstyle": "-|>",
            "color": colour,
            "linewidth": 1.0,
            "shrinkA": 0,
            "shrinkB": 0,
            "mutation_scale": 8,
            "connectionstyle": connection,
        },
    )


def _empty(axes: Axes, width: float, height: float) -> None:
    """Set up a drawing board of the given size with equal units."""
    axes.set_xlim(0, width)
    axes.set_ylim(0, height)
    axes.set_aspect("equal")
    axes.set_axis_off()


def _draw_network(axes: Axes, inputs: int, neurons: int, parameters: list[str]) -> None:
    """Draw input layer, reservoir and output layer; units are a hundredth of the width."""
    _empty(axes, 100, 34)
    heights = [27.0, 22.0, 9.0]
    for side, x in (("in", 17.0), ("out", 83.0)):
        for height in heights:
            axes.add_patch(Circle((x, height), 1.6, facecolor="white", edgecolor="black", lw=0.8))
        axes.text(x, 15.7, r"$\vdots$", ha="center", va="center")
        if side == "in":
            axes.add_patch(Circle((x, 4), 1.6, facecolor=LIGHT_GREY, edgecolor="black", lw=0.8))
            axes.text(x - 3, 4, r"$b_{\mathrm{in}}$", ha="right", va="center")
            axes.text(
                x - 3,
                18.5,
                r"$\hat{\mathbf{u}}_{\mathrm{in}}(t_i)$" + f"\n$N_u = {inputs}$",
                ha="right",
                va="center",
            )
        else:
            axes.text(
                x + 3,
                18.5,
                r"$\mathbf{u}_{\mathrm{p}}(t_{i+1})$" + f"\n$N_u = {inputs}$",
                ha="left",
                va="center",
            )

    # A picture of a sparse random graph; its generator belongs to the picture, not to a result.
    generator = np.random.default_rng(7)
    angle = np.pi * (3.0 - np.sqrt(5.0)) * np.arange(26)
    radius = 11.5 * np.sqrt((np.arange(26) + 0.5) / 26)
    x, y = 50 + radius * np.cos(angle), 17 + radius * np.sin(angle)
    axes.add_patch(Circle((50, 17), 14.2, facecolor="#F3F3F3", edgecolor=GREY, lw=0.6, zorder=0.5))
    for first in range(26):
        for second in generator.choice(26, 2, replace=False):
            axes.plot(x[[first, second]], y[[first, second]], color=GREY, lw=0.45, zorder=1)
    axes.scatter(x, y, s=16, facecolor="white", edgecolor=BLUE, linewidth=0.9, zorder=2)
    axes.text(50, 32.2, rf"reservoir, $N_r = {neurons}$", ha="center", va="bottom")

    left = np.argsort(x)[:8]
    for index, source in zip(left, [27, 22, 22, 9, 9, 27, 4, 4], strict=True):
        axes.plot([18.6, x[index] - 0.8], [source, y[index]], color=GREEN, lw=0.6, zorder=1)
    right = np.argsort(x)[-7:]
    for index in right:
        for height in heights:
            axes.plot(
                [x[index] + 0.8, 81.4], [y[index], height], color=VERMILLION, lw=0.35, zorder=1
            )
    axes.text(27.5, 28.5, r"$\mathbf{W}_{\mathrm{in}}$", color=GREEN, ha="center")
    axes.text(38.5, 2.2, r"$\mathbf{W}$", color=BLUE, ha="center")
    axes.text(72.5, 28.5, r"$\mathbf{W}_{\mathrm{out}}$", color=VERMILLION, ha="center")
    axes.text(62.5, 0.2, r",$\;$ ".join(parameters), ha="left", va="bottom")


def _draw_loop(axes: Axes, *, closed: bool) -> None:
    """Draw three steps of the network: driven by data, or by its own output."""
    _empty(axes, 100, 40)
    centres = (20.0, 52.0, 84.0)
    for step, x in enumerate(centres):
        index = "i" if step == 0 else f"i+{step}"
        driven = not closed or step == 0
        source = r"\mathrm{in}" if driven else r"\mathrm{p}"
        axes.add_patch(
            FancyBboxPatch(
                (x - 8, 16),
                16,
                8,
                boxstyle="round,pad=0,rounding_size=2",
                facecolor="#E6F0F7",
                edgecolor=BLUE,
                lw=0.9,
            )
        )
        axes.text(x, 20, rf"$\mathbf{{r}}(t_{{{index}}})$", ha="center", va="center")
        before = "i-1" if step == 0 else ("i" if step == 1 else f"i+{step - 1}")
        axes.text(x, 3, rf"$\mathbf{{u}}_{{{source}}}(t_{{{before}}})$", ha="center", va="center")
        _arrow(axes, (x, 6.5), (x, 16), GREEN if driven else VERMILLION)
        axes.text(x, 36.5, rf"$\mathbf{{u}}_{{\mathrm{{p}}}}(t_{{{index}}})$", ha="center")
        _arrow(axes, (x, 24), (x, 34.5), VERMILLION)
        if step == 0:
            _arrow(axes, (2, 20), (x - 8, 20), BLUE)
        else:
            _arrow(axes, (centres[step - 1] + 8, 20), (x - 8, 20), BLUE)
        if closed and step:
            # The output, fed back: down between the columns and into the next input.
            middle = x - 16
            axes.plot(
                [centres[step - 1] + 8.5, middle, middle],
                [37.5, 37.5, 3],
                color=VERMILLION,
                lw=1.0,
                ls=(0, (3.5, 1.5)),
                zorder=0.8,
            )
            _arrow(axes, (middle, 3), (x - 8.5, 3), VERMILLION)
    axes.add_patch(Polygon([(92, 20), (99, 20)], closed=False, edgecolor=BLUE, lw=1.0))
