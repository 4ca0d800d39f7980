"""The last evaluations of the example network before an event is predicted: the forecast starts
ever later until it stays within the tolerance up to the event.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

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

FIGURE = Declaration(
    section="horizon",
    position=20,
    inputs={"examples": "example/examples.nc"},
    settings={
        "threshold": "case.event_threshold",
        "washout_lt": "washout_lt",
        "symbol": "shown.symbol",
    },
)


@dataclass(frozen=True)
class HorizonEvaluation:
    """One forecast of an event, started at a given time before it."""

    lead_time_lt: float  #: tau_e: how long before the event the forecast starts
    #: time from the event, ``(time,)``; the forecast starts at ``-lead_time_lt``
    time_lt: FloatArray
    forecast: FloatArray  #: observable, ``(time,)``
    horizon_lt: float  #: prediction horizon of this forecast


def draw(
    *, examples: Mapping[str, Any], threshold: float, washout_lt: float, symbol: str
) -> Figure:
    """Draw the forecasts of the example event."""
    time_lt = examples["evaluation_time_lt"]
    evaluations = [
        HorizonEvaluation(
            float(lead_time),
            time_lt,
            examples["evaluation_forecast"][number],
            float(examples["evaluation_horizon_lt"][number]),
        )
        for number, lead_time in enumerate(examples["evaluation_lead_time_lt"])
    ]
    if not evaluations:
        return nothing_to_show("No event was predicted from any start.")
    shown = time_lt >= -evaluations[0].lead_time_lt - washout_lt
    return horizon_evaluations(
        time_lt[shown],
        examples["evaluation_truth"][shown],
        evaluations,
        threshold,
        float(examples["allowed_error"]),
        symbol=symbol,
    )


@styled
def horizon_evaluations(
    time_lt: FloatArray,
    true: FloatArray,
    evaluations: Sequence[HorizonEvaluation],
    threshold: float,
    allowed_error: float,
    *,
    symbol: str = "k",
) -> Figure:
    """Draw one panel per evaluation, two by two: truth, tolerance band and forecast.

    ``time_lt``, ``true``: Observable around the event, ``(time,)``; the event is at time 0. NaN
    beyond the end of the series. ``allowed_error``: Half-width of the band that the forecast must
    stay in, in units of the observable: the tolerance times (threshold - mean).
    """
    if not evaluations:
        raise ValueError("there is no evaluation to draw")
    rows = (len(evaluations) + 1) // 2
    figure = new_figure(DOUBLE_COLUMN, 1.5 * rows + 0.5)
    panels = figure.subplots(rows, 2, sharex=True, sharey=True, squeeze=False).ravel()
    for index, (panel, evaluation) in enumerate(zip(panels, evaluations, strict=False)):
        panel.fill_between(
            time_lt,
            true - allowed_error,
            true + allowed_error,
            color=LIGHT_GREY,
            linewidth=0,
            label="tolerance",
        )
        panel.plot(time_lt, true, label=rf"${symbol}_{{\mathrm{{True}}}}$", **TRUTH)
        panel.plot(
            evaluation.time_lt,
            evaluation.forecast,
            label=rf"${symbol}_{{\mathrm{{ESN}}}}$",
            **NETWORK,
        )
        draw_threshold(panel, threshold, f"${symbol}_e$", at_left=True)
        panel.axvline(0, **WINDOW)
        panel.axvline(
            -evaluation.lead_time_lt, color=NETWORK["color"], linewidth=0.6, linestyle=":"
        )
        predicted = evaluation.horizon_lt >= evaluation.lead_time_lt
        verdict = (
            r"PH $\geq \tau_e$: predicted"
            if predicted
            else rf"PH = {evaluation.horizon_lt:.1f} LT $< \tau_e$"
        )
        panel.set_title(
            rf"({chr(ord('a') + index)}) $\tau_e$ = {evaluation.lead_time_lt:g} LT, {verdict}",
            loc="left",
        )
        if not predicted:
            panel.plot(
                evaluation.horizon_lt - evaluation.lead_time_lt,
                _value_at(evaluation, evaluation.horizon_lt - evaluation.lead_time_lt),
                marker="x",
                color="black",
                markersize=5,
                zorder=4,
            )
    for panel in panels[len(evaluations) :]:
        panel.set_axis_off()
    panels[0].set_xlim(float(time_lt[0]), float(time_lt[-1]))
    floor, top = axis_limits(threshold, true, true + allowed_error)
    panels[0].set_ylim(floor - (allowed_error if floor else 0.0), top)
    for panel in panels[: len(evaluations)][-2:]:
        panel.set_xlabel(r"$t - t^{(e)}$ [LT]")
        panel.xaxis.set_tick_params(labelbottom=True)
    for panel in panels[::2]:
        panel.set_ylabel(observable_label(symbol))
    legend_above(figure, [panels[0]])
    return figure


def _value_at(evaluation: HorizonEvaluation, time_lt: float) -> float:
    """Forecast at the sample nearest to the given time."""
    return float(evaluation.forecast[abs(evaluation.time_lt - time_lt).argmin()])
