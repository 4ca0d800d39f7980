"""How forecasts are cut into windows: all that forecasting knows of the classification."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from burstcast.forecast.windows import WindowForecasts
from burstcast.netcdf import Variable, read_netcdf
from burstcast.units import NUMBER, OBSERVABLE
from burstcast_workflow.harness.storage import write_netcdf


def windows_of(settings: Mapping[str, Any]) -> tuple[float, int]:
    """Length of a window in Lyapunov times, and how many there are."""
    resolution = settings["classification.resolution_lt"]
    longest = settings["classification.longest_prediction_time_lt"]
    reach = longest + settings["classification.window_lt"]
    return resolution, round(reach / resolution) - 1


def write_forecasts(
    path: str, forecasts: WindowForecasts, name: str, provenance: Mapping[str, str]
) -> None:
    """Write forecasts of the observable called ``name``, and those of an ensemble's members."""
    points, members = ("point", "window"), ("point", "member", "window")
    first = f"forecast {name} at the first step of each window"
    largest = f"largest forecast {name} in each window"
    lost = "whether the forecast has diverged"
    variables = {
        "first": Variable(points, forecasts.first, OBSERVABLE, first),
        "largest": Variable(points, forecasts.largest, OBSERVABLE, largest),
        "diverged": Variable(("point",), forecasts.diverged, NUMBER, lost),
    }
    if forecasts.member_first.size:
        for name, meaning in (("member_first", first), ("member_largest", largest)):
            values = getattr(forecasts, name)
            variables[name] = Variable(members, values, OBSERVABLE, f"{meaning}, by each member")
    write_netcdf(path, variables, provenance)


def read_forecasts(path: str) -> WindowForecasts:
    """Read the forecasts that `write_forecasts` wrote."""
    found = read_netcdf(path)
    none = np.empty((len(found["first"]), 0, found["first"].shape[1]))
    return WindowForecasts(**{"member_first": none, "member_largest": none, **found})
