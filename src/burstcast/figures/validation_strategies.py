"""Where each strategy trains and validates, on the first training series. The network sees the
data in open loop during washout and training, and forecasts in closed loop during validation.
"""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Patch, Rectangle

from burstcast.base.arrays import FloatArray
from burstcast.base.declared import at, read
from burstcast.base.durations import steps
from burstcast.figures.parts import frame, looks, style
from burstcast.figures.registry import figure
from burstcast.networks.validation_strategies.base import ValidationPlan, use_of_series
from burstcast.networks.validation_strategies.registry import make_strategy


@figure(section="networks", position=20, needs_networks=True)
def draw(
    *,
    observable: FloatArray = read("case/ensemble.nc:observable"),
    unit: int = read("case/time_unit.json:steps_per_lyapunov_time"),
    threshold: float = read("case/event_threshold.json:event_threshold"),
    strategies: Sequence[str] = at("shown.strategies"),
    recycle: Mapping[str, Any] = at("case.recycle_validation"),
    training_series: int = at("case.training.series"),
    washout_lt: float = at("washout_lt"),
    interval_lt: float = at("search.interval_lt"),
    symbol: str = at("case.space.observable_symbol"),
) -> Figure:
    """Draw one panel per strategy: the first (longest) series, and below it what it is used for.

    The signal is drawn in the strategy's colour where the network is validated on it.
    ``observable``: Of all series, ``(series, time)``. ``recycle``: Number of ``series`` and of
    ``intervals_per_series`` of recycle validation.
    """
    plan = ValidationPlan(
        washout=steps(washout_lt, unit),
        interval=steps(interval_lt, unit),
        series=recycle["series"],
        intervals=recycle["intervals_per_series"],
    )
    lengths = (~np.isnan(observable[:training_series])).sum(axis=1)
    first = observable[np.argmax(lengths), : lengths.max()]
    if lengths.min() < lengths.max():
        plan = plan.fitted_to(np.sort(lengths)[::-1].tolist())
    time_lt = np.arange(len(first)) / unit
    figure = style.new_figure(style.DOUBLE_COLUMN, 1.55 * len(strategies) + 0.15)
    panels = figure.subplots(len(strategies), 1, sharex=True, squeeze=False)[:, 0]
    floor, top = frame.axis_limits(threshold, first)
    row = 0.15 * (top - floor)
    for letter, panel, name in zip("abcdefgh", panels, strategies, strict=False):
        strategy = make_strategy(name)
        # how many more series there are changes nothing in the first one
        stop, starts = use_of_series(strategy.folds(plan, plan.series, len(first)), 0)
        intervals = [(start / unit, (start + plan.interval) / unit) for start in starts]
        colour = looks.validation(strategy.name)["color"]
        panel.plot(time_lt, first, **{**looks.TRUTH, "linewidth": 0.7})
        for start, end in intervals:
            inside = (time_lt >= start) & (time_lt <= end)
            panel.plot(time_lt[inside], first[inside], color=colour, linewidth=1.4)
        frame.draw_threshold(panel, threshold, f"${symbol}_e$")
        washout: dict[str, Any] = {"facecolor": "white", "edgecolor": style.GREY, "hatch": "//////"}
        training: dict[str, Any] = {"facecolor": style.LIGHT_GREY}
        begin = plan.washout / unit
        bars: list[tuple[float, float, int, dict[str, Any]]] = [
            (begin, stop / unit, 1, {**training, "linewidth": 0}),
            (0.0, begin, 1, {**washout, "linewidth": 0.5}),
        ]
        for index, (start, end) in enumerate(intervals):
            # Neighbours alternate, so that adjacent intervals are distinguishable.
            alpha = 1.0 if index % 2 == 0 else 0.55
            bars.append((start, end, 2, {"facecolor": colour, "alpha": alpha, "linewidth": 0}))
        for start, end, below, look in bars:
            panel.add_patch(Rectangle((start, floor - below * row), end - start, 0.8 * row, **look))
        panel.axhline(floor, color="black", linewidth=0.6)
        panel.set_ylim(floor - 2.25 * row, top)
        panel.set_yticks([tick for tick in panel.get_yticks() if floor <= tick <= top])
        panel.set_ylabel(frame.observable_label(symbol))
        label = f"validation ({len(intervals)} interval{'s' if len(intervals) != 1 else ''})"
        panel.legend(
            handles=[
                Patch(**washout, label="washout"),
                Patch(**training, label="training"),
                Patch(facecolor=colour, label=label),
            ],
            ncols=3,
            loc="lower right",
            bbox_to_anchor=(1.0, 1.0),
            handlelength=1.4,
        )
        panel.set_title(f"({letter}) {strategy.title}", loc="left")
    panels[-1].set_xlabel("Time [LT]")
    panels[-1].set_xlim(float(time_lt[0]), float(np.ceil(time_lt[-1])))
    return figure
