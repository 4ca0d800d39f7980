"""How forecasts are cut into windows: all that forecasting knows of the classification."""

from collections.abc import Mapping
from typing import Any

from burstcast.arrays import BoolArray
from burstcast.forecast.windows import WindowSummaries
from burstcast.netcdf import Variable
from burstcast.units import NUMBER, OBSERVABLE
from burstcast_workflow.harness.storage import write_netcdf


def windows_of(settings: Mapping[str, Any]) -> tuple[float, int]:
    """Length of a window in Lyapunov times, and how many there are."""
    resolution = settings["classification.resolution_lt"]
    longest = settings["classification.longest_prediction_time_lt"]
    reach = longest + settings["classification.window_lt"]
    return resolution, round(reach / resolution) - 1


def write_forecasts(
    path: str,
    summaries: WindowSummaries,
    diverged: BoolArray,
    name: str,
    provenance: Mapping[str, str],
) -> None:
    """Write forecasts of the observable of that name, reduced to windows."""
    write_netcdf(
        path,
        {
            "first": Variable(
                ("point", "window"),
                summaries.first,
                OBSERVABLE,
                f"forecast {name} at the first step of each window",
            ),
            "largest": Variable(
                ("point", "window"),
                summaries.largest,
                OBSERVABLE,
                f"largest forecast {name} in a window",
            ),
            "diverged": Variable(("point",), diverged, NUMBER, "whether the forecast has diverged"),
        },
        provenance,
    )
