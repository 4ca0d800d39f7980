"""The validation strategies, drawn on the first training series."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Patch, Rectangle

from burstcast.arrays import FloatArray
from burstcast.figures.parts.observable_axis import axis_floor
from burstcast.figures.parts.style import (
    DOUBLE_COLUMN,
    GREY,
    LIGHT_GREY,
    TRUTH,
    draw_threshold,
    letter_panels,
    new_figure,
    observable_label,
    styled,
    validation_style,
)


@dataclass(frozen=True)
class ValidationLayout:
    """Where a strategy trains and validates in one series; all in Lyapunov times.

    Attributes
    ----------
    validation
        Short name of the strategy: "SSV", "RV".
    title
        Its name in full.
    washout, training
        Start and end of the washout and of the data used for training.
    intervals
        Start and end of each validation interval, ``(intervals, 2)``.
    """

    validation: str
    title: str
    washout: tuple[float, float]
    training: tuple[float, float]
    intervals: FloatArray


@styled
def validation_strategies(
    time_lt: FloatArray,
    observable: FloatArray,
    layouts: Sequence[ValidationLayout],
    threshold: float,
    *,
    symbol: str = "k",
) -> Figure:
    """Draw one panel per strategy: the signal, and below it what it is used for.

    The signal is drawn in the strategy's colour where the network is validated on it.

    Parameters
    ----------
    time_lt, observable
        Of the first training series, ``(time,)``.
    layouts
        The strategies.
    threshold
        Event threshold.
    symbol
        Of the observable.
    """
    figure = new_figure(DOUBLE_COLUMN, 1.55 * len(layouts) + 0.15)
    panels = figure.subplots(len(layouts), 1, sharex=True, squeeze=False)[:, 0]
    floor = axis_floor(observable)
    height = 1.12 * (float(observable.max()) - floor)
    top, row = floor + height, 0.15 * height
    for panel, layout in zip(panels, layouts, strict=True):
        colour = validation_style(layout.validation)["color"]
        panel.plot(time_lt, observable, **{**TRUTH, "linewidth": 0.7})
        for start, end in layout.intervals:
            inside = (time_lt >= start) & (time_lt <= end)
            panel.plot(time_lt[inside], observable[inside], color=colour, linewidth=1.4)
        draw_threshold(panel, threshold, f"${symbol}_e$")
        begin, finish = layout.training
        panel.add_patch(
            Rectangle(
                (begin, floor - row), finish - begin, 0.8 * row, facecolor=LIGHT_GREY, linewidth=0
            )
        )
        begin, finish = layout.washout
        panel.add_patch(
            Rectangle(
                (begin, floor - row),
                finish - begin,
                0.8 * row,
                facecolor="white",
                edgecolor=GREY,
                hatch="//////",
                linewidth=0.5,
            )
        )
        for index, (start, end) in enumerate(layout.intervals):
            panel.add_patch(
                Rectangle(
                    (start, floor - 2 * row),
                    end - start,
                    0.8 * row,
                    facecolor=colour,
                    # Neighbours alternate, so that intervals laid end to end can be told apart.
                    alpha=1.0 if index % 2 == 0 else 0.55,
                    linewidth=0,
                )
            )
        panel.axhline(floor, color="black", linewidth=0.6)
        panel.set_ylim(floor - 2.25 * row, top)
        panel.set_yticks([tick for tick in panel.get_yticks() if floor <= tick <= top])
        panel.set_ylabel(observable_label(symbol))
        count = len(layout.intervals)
        panel.legend(
            handles=[
                Patch(facecolor="white", edgecolor=GREY, hatch="//////", label="washout"),
                Patch(facecolor=LIGHT_GREY, label="training"),
                Patch(
                    facecolor=colour,
                    label=f"validation ({count} interval{'s' if count != 1 else ''})",
                ),
            ],
            ncols=3,
            loc="lower right",
            bbox_to_anchor=(1.0, 1.0),
            handlelength=1.4,
        )
    panels[-1].set_xlabel("Time [LT]")
    panels[-1].set_xlim(float(time_lt[0]), float(np.ceil(time_lt[-1])))
    letter_panels(list(panels))
    for index, (panel, layout) in enumerate(zip(panels, layouts, strict=True)):
        panel.set_title(f"({chr(ord('a') + index)}) {layout.title}", loc="left")
    return figure
