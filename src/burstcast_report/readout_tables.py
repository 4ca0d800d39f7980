"""Markdown tables and a figure of the readouts of networks, for docs/results.md."""

from pathlib import Path

import numpy as np
import pandas as pd
from scipy.stats import t as student

from burstcast.arrays import FloatArray
from burstcast_report.results_tables import Tables, fixed, markdown

READOUTS = {
    "esn": "as in the paper",
    "esn_bias": "input bias 1",
    "esn_quadratic": "squares",
    "esn_quadraticbias": "squares, input bias 1",
    "esn_quadraticleak": "squares, leak searched",
}
"""Networks of the campaign `readout`, by their names in tables."""

_CONFIDENCE = 0.95
_FORECASTS = ("f_score", "mean_horizon_lt")
_KEYS = ["forecaster", "neurons"]
_COLUMNS = {
    "f_score": ("F, 3 LT", 3),
    "mean_horizon_lt": ("PH_ee [LT]", 2),
    "kantorovich": ("Kantorovich metric of k", 4),
    "mean_log_error": ("mean logarithmic error", 3),
    "discarded_fraction": ("left the chaotic phase", 2),
    "reduction": ("exceedance avoided, 1 LT", 3),
}


def by_readout(tables: Tables) -> str:
    """Means over training sets: of forecasts with 95 % intervals of Student's t over the sets.

    The other scores have the smallest and the largest mean of a set in parentheses.
    """
    head = ["network", "neurons", *(title for title, _ in _COLUMNS.values())]
    found = _by_set(tables)
    rows = []
    for (forecaster, neurons), rows_of_sets in found.groupby(level=_KEYS, sort=False):
        of_sets = rows_of_sets.droplevel([*_KEYS])
        cells = [
            (_interval if name in _FORECASTS else _range)(of_sets[name], digits)
            for name, (_, digits) in _COLUMNS.items()
        ]
        rows.append([READOUTS[str(forecaster)], f"{neurons:g}", *cells])
    return markdown(head, rows)


def against_the_paper(tables: Tables) -> str:
    """Differences from networks of the paper, of the same and of the largest size, by sets."""
    found = _by_set(tables)
    paper = found.xs("esn", level="forecaster")
    rows = []
    for (forecaster, neurons), rows_of_sets in found.groupby(level=_KEYS, sort=False):
        of_sets = rows_of_sets.droplevel([*_KEYS])
        for size in (neurons, max(paper.index.unique("neurons"))):
            if forecaster == "esn":
                continue
            difference = of_sets - pd.DataFrame(paper.xs(size, level="neurons"))
            cells = [_interval(difference[name], _COLUMNS[name][1]) for name in _FORECASTS]
            rows.append([READOUTS[str(forecaster)], f"{neurons:g}", f"{size:g}", *cells])
    titles = (f"difference of {_COLUMNS[name][0]}" for name in _FORECASTS)
    return markdown(["network", "neurons", "against the paper's of", *titles], rows)


def draw(tables: Tables, path: Path) -> None:
    """Draw F-score and PH_ee against the size, one curve for each readout."""
    from matplotlib.figure import Figure  # the page itself is made without it

    found = _by_set(tables)
    figure = Figure(figsize=(7.0, 3.0), layout="constrained")
    for axes, name in zip(figure.subplots(1, 2), _FORECASTS, strict=True):
        for number, forecaster in enumerate(found.index.unique("forecaster")):
            curve = found[name].xs(forecaster, level="forecaster").groupby("neurons")
            sizes = np.array(list(curve.groups), dtype=np.float64) * 1.02 ** (number - 2)
            axes.errorbar(
                *(sizes, curve.mean(), [_half_width(one.to_numpy()) for _, one in curve]),
                **{"label": READOUTS[str(forecaster)], "marker": "osD^v"[number], "markersize": 4},
                **{"linewidth": 1, "capsize": 2},
            )
        axes.set_xscale("log", base=2)
        ticks = sorted(found.index.unique("neurons"))
        axes.set_xticks(ticks, [f"{size:g}" for size in ticks])
        axes.set_xlabel("neurons")
        axes.set_ylabel(_COLUMNS[name][0])
    axes.legend(fontsize=7, frameon=False, loc="lower right")
    figure.savefig(path, dpi=150)


def _by_set(tables: Tables) -> pd.DataFrame:
    """Scores by readout, size and training set: means over the seeds of each set."""
    scores = tables.rows("classification", prediction_time_lt=3.0)
    parts = [
        scores.set_index(["case", *_KEYS, "seed"])[["f_score"]],
        tables.rows("horizon").set_index(["case", *_KEYS, "seed"])[["mean_horizon_lt"]],
        tables.rows("statistics").set_index(["case", *_KEYS, "seed"])[
            ["kantorovich", "mean_log_error", "discarded_fraction"]
        ],
        tables.rows("control", prediction_time_lt=1.0).set_index(["case", *_KEYS, "seed"])[
            ["reduction"]
        ],
    ]
    chosen = [
        part[part.index.get_level_values("forecaster").isin(READOUTS)].groupby(["case", *_KEYS])
        for part in parts
    ]
    found = pd.concat([part.mean() for part in chosen], axis=1)
    order = found.index.get_level_values("forecaster").map(list(READOUTS).index)
    return found.assign(order=order).sort_values(["order", "neurons"]).drop(columns="order")


def _half_width(values: FloatArray) -> float:
    quantile = student.ppf(0.5 + _CONFIDENCE / 2, len(values) - 1)
    return float(quantile * values.std(ddof=1) / np.sqrt(len(values)))


def _interval(values: pd.Series, digits: int) -> str:
    """Mean with its interval over training sets."""
    array = values.to_numpy(dtype=np.float64)
    mean, half = float(array.mean()), _half_width(array)
    return f"{fixed(mean, digits)} ({fixed(mean - half, digits)} to {fixed(mean + half, digits)})"


def _range(values: pd.Series, digits: int) -> str:
    """Mean with the extremes of the training sets."""
    ends = " to ".join(fixed(float(end), digits) for end in (values.min(), values.max()))
    return f"{fixed(float(values.mean()), digits)} ({ends})"
