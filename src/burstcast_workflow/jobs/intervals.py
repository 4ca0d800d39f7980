"""Cells of tables that have intervals."""

from typing import Any

from burstcast.arrays import FloatArray
from burstcast.resampled_score import ResampledScore
from burstcast.resampling import percentile_interval


def between(samples: FloatArray, confidence: float) -> dict[str, float]:
    """Both ends of the interval that resamples of a score tell."""
    low, high = percentile_interval(samples, confidence)
    return {"low": low, "high": high}


def with_interval(score: ResampledScore, confidence: float) -> dict[str, float]:
    """A score, and `between`."""
    return {"value": float(score.value), **between(score.samples, confidence)}


def with_ends(name: str, value: Any, low: Any, high: Any) -> dict[str, Any]:
    """A value in the column of its name, and the ends of its interval in columns beside it."""
    return {name: value, f"{name}_low": low, f"{name}_high": high}
