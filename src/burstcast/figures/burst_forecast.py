"""Forecast of an event of a plane flow beside the truth: (a) the observable, with the event
threshold and the times of the fields; the forecast starts at time 0. Then the true vorticity
(middle) and the forecast one (bottom) at these times: the last calm moment, the rise, the peak and
the end. Forecast fields are decoded from the forecaster's channels, sensor readings or modes.
All fields share one colour scale; red turns anticlockwise.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from burstcast.base.arrays import FloatArray
from burstcast.base.declared import at, read
from burstcast.figures.parts import frame, looks, planes, style
from burstcast.figures.registry import figure
from burstcast.forecasters._labels import forecaster_label
from burstcast.systems.registry import make_system


@figure(section="forecasts", position=61, cases="decoded_planes")
def draw(
    *,
    event: Mapping[str, Any] = read("decoded_forecaster/flow_event.nc"),
    gain: FloatArray = read("case/ensemble.nc:gain"),
    constant: FloatArray = read("case/ensemble.nc:constant"),
    states: FloatArray = read("source/ensemble.nc:state"),
    source: Mapping[str, Any] = at("case.source_system"),
    forecaster: str = at("shown.decoded_forecaster.name.kind"),
    threshold: float = read("case/event_threshold.json:event_threshold"),
    symbol: str = at("case.space.observable_symbol"),
    observable_name: str = at("case.space.observable_name"),
) -> Figure:
    """Draw the observable over an event, above the true and the forecast fields.

    ``event``: See `burstcast.forecasts.examples.FlowEvent`. ``gain``, ``constant``: How
    states of the flow follow from channels. ``states``: True ones, ``(series, time, dimension)``.
    """
    if not len(event["time_lt"]):
        return style.nothing_to_show("No event of the test series stands alone.")
    flow: Any = make_system(source["system"], source["parameters"])
    marks = event["mark"]
    times_lt = event["time_lt"][marks]
    decoded = gain @ event["forecast_state"][:, :-1].T + constant[:, np.newaxis]
    fields = {"truth": states[event["series"], event["first_step"] + marks].T, "forecast": decoded}
    fields = {name: planes.vorticity_fields(flow, shown) for name, shown in fields.items()}
    figure, evolution, lower = planes.evolution_above_fields(
        5.4,
        2.3,
        event["time_lt"],
        [
            (event["true"], "truth", looks.TRUTH),
            (event["forecast"], f"forecast: {forecaster_label(forecaster)}", looks.NETWORK),
        ],
        times_lt,
        threshold,
        (
            "Time after the start of the forecast [LT]",
            frame.observable_label(symbol, observable_name),
        ),
    )
    evolution.legend(loc="upper right")
    titles = [f"${time:+.1f}$ LT" for time in times_lt]
    shown = {f"{name}, $y$": of_row for name, of_row in fields.items()}
    panels = planes.draw_rows_of_fields(lower, shown, flow.domain, titles)
    style.letter_panels([evolution, *panels])
    return figure
