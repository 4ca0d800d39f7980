"""Where each strategy trains and validates, on the first training series. The network sees the
data in open loop during washout and training, and forecasts in closed loop during validation.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Patch, Rectangle

from burstcast.arrays import FloatArray
from burstcast.durations import steps
from burstcast.figures.parts.observable_axis import axis_limits
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
from burstcast.figures.parts.time_axis import samples_per_lyapunov_time
from burstcast.figures.registry import Declaration
from burstcast.tuning.strategies.base import ValidationPlan, use_of_series
from burstcast.tuning.strategies.registry import make_strategy

FIGURE = Declaration(
    section="networks",
    position=20,
    inputs={"observable": "case/ensemble.nc:observable", "exponents": "time_unit"},
    settings={
        "time_step": "case.ensemble.time_step",
        "sampling_stride": "case.ensemble.sampling_stride",
        "published_exponent": "case.lyapunov.published_exponent",
        "threshold": "case.event_threshold",
        "strategies": "shown.strategies",
        "recycle": "case.recycle_validation",
        "washout_lt": "washout_lt",
        "interval_lt": "search.interval_lt",
        "symbol": "shown.symbol",
    },
)


@dataclass(frozen=True)
class ValidationLayout:
    """Training and validation intervals of a strategy in one series, in Lyapunov times."""

    validation: str  #: short name of the strategy: "SSV", "RV"
    title: str
    #: washout, training: start and end of the washout and of the data used for training
    washout: tuple[float, float]
    training: tuple[float, float]
    intervals: FloatArray  #: start and end of each validation interval, ``(intervals, 2)``


def draw(
    *,
    observable: FloatArray,
    exponents: Mapping[str, Any] | None,
    time_step: float,
    sampling_stride: int,
    published_exponent: float,
    threshold: float,
    strategies: Sequence[str],
    recycle: Mapping[str, Any],
    washout_lt: float,
    interval_lt: float,
    symbol: str,
) -> Figure:
    """Draw where each strategy trains and validates, on the first series.

    ``observable``: Observable of all series, ``(series, time)``. ``recycle``: Number of ``series``
    and of ``intervals_per_series`` of recycle validation. ``washout_lt``, ``interval_lt``: Lengths
    of the washout and of a validation interval.
    """
    unit = samples_per_lyapunov_time(exponents, published_exponent, time_step, sampling_stride)
    plan = ValidationPlan(
        washout=steps(washout_lt, unit),
        interval=steps(interval_lt, unit),
        series=recycle["series"],
        intervals=recycle["intervals_per_series"],
    )
    first = observable[0]
    layouts = []
    for strategy in map(make_strategy, strategies):
        # how many more series there are changes nothing in the first one
        folds = strategy.folds(plan, plan.series, len(first))
        stop, starts = use_of_series(folds, 0)
        layouts.append(
            ValidationLayout(
                validation=strategy.name,
                title=strategy.title,
                washout=(0.0, plan.washout / unit),
                training=(plan.washout / unit, stop / unit),
                intervals=np.array([(start, start + plan.interval) for start in starts]) / unit,
            )
        )
    return validation_strategies(
        np.arange(len(first)) / unit, first, layouts, threshold, symbol=symbol
    )


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

    ``time_lt``, ``observable``: Time and observable of the first training series, ``(time,)``.
    """
    figure = new_figure(DOUBLE_COLUMN, 1.55 * len(layouts) + 0.15)
    panels = figure.subplots(len(layouts), 1, sharex=True, squeeze=False)[:, 0]
    floor, top = axis_limits(threshold, observable)
    row = 0.15 * (top - floor)
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
                    # Neighbours alternate, so that adjacent intervals are distinguishable.
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
