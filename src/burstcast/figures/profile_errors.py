"""Velocity profiles of the flow, and the errors in them against reservoir size."""

import pandas as pd
from matplotlib.figure import Figure

from burstcast.arrays import FloatArray
from burstcast.figures.parts.percentile_curves import (
    published_handles,
    require_single_case,
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

PROFILES = {
    "nrmse_u": r"$\langle \overline{u} \rangle$",
    "nrmse_uu": r"$\langle \overline{u^2} \rangle$",
    "nrmse_uv": r"$\langle \overline{uv} \rangle$",
}


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

    Parameters
    ----------
    y
        Distance from the midplane, ``(points_y,)``.
    true, training, network
        Averages over x, z and time, ``(3, points_y)``: of u, u^2 and uv. The network is the best
        one of its size, None if no network has any.
    percentiles
        Of one case: forecaster (``esn``, ``training``, ``floor``), neurons, validation, metric
        (``nrmse_u``, ``nrmse_uu``, ``nrmse_uv``), p25, p50, p75.
    intervals
        Of the same case and each network by itself: neurons, validation, metric, low, high.
    network_label
        Of the network in the legend.
    published
        Published percentiles in the same form, drawn as open markers at the sizes of the table;
        those of the training set as an open marker on the right edge.

    Raises
    ------
    ValueError
        If the table holds several cases.
    """
    require_single_case(percentiles)
    figure = new_figure(DOUBLE_COLUMN, 4.0)
    panels = figure.subplots(2, 3)
    for index, (profile, label) in enumerate(zip(panels[0], PROFILES.values(), strict=True)):
        profile.plot(true[index], y, label="True", **TRUTH)
        profile.plot(training[index], y, label="Train", **TRAINING)
        if network is not None:
            profile.plot(network[index], y, label=network_label, **NETWORK)
        profile.set_xlabel(label)
        profile.set_ylim(float(y[0]), float(y[-1]))
        profile.set_ylabel("$y$")
    errors = dict(zip(PROFILES, panels[1], strict=True))
    draw_statistics_by_size(errors, percentiles, intervals, published)
    more = published_handles(panels.flat)
    legend_above(figure, [panels[0, 0], panels[1, 0]], more)
    letter_panels(list(panels.flat))
    return figure
