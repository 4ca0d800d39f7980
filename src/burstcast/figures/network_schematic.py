"""The echo state network with the sizes and hyperparameters of the example network; open loop and
closed loop.
"""

import math
from collections.abc import Mapping

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle, Polygon

from burstcast.base.declared import at, read
from burstcast.figures.parts import board, style
from burstcast.figures.registry import figure


@figure(section="networks", position=10, needs_networks=True)
def draw(
    *,
    inputs: int = at("case.space.dimension"),
    neurons: int = at("shown.example.name.neurons"),
    connectivity: float = at("forecasters.esn.connectivity"),
    input_bias: float = at("forecasters.esn.input_bias"),
    hyperparameters: Mapping[str, float] = read("example/hyperparameters.json"),
) -> Figure:
    """Draw (a) the network with its real sizes, (b) the open loop and (c) the closed loop."""
    figure = style.new_figure(style.DOUBLE_COLUMN, 4.1)
    whole, loops = figure.subfigures(2, 1, squeeze=False, height_ratios=[1.25, 1.0])[:, 0]
    network = whole.subplots()
    numbers = [
        rf"$d = {connectivity:g}$",
        rf"$\rho = {hyperparameters['spectral_radius']:.3g}$",
        rf"$\sigma_{{\mathrm{{in}}}} = {hyperparameters['input_scaling']:.3g}$",
        rf"$b_{{\mathrm{{in}}}} = {input_bias:g}$",
        rf"$\beta = 10^{{{math.log10(hyperparameters['tikhonov']):g}}}$",
    ]
    _draw_network(network, inputs, neurons, numbers)
    network.set_title("(a)", loc="left")
    open_loop, closed_loop = loops.subplots(1, 2)
    _draw_loop(open_loop, closed=False)
    open_loop.set_title("(b) Open loop: washout and training", loc="left")
    _draw_loop(closed_loop, closed=True)
    closed_loop.set_title("(c) Closed loop: validation and forecast", loc="left")
    return figure


def _draw_network(axes: Axes, inputs: int, neurons: int, parameters: list[str]) -> None:
    """Draw input layer, reservoir and output layer; units are a hundredth of the width."""
    board.clear(axes, 100, 34)
    heights = [27.0, 22.0, 9.0]
    for side, x, align, name in (
        (-1, 17.0, "right", r"$\hat{\mathbf{u}}_{\mathrm{in}}(t_i)$"),
        (1, 83.0, "left", r"$\mathbf{u}_{\mathrm{p}}(t_{i+1})$"),
    ):
        for height in heights:
            axes.add_patch(Circle((x, height), 1.6, facecolor="white", edgecolor="black", lw=0.8))
        axes.text(x, 15.7, r"$\vdots$", ha="center", va="center")
        if side < 0:
            bias = Circle((x, 4), 1.6, facecolor=style.LIGHT_GREY, edgecolor="black", lw=0.8)
            axes.add_patch(bias)
            axes.text(x - 3, 4, r"$b_{\mathrm{in}}$", ha="right", va="center")
        axes.text(x + 3 * side, 18.5, f"{name}\n$N_u = {inputs}$", ha=align, va="center")

    # A picture of a sparse random graph; its generator belongs to the picture, not to a result.
    generator = np.random.default_rng(7)
    angle = np.pi * (3.0 - np.sqrt(5.0)) * np.arange(26)
    radius = 11.5 * np.sqrt((np.arange(26) + 0.5) / 26)
    x, y = 50 + radius * np.cos(angle), 17 + radius * np.sin(angle)
    axes.add_patch(
        Circle((50, 17), 14.2, facecolor="#F3F3F3", edgecolor=style.GREY, lw=0.6, zorder=0.5)
    )
    for first in range(26):
        for second in generator.choice(26, 2, replace=False):
            axes.plot(x[[first, second]], y[[first, second]], color=style.GREY, lw=0.45, zorder=1)
    axes.scatter(x, y, s=16, facecolor="white", edgecolor=style.BLUE, linewidth=0.9, zorder=2)
    axes.text(50, 32.2, rf"reservoir, $N_r = {neurons}$", ha="center", va="bottom")

    left = np.argsort(x)[:8]
    for index, source in zip(left, [27, 22, 22, 9, 9, 27, 4, 4], strict=True):
        axes.plot([18.6, x[index] - 0.8], [source, y[index]], color=style.GREEN, lw=0.6, zorder=1)
    right = np.argsort(x)[-7:]
    for index in right:
        for height in heights:
            axes.plot(
                [x[index] + 0.8, 81.4],
                [y[index], height],
                color=style.VERMILLION,
                lw=0.35,
                zorder=1,
            )
    axes.text(27.5, 28.5, r"$\mathbf{W}_{\mathrm{in}}$", color=style.GREEN, ha="center")
    axes.text(38.5, 2.2, r"$\mathbf{W}$", color=style.BLUE, ha="center")
    axes.text(72.5, 28.5, r"$\mathbf{W}_{\mathrm{out}}$", color=style.VERMILLION, ha="center")
    axes.text(62.5, 0.2, r",$\;$ ".join(parameters), ha="left", va="bottom")


def _draw_loop(axes: Axes, *, closed: bool) -> None:
    """Draw three steps of the network: driven by data, or by its own output."""
    board.clear(axes, 100, 40)
    centres = (20.0, 52.0, 84.0)
    for step, x in enumerate(centres):
        before, index = (("i-1", "i"), ("i", "i+1"), ("i+1", "i+2"))[step]
        driven = not closed or step == 0
        source = r"\mathrm{in}" if driven else r"\mathrm{p}"
        name = rf"$\mathbf{{r}}(t_{{{index}}})$"
        board.box(axes, x, 20, (16, 8), name, 2, facecolor="#E6F0F7", edgecolor=style.BLUE, lw=0.9)
        axes.text(x, 3, rf"$\mathbf{{u}}_{{{source}}}(t_{{{before}}})$", ha="center", va="center")
        board.arrow(axes, (x, 6.5), (x, 16), style.GREEN if driven else style.VERMILLION, 1.0)
        axes.text(x, 36.5, rf"$\mathbf{{u}}_{{\mathrm{{p}}}}(t_{{{index}}})$", ha="center")
        board.arrow(axes, (x, 24), (x, 34.5), style.VERMILLION, 1.0)
        if step == 0:
            board.arrow(axes, (2, 20), (x - 8, 20), style.BLUE, 1.0)
        else:
            board.arrow(axes, (centres[step - 1] + 8, 20), (x - 8, 20), style.BLUE, 1.0)
        if closed and step:
            # The output, fed back: down between the columns and into the next input.
            middle = x - 16
            axes.plot(
                [centres[step - 1] + 8.5, middle, middle],
                [37.5, 37.5, 3],
                color=style.VERMILLION,
                lw=1.0,
                ls=(0, (3.5, 1.5)),
                zorder=0.8,
            )
            board.arrow(axes, (middle, 3), (x - 8.5, 3), style.VERMILLION, 1.0)
    axes.add_patch(Polygon([(92, 20), (99, 20)], closed=False, edgecolor=style.BLUE, lw=1.0))
