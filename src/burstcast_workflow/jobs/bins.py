"""Bins of histograms from a job's settings."""

from collections.abc import Mapping
from typing import Any

from burstcast.arrays import FloatArray
from burstcast.statistics.densities import bin_edges

Settings = Mapping[str, Any]


def edges_of(density: Settings) -> FloatArray:
    """Edges of equal bins from the setting ``density`` of a case, or its like under control."""
    low, high = density["range"]
    return bin_edges(low, high, density["bins"])
