"""(a-c) Profiles of the velocity along x, its square and the Reynolds stress, averaged over x, z
and time, of all data, the training set and one network: the one of the shown size and strategy
with the smallest Kantorovich metric. (d-f) Errors of the profiles, normalised by the
range of the true profile, against reservoir size: medians and quartiles over the networks of an
ensemble. Thin bars: the bootstrap interval of one network over its closed loops, in the median. In
grey: the same errors between two random halves of the data, in the median. Open markers, if any:
published values; diamonds on the right edge: the published training set. U_0: velocity of the
laminar flow halfway between centre and wall; h: half the distance of the walls.
"""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from burstcast.arrays import FloatArray
from burstcast.figures.parts.best_network import best_of
from burstcast.figures.parts.percentile_curves import (
    published_handles,
    require_single_case,
    spread_handles,
)
from burstcast.figures.parts.statistics_by_size import draw_statistics_by_size
from burstcast.figures.parts.style import (
    DOUBLE_COLUMN,
    NETWORK,
    TRAINING,
    TRUTH,
    legend_above,
    letter_panels,
    new_figure,
    styled,
)
from burstcast.figures.registry import Declaration
from burstcast.statistics.profiles import velocity_profiles
from burstcast.statistics.reductions import LongTermStatistics
from burstcast.systems.mfe_modes import flow_modes
from burstcast.systems.registry import make_system
from burstcast.tables.published import published_beside

FIGURE = Declaration(
    section="long_term",
    position=20,
    inputs={
        "data": "case/statistics_data.nc",
        "training": "case/statistics_training.nc",
        "long_term": "long_term_networks/long_term.nc",
        "percentiles": "case/tables/statistics_percentiles.csv",
        "intervals": "case/tables/statistics_intervals.csv",
    },
    settings={
        "points": "statistics.profile_points",
        "system": "case.system",
        "parameters": "case.parameters",
    },
    cases="long_term",
    only_flows=True,
    published=True,
)

PROFILES = {
    "nrmse_u": r"$\langle \overline{u} \rangle$",
    "nrmse_uu": r"$\langle \overline{u^2} \rangle$",
    "nrmse_uv": r"$\langle \overline{uv} \rangle$",
}


def draw(
    *,
    data: Mapping[str, Any],
    training: Mapping[str, Any],
    long_term: Sequence[Mapping[str, Any]],
    percentiles: pd.DataFrame,
    intervals: pd.DataFrame,
    points: int,
    system: str,
    parameters: Mapping[str, float],
    published: pd.DataFrame | None = None,
) -> Figure:
    """Draw the data, the training set and the best network, and the errors of all networks.

    Profiles have so many ``points``.
    """
    y = np.linspace(-1.0, 1.0, points)
    modes = flow_modes(make_system(system, parameters))
    assert modes is not None
    matrices = modes.profile_matrices(y)

    def profiles(statistics: LongTermStatistics) -> FloatArray:
        found = velocity_profiles(matrices, statistics.moments)
        return np.stack([found.u, found.uu, found.uv])

    best = best_of(data, long_term)
    return profile_errors(
        y,
        profiles(LongTermStatistics.from_arrays(data)),
        profiles(LongTermStatistics.from_arrays(training)),
        None if best is None else profiles(best.statistics),
        percentiles,
        intervals,
        network_label="" if best is None else best.label,
        published=published_beside(percentiles, published, "statistics"),
    )


@styled
def profile_errors(
    y: FloatArray,
    true: FloatArray,
    training: FloatArray,
    network: FloatArray | None,
    percentiles: pd.DataFrame,
    intervals: pd.DataFrame,
    *,
    network_label: str = "ESN (best)",
    published: pd.DataFrame | None = None,
) -> Figure:
    """Draw (a-c) the profiles of u, u^2 and uv and (d-f) the errors against reservoir size.

    ``y``: Distance from the midplane, ``(points_y,)``. ``true``, ``training``, ``network``:
    Averages over x, z and time, ``(3, points_y)``: of u, u^2 and uv. The network is the best one of
    its size, None if no network has any. ``percentiles``: Percentiles of one case: forecaster
    (``esn``, ``training``, ``floor``), neurons, validation, metric (``nrmse_u``, ``nrmse_uu``,
    ``nrmse_uv``), p25, p50, p75.
    """
    require_single_case(percentiles)
    figure = new_figure(DOUBLE_COLUMN, 4.0)
    panels = figure.subplots(2, 3)
    units = ("$U_0$", "$U_0^2$", "$U_0^2$")
    labels = zip(panels[0], PROFILES.values(), units, strict=True)
    for index, (profile, label, unit) in enumerate(labels):
        profile.plot(true[index], y, label="True", **TRUTH)
        profile.plot(training[index], y, label="Train", **TRAINING)
        if network is not None:
            profile.plot(network[index], y, label=network_label, **NETWORK)
        profile.set_xlabel(f"{label} [{unit}]")
        profile.set_ylim(float(y[0]), float(y[-1]))
        profile.set_ylabel("$y$ [$h$]")
    errors = dict(zip(PROFILES, panels[1], strict=True))
    draw_statistics_by_size(errors, percentiles, intervals, published)
    more = [*spread_handles(panels.flat), *published_handles(panels.flat)]
    legend_above(figure, [panels[0, 0], panels[1, 0]], more, columns=4)
    letter_panels(list(panels.flat))
    return figure
