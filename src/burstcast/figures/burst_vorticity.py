"""The strongest event of the test series of a plane flow: (a) the observable, with the event
threshold and the times of the fields; (b, ...) vorticity at these times, before, at and after the
peak. Red turns anticlockwise. All fields share one colour scale.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from burstcast.arrays import FloatArray
from burstcast.figures.parts import frame, looks, planes, style
from burstcast.figures.registry import Declaration
from burstcast.systems.registry import make_system

FIGURE = Declaration(
    section="data",
    position=20,
    inputs={
        "states": "case/ensemble.nc:state",
        "observable": "case/ensemble.nc:observable",
        "exponents": "time_unit",
    },
    settings="case.system case.parameters training_series=case.training.series "
    "case.ensemble.time_step case.ensemble.sampling_stride case.lyapunov.published_exponent "
    "threshold=case.event_threshold shown.symbol shown.observable_name",
    cases="plane_flows",
)

_TIMES_LT = (-2.0, -1.0, -0.5, 0.0, 1.0)
_SHOWN_LT = 4.0


@style.styled
def draw(
    *,
    states: FloatArray,
    observable: FloatArray,
    exponents: Mapping[str, Any] | None,
    system: str,
    parameters: Mapping[str, float],
    training_series: int,
    time_step: float,
    sampling_stride: int,
    published_exponent: float,
    threshold: float,
    symbol: str,
    observable_name: str,
) -> Figure:
    """Draw the largest peak of the test series that has all of its times within its series.

    ``states``, ``observable``: ``(series, time, dimension)`` and ``(series, time)``.
    """
    unit = frame.samples_per_lyapunov_time(
        exponents, published_exponent, time_step, sampling_stride
    )
    margin = min(round(_SHOWN_LT * unit), (observable.shape[1] - 1) // 2)
    tested = observable[training_series:, margin : observable.shape[1] - margin]
    row, step = np.unravel_index(np.argmax(tested), tested.shape)
    row, peak = row + training_series, step + margin
    steps = [peak + round(time * unit) for time in _TIMES_LT]
    steps = [min(max(one, 0), observable.shape[1] - 1) for one in steps]
    times_lt = [(one - peak) / unit for one in steps]
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
