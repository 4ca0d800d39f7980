"""Forecasts of the example network with each outcome. Of all forecasts with an outcome, the one
is shown whose burst has the median height; misses and false alarms that are more than an error of
timing come first.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from burstcast.arrays import FloatArray
from burstcast.figures.parts.nothing_to_show import nothing_to_show
from burstcast.figures.parts.observable_axis import axis_limits
from burstcast.figures.parts.style import (
    DOUBLE_COLUMN,
    LIGHT_GREY,
    NETWORK,
    TRUTH,
    WINDOW,
    draw_threshold,
    legend_above,
    new_figure,
    observable_label,
    styled,
)
from burstcast.figures.registry import Declaration
from burstcast.forecast.examples import OUTCOMES

FIGURE = Declaration(
    section="forecasts",
    position=20,
    inputs={"examples": "example/examples.nc"},
    settings={
        "threshold": "case.event_threshold",
        "prediction_time_lt": "figures.example_prediction_time_lt",
        "window_lt": "classification.window_lt",
        "symbol": "shown.symbol",
    },
)


@dataclass(frozen=True)
class PredictionExample:
    """One forecast beside the truth."""

    outcome: str  #: "true positive", "false positive" or "false negative"
    time_lt: FloatArray  #: ``(time,)``; the forecast starts at 0
    #: true, forecast: observable, ``(time,)``; NaN where there is none: before the forecast, or
    #: where the series has not begun
    true: FloatArray
    forecast: FloatArray


def draw(
    *,
    examples: Mapping[str, Any],
    threshold: float,
    prediction_time_lt: float,
    window_lt: float,
    symbol: str,
) -> Figure:
    """Draw the outcomes that occurred."""
    shown = [
        PredictionExample(
            OUTCOMES[outcome],
            examples["example_time_lt"],
            examples["example_truth"][number],
            examples["example_forecast"][number],
        )
        for number, outcome in enumerate(examples["outcome"])
    ]
    if not shown:
        return nothing_to_show("No event occurred in the test set, and none was predicted.")
    return prediction_examples(
        shown, threshold, prediction_time_lt, window_lt=window_lt, symbol=symbol
    )


@styled
def prediction_examples(
    examples: Sequence[PredictionExample],
    threshold: float,
    prediction_time_lt: float,
    *,
    window_lt: float = 1.0,
    symbol: str = "k",
) -> Figure:
    """Draw one panel per example, with the threshold and the window that is classified.

    ``examples``: At least one; an outcome that never happened is left out.
    """
    if not examples:
        raise ValueError("there is no example to draw")
    figure = new_figure(DOUBLE_COLUMN if len(examples) > 1 else DOUBLE_COLUMN / 2, 2.0)
    panels = figure.subplots(1, len(examples), sharey=True, squeeze=False)[0]
    for index, (panel, example) in enumerate(zip(panels, examples, strict=True)):
        window = (prediction_time_lt, prediction_time_lt + window_lt)
        panel.axvspan(*window, color=LIGHT_GREY, alpha=0.55, linewidth=0, zorder=0.5)
        for edge in window:
            panel.axvline(edge, **WINDOW)
        draw_threshold(panel, threshold, f"${symbol}_e$", at_left=True)
        panel.plot(example.time_lt, example.true, label=rf"${symbol}_{{\mathrm{{True}}}}$", **TRUTH)
        panel.plot(
            example.time_lt, example.forecast, label=rf"${symbol}_{{\mathrm{{ESN}}}}$", **NETWORK
        )
        panel.set_xlim(example.time_lt[0], example.time_lt[-1])
        panel.set_xlabel("Time [LT]")
        panel.set_title(f"({chr(ord('a') + index)}) {example.outcome}", loc="left")
    shown = np.concatenate([[*example.true, *example.forecast] for example in examples])
    panels[0].set_ylim(axis_limits(threshold, shown))
    panels[0].set_ylabel(observable_label(symbol))
    legend_above(figure, panels)
    return figure
