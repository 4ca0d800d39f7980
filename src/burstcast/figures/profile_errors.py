"""(a-c) Profiles of the velocity along x, its square and the Reynolds stress, averaged over x, z
and time, of all data, the training set and one network: the one of the shown size and strategy
with the smallest Kantorovich metric. (d-f) Errors of the profiles, normalised by the
range of the true profile, against reservoir size, where there are several sizes: medians and
quartiles over the networks of an ensemble. In grey: the same errors between two random halves of
the data, in the median. Open markers, if any: published values; diamonds on the right edge: the
published training set. U_0: velocity of the laminar flow halfway between centre and wall; h: half
the distance of the walls.
"""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from burstcast.base.declared import at, read
from burstcast.figures.parts import errors, looks, medians, style
from burstcast.figures.parts.published import published_beside
from burstcast.figures.registry import figure
from burstcast.statistics.profiles import equally_spaced_profiles
from burstcast.statistics.reductions import LongTermStatistics
from burstcast.systems.registry import make_system

_LABELS = {
    "nrmse_u": r"$\langle \overline{u} \rangle$ [$U_0$]",
    "nrmse_uu": r"$\langle \overline{u^2} \rangle$ [$U_0^2$]",
    "nrmse_uv": r"$\langle \overline{uv} \rangle$ [$U_0^2$]",
}


@figure(section="long_term", position=20, cases="long_term", only_flows=True)
def draw(
    *,
    data: Mapping[str, Any] = read("case/statistics_data.nc"),
    training: Mapping[str, Any] = read("case/statistics_training.nc"),
    long_term: Sequence[Mapping[str, Any]] = read("long_term_networks/long_term.nc"),
    percentiles: pd.DataFrame = read("case/tables/statistics_percentiles.csv"),
    points: int = at("statistics.profile_points"),
    system: str = at("case.system"),
    parameters: Mapping[str, float] = at("case.parameters"),
    published: pd.DataFrame | None = None,
) -> Figure:
    """Draw the data, the training set and the best network, and the errors of all networks."""
    y = np.linspace(-1.0, 1.0, points)
    matrices = equally_spaced_profiles(make_system(system, parameters), points)
    assert matrices is not None
    true, trained = (LongTermStatistics.from_arrays(file) for file in (data, training))
    best = errors.best_of(data, long_term)
    shown = [(true, looks.TRUTH, "True"), (trained, looks.TRAINING, "Train")]
    if best is not None:
        shown.append((best.statistics, looks.NETWORK, best.label))
    several = errors.several_sizes(percentiles)
    figure = style.new_figure(style.DOUBLE_COLUMN, 4.0 if several else 2.2)
    panels = figure.subplots(2 if several else 1, 3, squeeze=False)
    for statistics, look, name in shown:
        moments = statistics.moments
        profiles = matrices.profiles(moments.mean, moments.mean_product)
        for axes, profile in zip(panels[0], profiles, strict=True):
            axes.plot(profile, y, label=name, **look)
    for axes, label in zip(panels[0], _LABELS.values(), strict=True):
        axes.set_xlabel(label)
        axes.set_ylim(float(y[0]), float(y[-1]))
        axes.set_ylabel("$y$ [$h$]")
    if not several:
        style.legend_above(figure, [panels[0, 0]])
        style.letter_panels(list(panels.flat))
        return figure
    theirs = published_beside(percentiles, published, "statistics")
    errors.draw(dict(zip(_LABELS, panels[1], strict=True)), percentiles, theirs)
    more = [*medians.spread_handles(panels.flat), *medians.published_handles(panels.flat)]
    style.legend_above(figure, [panels[0, 0], panels[1, 0]], more, columns=4)
    style.letter_panels(list(panels.flat))
    return figure
