"""The strongest event of the test series of a plane flow: (a) the observable, with the event
threshold and the times of the fields; (b, ...) vorticity at these times, before, at and after the
peak. Red turns anticlockwise. All fields share one colour scale.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from burstcast.base.arrays import FloatArray
from burstcast.base.declared import at, read
from burstcast.figures.parts import frame, looks, planes, style
from burstcast.figures.registry import figure
from burstcast.systems.registry import make_system

_TIMES_LT = (-2.0, -1.0, -0.5, 0.0, 1.0)
_SHOWN_LT = 4.0


@figure(section="data", position=20, cases="plane_flows")
def draw(
    *,
    states: FloatArray = read("case/ensemble.nc:state"),
    observable: FloatArray = read("case/ensemble.nc:observable"),
    unit: int = read("case/time_unit.json:steps_per_lyapunov_time"),
    system: str = at("case.system"),
    parameters: Mapping[str, float] = at("case.parameters"),
    training_series: int = at("case.training.series"),
    threshold: float = read("case/event_threshold.json:event_threshold"),
    symbol: str = at("case.space.observable_symbol"),
    observable_name: str = at("case.space.observable_name"),
) -> Figure:
    """Draw the largest peak of the test series that has all of its times within its series.

    ``states``, ``observable``: ``(series, time, dimension)`` and ``(series, time)``.
    """
    margin = min(round(_SHOWN_LT * unit), (observable.shape[1] - 1) // 2)
    tested = observable[training_series:, margin : observable.shape[1] - margin]
    row, step = np.unravel_index(np.argmax(tested), tested.shape)
    row, peak = row + training_series, step + margin
    steps = [peak + round(time * unit) for time in _TIMES_LT]
    steps = [min(max(step, 0), observable.shape[1] - 1) for step in steps]
    times_lt = [(step - peak) / unit for step in steps]
    flow: Any = make_system(system, parameters)
    fields = planes.vorticity_fields(flow, states[row, steps].T)
    shown = np.arange(peak - margin, peak + margin + 1)
    figure, evolution, lower = planes.evolution_above_fields(
        3.6,
        1.15,
        (shown - peak) / unit,
        [(observable[row, shown], None, looks.TRUTH)],
        times_lt,
        threshold,
        ("Time from the peak [LT]", frame.observable_label(symbol, observable_name)),
    )
    titles = [f"${time:+.1f}$ LT" if time else "peak" for time in times_lt]
    panels = planes.draw_rows_of_fields(lower, {"$y$": fields}, flow.domain, titles)
    style.letter_panels([evolution, *panels])
    return figure
