"""Long-term statistics: the best network, and errors against reservoir size."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes

from burstcast.figures.parts import looks, medians
from burstcast.statistics.measures import BestNetwork, best_network
from burstcast.statistics.reductions import LongTermStatistics

_LARGEST_LINEAR_RATIO = 20.0
"""Values of a panel that differ by more than this factor make all axes logarithmic."""


def best_of(data: Mapping[str, Any], long_term: Sequence[Mapping[str, Any]]) -> BestNetwork | None:
    """Network whose long-term statistics are nearest to the data's; None if none has any.

    ``data``: File of the data's statistics. ``long_term``: Files of the networks' statistics; each
    says its ``neurons`` and ``seed``.
    """
    statistics = {
        (file["neurons"], file["seed"]): LongTermStatistics.from_arrays(file) for file in long_term
    }
    return best_network(LongTermStatistics.from_arrays(data), statistics)


def several_sizes(percentiles: pd.DataFrame) -> bool:
    """Whether there are networks of more than one size: errors against it make a curve."""
    return percentiles.loc[percentiles["forecaster"] == "esn", "neurons"].nunique() > 1


def draw(panels: Mapping[str, Axes], percentiles: pd.DataFrame, published: pd.DataFrame) -> None:
    """Draw statistics' errors against reservoir size, with the training set and the floor.

    ``panels``: Where to draw, by metric; all have axes of one kind, so that they can be compared.
    """
    networks = percentiles[percentiles["forecaster"] == "esn"]
    sizes = sorted(networks["neurons"].dropna().unique())
    of_sizes = published[published["neurons"].isin(sizes)]
    for metric, axes in panels.items():
        for validation, look, _ in medians.validations(networks):
            curves = axes, networks, of_sizes, {"metric": metric, "validation": validation}
            medians.draw_both(*curves, "neurons", look, label=f"ESN, {validation}")
        for forecaster, line, label in (
            ("training", looks.TRAINING, "Train"),
            ("floor", looks.FLOOR, "half of the data against the other half"),
        ):
            for value in medians.select(percentiles, metric=metric, forecaster=forecaster)["p50"]:
                axes.axhline(float(value), label=label, **line)
        theirs = medians.select(published, metric=metric, forecaster="training")
        medians.draw_published_level(axes, theirs, looks.TRAINING["color"])
        axes.set_xticks(sizes)
        medians.thin_size_labels(axes, sizes)
        axes.set_xlabel(medians.NEURONS)
        axes.set_ylabel(medians.LABELS[metric])
    logarithmic = any(_spread(percentiles, metric) > _LARGEST_LINEAR_RATIO for metric in panels)
    for axes in panels.values():
        if logarithmic:
            axes.set_yscale("log")
        else:
            axes.set_ylim(0, 1.08 * axes.dataLim.y1)


def _spread(percentiles: pd.DataFrame, metric: str) -> float:
    """Largest over least of what is shown of a metric; 1 where there is nothing, or a zero."""
    shown = percentiles.loc[percentiles["metric"] == metric, ["p25", "p50", "p75"]].to_numpy()
    least, largest = np.nanmin(shown, initial=np.inf), np.nanmax(shown, initial=0.0)
    return float(largest / least) if 0.0 < least <= largest else 1.0
