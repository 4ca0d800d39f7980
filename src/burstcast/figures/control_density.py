"""Density of the observable with and without control, at each Reynolds number."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from matplotlib.figure import Figure

from burstcast.arrays import FloatArray
from burstcast.figures.parts.style import (
    BLUE,
    DOUBLE_COLUMN,
    PURPLE,
    SINGLE_COLUMN,
    THRESHOLD,
    TRUTH,
    VERMILLION,
    legend_above,
    new_figure,
    observable_label,
    styled,
)


@dataclass(frozen=True)
class ControlledDensity:
    """Densities of one case.

    Attributes
    ----------
    title
        Of the panel: "Re = 400".
    bin_edges
        ``(bins + 1,)``.
    threshold
        Event threshold.
    uncontrolled
        Density without control, ``(bins,)``.
    controlled
        Density with control by prediction time in Lyapunov times, ``(bins,)`` each.
    bands
        Quartiles over networks of those densities, ``(2, bins)`` each.
    """

    title: str
    bin_edges: FloatArray
    threshold: float
    uncontrolled: FloatArray
    controlled: Mapping[float, FloatArray]
    bands: Mapping[float, FloatArray] = field(default_factory=dict)


@styled
def control_density(
    cases: Sequence[ControlledDensity],
    *,
    symbol: str = "k",
    name: str = "kinetic energy",
) -> Figure:
    """Draw one panel per case, two beside each other, on logarithmic scale.

    Parameters
    ----------
    cases
        At least one.
    symbol, name
        Of the observable.

    Raises
    ------
    ValueError
        If there is no case, or no density is positive anywhere.
    """
    if not cases:
        raise ValueError("there is no case to draw")
    positive = [
        float(value)
        for case in cases
        for density in (case.uncontrolled, *case.controlled.values())
        for value in density[density > 0]
    ]
    if not positive:
        raise ValueError("no density is positive anywhere")
    # where no axis reaches: a density of zero has no logarithm
    lowest = 0.5 * min(positive)
    columns = min(2, len(cases))
    rows = (len(cases) + columns - 1) // columns
    figure = new_figure(DOUBLE_COLUMN if columns == 2 else SINGLE_COLUMN, 1.75 * rows + 0.5)
    panels = figure.subplots(rows, columns, sharex=True, sharey=True, squeeze=False).ravel()
    times = sorted({time for case in cases for time in case.controlled})
    colours = [BLUE, VERMILLION, PURPLE]
    dashes = [(0.0, (3.5, 1.2)), (0.0, (1.0, 1.0)), (0.0, (6.0, 1.5, 1.0, 1.5))]
    for index, (panel, case) in enumerate(zip(panels, cases, strict=False)):
        panel.stairs(
            case.uncontrolled,
            case.bin_edges,
            baseline=None,
            color=TRUTH["color"],
            linewidth=TRUTH["linewidth"],
            label="without control",
        )
        for time, (low, high) in sorted(case.bands.items()):
            panel.stairs(
                high,
                case.bin_edges,
                baseline=np.maximum(low, lowest),
                fill=True,
                color=colours[times.index(time) % len(colours)],
                alpha=0.2,
                linewidth=0,
            )
        for time, density in sorted(case.controlled.items()):
            panel.stairs(
                density,
                case.bin_edges,
                baseline=None,
                color=colours[times.index(time) % len(colours)],
                linestyle=dashes[times.index(time) % len(dashes)],
                linewidth=1.2,
                label=f"control, PT = {time:g} LT",
            )
        panel.axvline(case.threshold, **THRESHOLD)
        panel.annotate(
            f"${symbol}_e$",
            (case.threshold, 1),
            (2.5, -3),
            panel.get_xaxis_transform(),
            "offset points",
            ha="left",
            va="top",
            color=THRESHOLD["color"],
        )
        panel.set_title(f"({chr(ord('a') + index)}) {case.title}", loc="left")
        if index + columns >= len(cases):
            panel.set_xlabel(observable_label(symbol, name))
            panel.xaxis.set_tick_params(labelbottom=True)
    for panel in panels[len(cases) :]:
        panel.set_axis_off()
    for panel in panels[::columns]:
        panel.set_ylabel("PDF")
    panels[0].set_yscale("log")
    panels[0].set_ylim(0.6 * min(positive), 3 * max(positive))
    panels[0].set_xlim(
        min(float(case.bin_edges[0]) for case in cases),
        max(float(case.bin_edges[-1]) for case in cases),
    )
    if columns == 2:
        legend_above(figure, panels[: len(cases)])
    else:
        panels[0].legend(loc="upper right")
    return figure
