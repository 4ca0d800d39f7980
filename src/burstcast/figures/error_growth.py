"""Growth of the error of forecasts of the test set, by networks of up to four sizes. (a) Median
error of the observable over the starting points, in units of the median difference of two unrelated
times, which forecasts without any skill have. Grey line: growth by e in a Lyapunov time. (b) Share
of the starting points whose error has stayed below the one that prediction horizons allow: where a
curve crosses the grey line is the median valid prediction time. Errors are taken where the windows
of forecasts begin. Medians and quartiles over the networks of an ensemble.
"""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from matplotlib.ticker import MultipleLocator

from burstcast.base.arrays import FloatArray
from burstcast.base.declared import at, gathered, read
from burstcast.base.names import parsed
from burstcast.figures.parts import looks, medians, style
from burstcast.figures.registry import figure


@figure(section="forecasts", position=40, cases="networks")
def draw(
    *,
    truth: FloatArray = read("case/evaluation_set.nc:first"),
    forecasts: Sequence[Mapping[str, Any]] = gathered("networks/forecast.nc", "first"),
    summary: Mapping[str, Any] = read("case/dataset.json"),
    threshold: float = read("case/event_threshold.json:event_threshold"),
    tolerance: float = at("horizon.tolerance"),
    resolution_lt: float = at("classification.resolution_lt"),
    validation: str = at("shown.example.name.validation"),
) -> Figure:
    """Draw errors of one validation strategy, or of all if no network has it.

    ``truth``, ``first`` of each forecast: Observable where windows begin, ``(points, windows)``.
    """
    allowed = tolerance * (threshold - summary["mean_observable"])
    unrelated = float(np.median(np.abs(truth - np.roll(truth, len(truth) // 2, axis=0))))
    time_lt = resolution_lt * np.arange(1, truth.shape[1] + 1)
    rows = []
    for file in forecasts:
        name = parsed(str(file["forecaster"]))
        if name.kind != "esn" or name.label is not None:
            continue
        # diverged forecasts have no value
        errors = np.nan_to_num(np.abs(file["first"] - truth), nan=np.inf)
        valid = np.maximum.accumulate(errors, axis=1) <= allowed
        values = {"error": np.median(errors, axis=0) / unrelated, "valid": valid.mean(axis=0)}
        keys = {"neurons": name.neurons, "validation": name.validation}
        rows.append(pd.DataFrame({**keys, "time_lt": time_lt, **values}))
    table = pd.concat(rows, ignore_index=True).replace(np.inf, np.nan)
    if (table["validation"] == validation).any():
        table = table[table["validation"] == validation]
    figure = style.new_figure(style.DOUBLE_COLUMN, 2.6)
    panels = figure.subplots(1, 2)
    sizes = looks.few_of(np.unique(table["neurons"]))
    for axes, metric in zip(panels, ("error", "valid"), strict=True):
        for size, look in zip(sizes, looks.sequence(len(sizes)), strict=True):
            of_size = table[table["neurons"] == size].groupby("time_lt")[metric]
            quartiles = {
                f"p{100 * share:g}": of_size.quantile(share) for share in (0.25, 0.5, 0.75)
            }
            curve = pd.DataFrame(quartiles).dropna().reset_index()
            medians.draw(axes, curve, "time_lt", look, label=f"{size:g} neurons")
        axes.xaxis.set_major_locator(MultipleLocator(1))
        axes.set_xlabel("Time after the start [LT]")
    growth = float(table["error"].min()) * np.exp(time_lt - time_lt[0])
    panels[0].plot(time_lt[growth < 1], growth[growth < 1], **looks.FLOOR)
    panels[0].set_yscale("log")
    panels[0].set_ylabel("Error / difference of unrelated times")
    panels[1].axhline(0.5, **looks.FLOOR)
    panels[1].set_ylim(0, 1.03)
    panels[1].set_ylabel("Share of forecasts still valid")
    handles = medians.spread_handles(panels)
    if handles:
        figure.legend(handles=handles, loc="outside upper center")
    style.letter_panels(panels)
    style.label_ends(figure, panels)
    return figure
