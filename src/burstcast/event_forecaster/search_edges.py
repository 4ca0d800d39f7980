"""Searches for hyperparameters that ended on the edge of the search range."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from burstcast.statistics.warning_signs import optimum_on_edge
from burstcast.tuning.negligible_ridge import negligible_ridge


def search_edges(
    found: Sequence[Mapping[str, Any]], parameters: Mapping[str, Any], shape: tuple[int, ...]
) -> Iterator[str]:
    """Sentences about hyperparameters that most networks have on the edge of their search.

    ``found``: Hyperparameters of each network, by name; none of other kinds of forecasters.
    ``parameters``: Parameters of `burstcast.EventForecaster`, by name. ``shape``: Shape of the
    training series, ``(series, time, component)``.
    """
    least = negligible_ridge(parameters["neurons"], shape[0] * shape[1])
    for name in ("spectral_radius", "input_scaling", "tikhonov"):
        values, searched = [one[name] for one in found], parameters[name]
        lost = least if name == "tikhonov" else 0.0
        for finding in optimum_on_edge(name, values, min(searched), max(searched), lost):
            yield f"the search ended on its edge, {finding.text}: search beyond it ({name})"
