"""Density of the observable with and without control: means over the networks of an ensemble
(lines), and their bootstrap intervals over flows (bands). Both flows start from the same states and
are compared over the same times. The table control_density.csv has these densities, and those
without the time under actuation.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from burstcast.arrays import FloatArray
from burstcast.figures.parts.nothing_to_show import nothing_to_show
from burstcast.figures.parts.style import (
    BLUE,
    DOUBLE_COLUMN,
    GREY,
    PURPLE,
    SINGLE_COLUMN,
    THRESHOLD,
    TRUTH,
    VERMILLION,
    band_handle,
    density_label,
    legend_above,
    new_figure,
    observable_label,
    styled,
)
from burstcast.figures.registry import Declaration

FIGURE = Declaration(
    section="control",
    position=40,
    inputs={"densities": "controlled_cases/tables/control_density.csv"},
    settings={
        "panels": "shown.panels",
        "prediction_times_lt": "control.prediction_times_lt",
        "symbol": "shown.symbol",
        "observable_name": "shown.observable_name",
    },
    cases="controlled_systems",
)


@dataclass(frozen=True)
class ControlledDensity:
    """Densities of one case."""

    title: str  #: title of the panel: "Re = 400"
    bin_edges: FloatArray
    threshold: float
    uncontrolled: FloatArray  #: density without control, ``(bins,)``
    #: density with control by prediction time in Lyapunov times, ``(bins,)`` each
    controlled: Mapping[float, FloatArray]
    #: interval of the density without control, ``(2, bins)``; None: it is not shown
    uncontrolled_band: FloatArray | None = None
    #: intervals of the densities with control, ``(2, bins)`` each
    bands: Mapping[float, FloatArray] = field(default_factory=dict)


def draw(
    *,
    densities: Sequence[pd.DataFrame],
    panels: Sequence[Mapping[str, Any]],
    prediction_times_lt: Sequence[float],
    symbol: str,
    observable_name: str,
) -> Figure:
    """Draw a panel for each case.

    ``panels``: Each case that is shown, its event threshold, and ``neurons`` and ``validation`` of
    the networks that are shown.
    """
    table = pd.concat(densities, ignore_index=True)
    shown = []
    for panel in panels:
        case = panel["case"]
        rows = table[
            (table["case"] == case)
            & (table["forecaster"] == "esn")
            & (table["neurons"] == panel["neurons"])
            & (table["validation"] == panel["validation"])
            & table["prediction_time_lt"].isin(prediction_times_lt)
        ]
        by_time = {
            float(time): group.sort_values("low")
            for time, group in rows.groupby("prediction_time_lt")
        }
        bins = next(iter(by_time.values()))
        shown.append(
            ControlledDensity(
                title=f"Re = {bins['reynolds'].iloc[0]:g}" if "reynolds" in bins else case,
                bin_edges=np.append(bins["low"], bins["high"].iloc[-1]),
                threshold=panel["event_threshold"],
                # the flows that count differ a little between prediction times
                uncontrolled=_mean(by_time, ["density_uncontrolled"])[0],
                uncontrolled_band=_mean(
                    by_time, ["density_uncontrolled_low", "density_uncontrolled_high"]
                ),
                controlled={
                    time: group["density_controlled"].to_numpy() for time, group in by_time.items()
                },
                bands={
                    time: group[["density_controlled_low", "density_controlled_high"]].to_numpy().T
                    for time, group in by_time.items()
                },
            )
        )
    # NaN where no flow counts
    if any(np.isfinite(panel.uncontrolled).all() for panel in shown):
        return control_density(shown, symbol=symbol, name=observable_name)
    return nothing_to_show("No flow was free of events for long enough to be controlled.")


def _mean(by_time: Mapping[float, pd.DataFrame], columns: list[str]) -> FloatArray:
    """Means of columns over the prediction times, ``(columns, bins)``."""
    return np.asarray(np.mean([group[columns].to_numpy().T for group in by_time.values()], axis=0))


@styled
def control_density(
    cases: Sequence[ControlledDensity],
    *,
    symbol: str = "k",
    name: str = "kinetic energy",
) -> Figure:
    """Draw one panel per case, two beside each other, on logarithmic scale."""
    if not cases:
        raise ValueError("there is no case to draw")
    positive = [
        float(value)
        for case in cases
        for density in (case.uncontrolled, *case.controlled.values())
        for value in density[density > 0]
    ]
    if not positive:
        raise ValueError("no density is positive anywhere")
    # where no axis reaches: a density of zero has no logarithm
    lowest = 0.5 * min(positive)
    columns = min(2, len(cases))
    rows = (len(cases) + columns - 1) // columns
    figure = new_figure(DOUBLE_COLUMN if columns == 2 else SINGLE_COLUMN, 1.75 * rows + 0.5)
    panels = figure.subplots(rows, columns, sharex=True, sharey=True, squeeze=False).ravel()
    times = sorted({time for case in cases for time in case.controlled})
    colours = [BLUE, VERMILLION, PURPLE]
    dashes = [(0.0, (3.5, 1.2)), (0.0, (1.0, 1.0)), (0.0, (6.0, 1.5, 1.0, 1.5))]
    for index, (panel, case) in enumerate(zip(panels, cases, strict=False)):
        panel.stairs(
            case.uncontrolled,
            case.bin_edges,
            baseline=None,
            color=TRUTH["color"],
            linewidth=TRUTH["linewidth"],
            label="without control",
        )
        bands = [
            (colours[times.index(time) % len(colours)], band)
            for time, band in sorted(case.bands.items())
        ]
        if case.uncontrolled_band is not None:
            bands.insert(0, (GREY, case.uncontrolled_band))
        for colour, (low, high) in bands:
            panel.stairs(
                high,
                case.bin_edges,
                baseline=np.maximum(low, lowest),
                fill=True,
                color=colour,
                alpha=0.2,
                linewidth=0,
            )
        for time, density in sorted(case.controlled.items()):
            panel.stairs(
                density,
                case.bin_edges,
                baseline=None,
                color=colours[times.index(time) % len(colours)],
                linestyle=dashes[times.index(time) % len(dashes)],
                linewidth=1.2,
                label=f"control, PT = {time:g} LT",
            )
        panel.axvline(case.threshold, **THRESHOLD)
        panel.annotate(
            f"${symbol}_e$",
            (case.threshold, 1),
            (2.5, -3),
            panel.get_xaxis_transform(),
            "offset points",
            ha="left",
            va="top",
            color=THRESHOLD["color"],
        )
        letter = f"({chr(ord('a') + index)}) " if len(cases) > 1 else ""
        panel.set_title(f"{letter}{case.title}", loc="left")
        if index + columns >= len(cases):
            panel.set_xlabel(observable_label(symbol, name))
            panel.xaxis.set_tick_params(labelbottom=True)
    for panel in panels[len(cases) :]:
        panel.set_axis_off()
    for panel in panels[::columns]:
        panel.set_ylabel(density_label(symbol))
    panels[0].set_yscale("log")
    panels[0].set_ylim(0.6 * min(positive), 3 * max(positive))
    panels[0].set_xlim(
        min(float(case.bin_edges[0]) for case in cases),
        max(float(case.bin_edges[-1]) for case in cases),
    )
    banded = any(case.bands for case in cases)
    more = [band_handle("interval over flows")] if banded else []
    if columns == 2:
        legend_above(figure, panels[: len(cases)], more)
    else:
        panels[0].legend(
            handles=[*panels[0].get_legend_handles_labels()[0], *more], loc="upper right"
        )
    return figure
