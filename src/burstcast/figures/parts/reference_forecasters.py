"""Forecasters that networks are compared with, in figures: in grey, whatever their kind."""

from collections.abc import Collection
from typing import Any

import pandas as pd
from matplotlib.axes import Axes

from burstcast.figures.parts.percentile_curves import select
from burstcast.figures.parts.style import GREY

_LABELS = {"equations": "equations, true state", "equations_noisy": "equations, noisy state"}
_LINES = ((0, (1.0, 1.2)), (0, (4.0, 1.5)), (0, (4.0, 1.5, 1.0, 1.5)), (0, (8.0, 2.0)))


def forecaster_label(kind: str) -> str:
    """What figures call a kind of forecaster."""
    return _LABELS.get(kind, kind.replace("_", " "))


def draw_references(
    axes: Axes,
    percentiles: pd.DataFrame,
    metric: str,
    x: str | None,
    leave_out: Collection[str] = (),
) -> None:
    """Draw the forecasters that are no networks: the median of a metric in grey.

    Parameters
    ----------
    axes
        Where to draw.
    percentiles
        Of one case; rows of networks are left out.
    metric
        Which metric.
    x
        Column on the horizontal axis; None: what they achieve does not depend on it, and is a
        horizontal line.
    leave_out
        Kinds that are not drawn.
    """
    # a kind has the same line in all figures of a campaign, whatever they leave out
    kinds = sorted(set(percentiles["forecaster"].dropna()) - {"esn"})
    for index, kind in enumerate(kinds):
        rows = select(percentiles, forecaster=kind, metric=metric)
        if kind in leave_out or rows.empty:
            continue
        line: dict[str, Any] = {
            "color": GREY,
            "linestyle": _LINES[index % len(_LINES)],
            "linewidth": 1.0,
            "label": forecaster_label(kind),
            "zorder": 1.5,
        }
        if x is None:
            axes.axhline(float(rows["p50"].iloc[0]), **line)
        else:
            rows = rows.sort_values(x)
            axes.plot(rows[x], rows["p50"], **line)
