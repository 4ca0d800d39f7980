"""The strongest event of the test series of a plane flow: (a) the observable, with the event
threshold and the times of the fields; (b, ...) vorticity at these times, before, at and after the
peak. Red turns anticlockwise. All fields share one colour scale.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from burstcast.arrays import FloatArray
from burstcast.figures.parts.planes import (
    draw_periodic_field,
    evolution_above_fields,
    vorticity_fields,
)
from burstcast.figures.parts.style import TRUTH, letter_panels, observable_label, styled
from burstcast.figures.parts.time_axis import samples_per_lyapunov_time
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
    settings={
        "system": "case.system",
        "parameters": "case.parameters",
        "training_series": "case.training.series",
        "time_step": "case.ensemble.time_step",
        "sampling_stride": "case.ensemble.sampling_stride",
        "published_exponent": "case.lyapunov.published_exponent",
        "threshold": "case.event_threshold",
        "symbol": "shown.symbol",
        "observable_name": "shown.observable_name",
    },
    cases="plane_flows",
)

_TIMES_LT = (-2.0, -1.0, -0.5, 0.0, 1.0)
_SHOWN_LT = 4.0


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
    """Draw the largest peak that has all of its times within its series.

    ``states``, ``observable``: States and observable of all series, ``(series, time, dimension)``
    and ``(series, time)``. ``time_step``, ``sampling_stride``, ``published_exponent``: Time step,
    sampling stride and published exponent of the case.
    """
    unit = samples_per_lyapunov_time(exponents, published_exponent, time_step, sampling_stride)
    margin = min(round(_SHOWN_LT * unit), (observable.shape[1] - 1) // 2)
    tested = observable[training_series:, margin : observable.shape[1] - margin]
    row, step = np.unravel_index(np.argmax(tested), tested.shape)
    row, peak = row + training_series, step + margin
    steps = [peak + round(time * unit) for time in _TIMES_LT]
    steps = [min(max(one, 0), observable.shape[1] - 1) for one in steps]
    flow: Any = make_system(system, parameters)
    span = slice(peak - margin, peak + margin + 1)
    return burst_vorticity(
        (np.arange(span.start, span.stop) - peak) / unit,
        observable[row, span],
        [(one - peak) / unit for one in steps],
        vorticity_fields(flow, states[row, steps].T),
        flow.domain,
        threshold,
        observable_label(symbol, observable_name),
    )


@styled
def burst_vorticity(
    time_lt: FloatArray,
    observable: FloatArray,
    times_lt: list[float],
    fields: FloatArray,
    domain: tuple[float, float],
    threshold: float,
    label: str,
) -> Figure:
    """Draw the observable above the fields.

    ``time_lt``, ``observable``: Around the peak, ``(time,)``; Lyapunov times. ``fields``:
    Vorticity, ``(fields, x, y)``.
    """
    labels = "Time from the peak [LT]", label
    figure, evolution, lower = evolution_above_fields(
        3.6, 1.15, time_lt, [(observable, TRUTH)], times_lt, threshold, labels
    )
    panels: list[Axes] = list(lower.subplots(1, len(fields), sharey=True))
    largest = float(np.abs(fields).max())
    for axes, field, time in zip(panels, fields, times_lt, strict=True):
        drawn = draw_periodic_field(axes, field, domain, largest)
        axes.set_title(f"${time:+.1f}$ LT" if time else "peak", loc="right")
    panels[0].set_ylabel("$y$")
    lower.colorbar(drawn, ax=panels, label="Vorticity", shrink=0.7)
    letter_panels([evolution, *panels])
    return figure
