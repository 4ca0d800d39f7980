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

from burstcast.arrays import FloatArray
from burstcast.encoders.base import EncodingCase
from burstcast.encoders.pod import PodEncoder
from burstcast.figures.parts.planes import draw_periodic_field, vorticity_fields
from burstcast.figures.parts.style import (
    DOUBLE_COLUMN,
    FLOOR,
    letter_panels,
    new_figure,
    sequence_styles,
    styled,
)
from burstcast.figures.registry import Declaration
from burstcast.systems.base import DynamicalSystem
from burstcast.systems.registry import make_system

FIGURE = Declaration(
    section="data",
    position=21,
    inputs={"states": "case/ensemble.nc:state"},
    settings={
        "system": "case.system",
        "parameters": "case.parameters",
        "training_series": "case.training.series",
        "symbol": "shown.symbol",
    },
    cases="plane_flows",
)

_SNAPSHOTS = 2000
"""Training states, at equal distances, from which modes are made and which are decoded."""
_SHOWN = (0, 2, 4, 6)
_POINTS = 64


def draw(
    *,
    states: FloatArray,
    system: str,
    parameters: Mapping[str, float],
    training_series: int,
    symbol: str,
) -> Figure:
    """Draw the modes of a flow, and what they hold.

    ``states``: States of all series, ``(series, time, dimension)``.
    """
    flow: Any = make_system(system, parameters)
    training = states[:training_series].reshape(-1, states.shape[2])
    snapshots = training[:: max(1, len(training) // _SNAPSHOTS)]
    count = min(len(snapshots), flow.dimension)
    encoder = PodEncoder.fit(snapshots[np.newaxis], EncodingCase(flow, {"modes": count}))
    numbers = np.unique(np.geomspace(1, count, 24).astype(int))
    shown = [number for number in _SHOWN if number < count]
    fields = vorticity_fields(flow, encoder.modes[:, shown], _POINTS)
    return encoder_loss(
        numbers,
        kept(encoder, flow, snapshots.T, numbers),
        {number + 1: field for number, field in zip(shown, fields, strict=True)},
        flow.domain,
        symbol,
    )


def kept(
    encoder: PodEncoder, flow: DynamicalSystem, states: FloatArray, numbers: np.ndarray
) -> dict[str, FloatArray]:
    """Shares of the variance and the observable, and correlations of the observable.

    ``states``: States that are decoded from their leading coefficients, ``(dimension, states)``.
    ``numbers``: Numbers of leading modes, ``(numbers,)``. Returns "variance", "mean" and
    "correlation", ``(numbers,)`` each.
    """
    true, coefficients = flow.observable(states), encoder.encode(states)
    shares, means, correlations = [], [], []
    for number in numbers:
        leading = np.zeros_like(coefficients)
        leading[:number] = coefficients[:number]
        found = flow.observable(encoder.decode(leading))
        shares.append(encoder.variances[:number].sum() / encoder.variances.sum())
        means.append(found.mean() / true.mean())
        correlations.append(np.corrcoef(found, true)[0, 1])
    return {
        "variance": np.array(shares),
        "mean": np.array(means),
        "correlation": np.array(correlations),
    }


@styled
def encoder_loss(
    numbers: np.ndarray,
    kept: Mapping[str, FloatArray],
    modes: Mapping[int, FloatArray],
    domain: tuple[float, float],
    symbol: str,
) -> Figure:
    """Draw the shares of the modes above a number of leading modes.

    ``modes``: Vorticity ``(x, y)`` of modes, by their numbers from 1.
    """
    figure = new_figure(DOUBLE_COLUMN, 3.9)
    grid = figure.add_gridspec(2, 1, height_ratios=[1.25, 1.0])
    upper, lower = (figure.add_subfigure(grid[row]) for row in range(2))
    lines: Axes = upper.subplots()
    labels = {
        "variance": "share of the variance",
        "mean": f"mean of the decoded ${symbol}$, in units of the true one",
        "correlation": f"correlation of the decoded ${symbol}$ with the true one",
    }
    for (name, label), style in zip(labels.items(), sequence_styles(len(labels)), strict=True):
        lines.semilogx(numbers, kept[name], label=label, markersize=3.0, **style)
    lines.axhline(0.0, **FLOOR)
    lines.set_xlim(numbers[0], numbers[-1])
    lines.set_ylim(min(-0.05, 1.1 * min(map(np.min, kept.values()))), 1.05)
    lines.set_xlabel("Number of modes")
    lines.legend(loc="lower right")
    panels: list[Axes] = list(lower.subplots(1, len(modes), sharey=True, squeeze=False)[0])
    for axes, (number, field) in zip(panels, modes.items(), strict=True):
        largest = float(np.abs(field).max())
        draw_periodic_field(axes, field, domain, largest)
        axes.set_title(f"mode {number}", loc="right")
    panels[0].set_ylabel("$y$")
    letter_panels([lines, *panels])
    return figure
