"""Forecast of an event of a plane flow beside the truth: (a) the observable, with the event
threshold and the times of the fields; the forecast starts at time 0. Then the true vorticity
(middle) and the forecast one (bottom) at these times: the last calm moment, the rise, the peak and
the end. Forecast fields are decoded from the forecaster's channels, sensor readings or modes.
All fields share one colour scale; red turns anticlockwise.
"""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from burstcast.arrays import FloatArray
from burstcast.figures.parts.nothing_to_show import nothing_to_show
from burstcast.figures.parts.planes import (
    draw_periodic_field,
    evolution_above_fields,
    vorticity_fields,
)
from burstcast.figures.parts.style import (
    NETWORK,
    TRUTH,
    letter_panels,
    observable_label,
    styled,
)
from burstcast.figures.registry import Declaration
from burstcast.forecasters._labels import forecaster_label
from burstcast.systems.registry import make_system

FIGURE = Declaration(
    section="forecasts",
    position=61,
    inputs={
        "event": "decoded_forecaster/flow_event.nc",
        "gain": "case/ensemble.nc:gain",
        "constant": "case/ensemble.nc:constant",
        "states": "source/ensemble.nc:state",
    },
    settings={
        "source": "shown.source",
        "forecaster": "shown.decoded_kind",
        "threshold": "case.event_threshold",
        "symbol": "shown.symbol",
        "observable_name": "shown.observable_name",
    },
    cases="decoded_planes",
)


def draw(
    *,
    event: Mapping[str, Any],
    gain: FloatArray,
    constant: FloatArray,
    states: FloatArray,
    source: Mapping[str, Any],
    forecaster: str,
    threshold: float,
    symbol: str,
    observable_name: str,
) -> Figure:
    """Draw an event that the forecaster follows.

    ``event``: The event, its forecast and where it lies in the series
    (`burstcast.forecast.example_events.FlowEvent`). ``gain``, ``constant``: How states of the flow
    follow from channels (`burstcast.encoders.state_maps.StateMaps`). ``states``: True states of the
    flow, ``(series, time, dimension)``.
    """
    if not len(event["time_lt"]):
        return nothing_to_show("No event of the test series stands alone.")
    flow: Any = make_system(source["system"], source["parameters"])
    marks = event["mark"]
    true = states[event["series"], event["first_step"] + marks].T
    forecast = gain @ event["forecast_state"][:, :-1].T + constant[:, np.newaxis]
    return burst_forecast(
        event["time_lt"],
        {"true": event["true"], "forecast": event["forecast"]},
        event["time_lt"][marks],
        {
            name: vorticity_fields(flow, values)
            for name, values in (("true", true), ("forecast", forecast))
        },
        flow.domain,
        threshold,
        observable_label(symbol, observable_name),
        f"forecast: {forecaster_label(forecaster)}",
    )


@styled
def burst_forecast(
    time_lt: FloatArray,
    observable: Mapping[str, FloatArray],
    times_lt: Sequence[float],
    fields: Mapping[str, FloatArray],
    domain: tuple[float, float],
    threshold: float,
    label: str,
    forecast_label: str,
) -> Figure:
    """Draw the observable above the true and the forecast fields.

    ``time_lt``: Time after the start of the forecast in Lyapunov times, ``(time,)``.
    ``observable``: "true" and "forecast", ``(time,)`` each. ``fields``: "true" and "forecast"
    vorticity, ``(fields, x, y)`` each.
    """
    curves = [
        (observable["true"], {"label": "truth", **TRUTH}),
        (observable["forecast"], {"label": forecast_label, **NETWORK}),
    ]
    labels = "Time after the start of the forecast [LT]", label
    figure, evolution, lower = evolution_above_fields(
        5.4, 2.3, time_lt, curves, times_lt, threshold, labels
    )
    evolution.legend(loc="upper right")
    panels: list[list[Axes]] = lower.subplots(2, len(times_lt), sharex=True, sharey=True).tolist()
    all_panels = [axes for row in panels for axes in row]
    largest = float(np.nanmax(np.abs(np.stack([*fields.values()]))))
    for name, row in zip(fields, panels, strict=True):
        for axes, field, time in zip(row, fields[name], times_lt, strict=True):
            drawn = draw_periodic_field(axes, field, domain, largest)
            axes.set_xlabel("" if row is panels[0] else "$x$")
            axes.set_title(f"${time:+.1f}$ LT", loc="right")
        row[0].set_ylabel(f"{'truth' if name == 'true' else name}, $y$")
    lower.colorbar(drawn, ax=all_panels, label="Vorticity", shrink=0.7)
    letter_panels([evolution, *all_panels])
    return figure
