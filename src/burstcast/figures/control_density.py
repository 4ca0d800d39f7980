"""Density of the observable with and without control: means over the networks of an ensemble
(lines), and their bootstrap intervals over flows (bands). Both flows start from the same states and
are compared over the same times. The table control_density.csv has these densities, and those
without the time under actuation.
"""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from burstcast.base.declared import at, read
from burstcast.figures.parts import frame, looks, style
from burstcast.figures.registry import figure


@figure(section="control", position=40, cases="controlled_systems")
def draw(
    *,
    densities: Sequence[pd.DataFrame] = read("controlled_cases/tables/control_density.csv"),
    panels: Sequence[Mapping[str, Any]] = at("shown.panels"),
    thresholds: Sequence[float] = read("controlled_cases/event_threshold.json:event_threshold"),
    prediction_times_lt: Sequence[float] = at("control.prediction_times_lt"),
    symbol: str = at("case.space.observable_symbol"),
    observable_name: str = at("case.space.observable_name"),
) -> Figure:
    """Draw a panel for each case, two beside each other, on logarithmic scale.

    ``panels``: Each case that is shown, and ``neurons`` and ``validation`` of the networks that are
    shown. ``thresholds``: Event threshold of each case.
    """
    table = pd.concat(densities, ignore_index=True)
    table = table[
        (table["forecaster"] == "esn") & table["prediction_time_lt"].isin(prediction_times_lt)
    ]
    keys = ["case", "neurons", "validation"]
    shown = [table[(table[keys] == pd.Series(panel)[keys]).all(axis=1)] for panel in panels]
    names = ["density_uncontrolled", "density_controlled"]
    # the flows that count differ a little between prediction times; NaN where no flow counts
    without = [
        rows.groupby("low")[[names[0], f"{names[0]}_low", f"{names[0]}_high"]].mean()
        for rows in shown
    ]
    if not any(np.isfinite(rows[names[0]]).all() for rows in without):
        return style.nothing_to_show("No flow was free of events for long enough to be controlled.")
    drawn = np.concatenate(
        [rows[names[0]] for rows in without] + [rows[names[1]] for rows in shown]
    )
    positive = drawn[drawn > 0]
    columns = min(2, len(panels))
    rows_of_panels = (len(panels) + columns - 1) // columns
    width = style.DOUBLE_COLUMN if columns == 2 else style.SINGLE_COLUMN
    figure = style.new_figure(width, 1.75 * rows_of_panels + 0.5)
    axes = figure.subplots(rows_of_panels, columns, sharex=True, sharey=True, squeeze=False).ravel()
    times = sorted(pd.concat(shown)["prediction_time_lt"].unique())
    for index, (panel, rows, mean) in enumerate(zip(panels, shown, without, strict=True)):
        by_time = [
            (looks.TIMES[times.index(time) % len(looks.TIMES)], time, group.sort_values("low"))
            for time, group in rows.groupby("prediction_time_lt")
        ]
        edges = np.append(mean.index, rows["high"].max())
        bands = [(style.GREY, mean, names[0])]
        bands += [(color, group, names[1]) for (color, _), _, group in by_time]
        axes[index].stairs(
            mean[names[0]], edges, baseline=None, label="without control", **looks.TRUTH
        )
        for color, band, name in bands:
            axes[index].stairs(
                band[f"{name}_high"],
                edges,
                # where no axis reaches: a density of zero has no logarithm
                baseline=np.maximum(band[f"{name}_low"], 0.5 * positive.min()),
                fill=True,
                color=color,
                alpha=0.2,
                linewidth=0,
            )
        for (color, dashes), time, group in by_time:
            axes[index].stairs(
                group[names[1]],
                edges,
                baseline=None,
                color=color,
                linestyle=dashes,
                linewidth=1.2,
                label=f"control, PT = {time:g} LT",
            )
        frame.density_axes(axes[index], thresholds[index], symbol, observable_name)
        letter = f"({chr(ord('a') + index)}) " if len(panels) > 1 else ""
        title = f"Re = {rows['reynolds'].iloc[0]:g}" if "reynolds" in rows else panel["case"]
        axes[index].set_title(f"{letter}{title}", loc="left")
        axes[index].xaxis.set_tick_params(labelbottom=index + columns >= len(panels))
        if index + columns < len(panels):
            axes[index].set_xlabel("")
        if index % columns:
            axes[index].set_ylabel("")
    for panel in axes[len(panels) :]:
        panel.set_axis_off()
    axes[0].set_ylim(0.6 * positive.min(), 3 * positive.max())
    together = pd.concat(shown)
    axes[0].set_xlim(together["low"].min(), together["high"].max())
    more = [style.band_handle("interval over flows")]
    if columns == 2:
        style.legend_above(figure, axes[: len(panels)], more)
    else:
        handles = [*axes[0].get_legend_handles_labels()[0], *more]
        axes[0].legend(handles=handles, loc="upper right")
    return figure
