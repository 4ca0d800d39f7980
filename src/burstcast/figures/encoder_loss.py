"""What the leading modes of a plane flow hold: proper orthogonal decomposition of the training
states with their images under the symmetries of the flow. (a) Against the number of modes, the
share of the variance, the mean of the observable of the decoded states in units of its true mean,
and the correlation of both observables. (b, ...) Vorticity of the first modes of each of the
leading pairs.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from burstcast.base.arrays import FloatArray
from burstcast.base.declared import at, read
from burstcast.data.encoders.base import EncodingCase
from burstcast.data.encoders.pod import PodEncoder
from burstcast.figures.parts import looks, planes, style
from burstcast.figures.registry import figure
from burstcast.systems.base import DynamicalSystem
from burstcast.systems.registry import make_system

_SNAPSHOTS = 2000
"""Training states, at equal distances, from which modes are made and which are decoded."""
_SHOWN = (0, 2, 4, 6)


@figure(section="data", position=21, cases="plane_flows")
def draw(
    *,
    states: FloatArray = read("case/ensemble.nc:state"),
    system: str = at("case.system"),
    parameters: Mapping[str, float] = at("case.parameters"),
    training_series: int = at("case.training.series"),
    symbol: str = at("case.space.observable_symbol"),
) -> Figure:
    """Draw what the leading modes of a flow hold, and some of the modes.

    ``states``: Of all series, ``(series, time, dimension)``.
    """
    flow: Any = make_system(system, parameters)
    training = states[:training_series].reshape(-1, states.shape[2])
    snapshots = training[:: max(1, len(training) // _SNAPSHOTS)]
    count = min(len(snapshots), flow.dimension)
    encoder = PodEncoder.fit(snapshots[np.newaxis], EncodingCase(flow, {"modes": count}))
    numbers = np.unique(np.geomspace(1, count, 24).astype(int))
    held = kept(encoder, flow, snapshots.T, numbers)
    shown = [number for number in _SHOWN if number < count]
    fields = planes.vorticity_fields(flow, encoder.modes[:, shown], 64)
    figure = style.new_figure(style.DOUBLE_COLUMN, 3.9)
    grid = figure.add_gridspec(2, 1, height_ratios=[1.25, 1.0])
    upper, lower = (figure.add_subfigure(grid[row]) for row in range(2))
    lines: Axes = upper.subplots()
    labels = {
        "variance": "share of the variance",
        "mean": f"mean of the decoded ${symbol}$, in units of the true one",
        "correlation": f"correlation of the decoded ${symbol}$ with the true one",
    }
    for (name, label), look in zip(labels.items(), looks.sequence(len(labels)), strict=True):
        lines.semilogx(numbers, held[name], label=label, markersize=3.0, **look)
    lines.axhline(0.0, **looks.FLOOR)
    lines.set_xlim(numbers[0], numbers[-1])
    lines.set_ylim(min(-0.05, 1.1 * min(map(np.min, held.values()))), 1.05)
    lines.set_xlabel("Number of modes")
    lines.legend(loc="lower right")
    panels: list[Axes] = list(lower.subplots(1, len(shown), sharey=True, squeeze=False)[0])
    for axes, number, field in zip(panels, shown, fields, strict=True):
        planes.draw_periodic_field(axes, field, flow.domain, float(np.abs(field).max()))
        axes.set_title(f"mode {number + 1}", loc="right")
    panels[0].set_ylabel("$y$")
    style.letter_panels([lines, *panels])
    return figure


def kept(
    encoder: PodEncoder, flow: DynamicalSystem, states: FloatArray, numbers: np.ndarray
) -> dict[str, FloatArray]:
    """Shares of the variance and of the mean observable, and correlations of the observable.

    ``states``: States that are decoded from so many leading coefficients, ``(dimension, states)``.
    Returns "variance", "mean" and "correlation", ``(numbers,)`` each.
    """
    true, coefficients = flow.observable(states), encoder.encode(states)
    decoded = [
        flow.observable(
            encoder.decode(np.where(np.arange(len(coefficients)) < number, coefficients.T, 0.0).T)
        )
        for number in numbers
    ]
    variances = encoder.variances
    return {
        "variance": np.array([variances[:n].sum() / variances.sum() for n in numbers]),
        "mean": np.array([values.mean() / true.mean() for values in decoded]),
        "correlation": np.array([np.corrcoef(values, true)[0, 1] for values in decoded]),
    }
