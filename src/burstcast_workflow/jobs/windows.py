"""How forecasts are cut into windows: all that forecasting knows of the classification."""

from collections.abc import Mapping
from typing import Any


def windows_of(settings: Mapping[str, Any]) -> tuple[float, int]:
    """Length of a window in Lyapunov times, and how many there are."""
    resolution = settings["classification.resolution_lt"]
    longest = settings["classification.longest_prediction_time_lt"]
    reach = longest + settings["classification.window_lt"]
    return resolution, round(reach / resolution) - 1
