"""Lines of reference forecasters in figures, in one style."""

from collections.abc import Collection
from typing import Any, NamedTuple

import pandas as pd
from matplotlib.axes import Axes

from burstcast.figures.parts.percentile_curves import select
from burstcast.figures.parts.style import BLUE, GREEN, GREY, ORANGE, PURPLE, VERMILLION
from burstcast.forecasters._labels import forecaster_label

_MAUVE = "#8A5A83"
_PALE = "#A0A0A0"
_DOTS, _DASHES, _LONG = (0.0, (1.0, 1.2)), (0.0, (4.0, 1.5)), (0.0, (8.0, 2.0))
_CHAIN = (0.0, (9.0, 2.0, 1.5, 2.0))


class _Look(NamedTuple):
    color: str
    linestyle: str | tuple[float, tuple[float, ...]]


# Networks in colours; the equations in grey, learnt ones in mauve, and in front of them where they
# do as well: solid or with wide gaps where a filter comes first, dashed where they start from one
# observation; chained where members of an ensemble vote. Classifiers are orange.
_LOOKS = {
    "esn_committee": _Look(BLUE, "-"),
    "esn": _Look(VERMILLION, (0.0, (3.5, 1.2))),
    "esn_aware": _Look(GREEN, "-"),
    "equations": _Look(GREY, _DOTS),
    "equations_filtered": _Look(GREY, "-"),
    "equations_filtered_committee": _Look(GREY, _CHAIN),
    "equations_noisy": _Look(GREY, _DASHES),
    "quadratic": _Look(_MAUVE, (2.0, (1.5, 4.0))),
    "quadratic_filtered": _Look(_MAUVE, (0.0, (4.0, 4.0))),
    "quadratic_filtered_committee": _Look(_MAUVE, (6.0, (9.0, 2.0, 1.5, 5.5))),
    "quadratic_aware": _Look(PURPLE, (0.0, (4.0, 1.5))),
    "quadratic_aware_filtered": _Look(PURPLE, "-"),
    "analogues": _Look(_PALE, _DASHES),
    "analogues_committee": _Look(_PALE, _CHAIN),
    "linear_inverse": _Look(_PALE, _DOTS),
    "precursor": _Look(ORANGE, "-"),
    "esn_direct": _Look(ORANGE, _DASHES),
    "persistence": _Look(_PALE, _LONG),
    "observable_now": _Look(_PALE, (0.0, (6.0, 1.5, 1.0, 1.5))),
    "climatology": _Look(_PALE, "-"),
    "permanent_alarm": _Look(_PALE, "-"),
}


def forecaster_style(kind: str) -> dict[str, Any]:
    """Label, colour and line style of a kind of forecaster, as keywords of a line."""
    return {"label": forecaster_label(kind), **_LOOKS.get(kind, _Look(GREY, _LONG))._asdict()}


def ordered_forecasters(kinds: Collection[str]) -> list[str]:
    """Kinds as legends list them; unknown ones last, by name."""
    known = [kind for kind in _LOOKS if kind in kinds]
    return [*known, *sorted(set(kinds) - set(known))]


def draw_references(
    axes: Axes,
    percentiles: pd.DataFrame,
    metric: str,
    x: str,
    *,
    neurons: float | None = None,
    leave_out: Collection[str] = (),
) -> None:
    """Draw the forecasters of other kinds than ``esn``: the median of a metric as a quiet line.

    A kind that has sizes has a line for each validation strategy.

    ``percentiles``: Percentiles of one case; rows of the kind ``esn`` are left out. ``x``: Column
    on the horizontal axis. If it is ``neurons``, kinds without sizes are horizontal lines.
    ``neurons``: Size that is shown of kinds that have sizes, where another column is on the axis.
    """
    for kind in ordered_forecasters(set(percentiles["forecaster"].dropna()) - {"esn", *leave_out}):
        rows = select(percentiles, forecaster=kind, metric=metric)
        if x != "neurons":
            rows = rows[rows["neurons"].isna() | (rows["neurons"] == neurons)]
        line: dict[str, Any] = {**forecaster_style(kind), "linewidth": 1.0, "zorder": 1.5}
        for _, curve in rows.groupby("validation", dropna=False):
            if curve[x].isna().all():
                axes.axhline(float(curve["p50"].iloc[0]), **line)
            else:
                curve = curve.sort_values(x)
                marker = "." if len(curve) == 1 else ""
                axes.plot(curve[x], curve["p50"], **line, marker=marker)
            line["label"] = ""
