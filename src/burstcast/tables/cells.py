"""Cells of tables: values with the ends of their intervals, medians over networks."""

from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import Any

from burstcast.base.arrays import FloatArray
from burstcast.base.names import ForecasterName
from burstcast.base.resampled_score import ResampledScore, median_scores
from burstcast.base.resampling import percentile_interval

Scores = Mapping[str, ResampledScore]


def between(samples: FloatArray, confidence: float) -> dict[str, float]:
    """Both ends of the interval from resamples of a score."""
    low, high = percentile_interval(samples, confidence)
    return {"low": low, "high": high}


def with_interval(score: ResampledScore, confidence: float) -> dict[str, float]:
    """A score, and `between`."""
    return {"value": float(score.value), **between(score.samples, confidence)}


def with_ends(name: str, value: Any, low: Any, high: Any) -> dict[str, Any]:
    """A value in the column of its name, and the ends of its interval in columns beside it."""
    return {name: value, f"{name}_low": low, f"{name}_high": high}


def medians_over_seeds(
    scores_of_seeds: Iterable[tuple[ForecasterName, Scores]],
) -> dict[str, Scores]:
    """Scores by forecaster, with the median over networks that differ by their seeds.

    ``scores_of_seeds``: Forecasters or controllers, and their scores by name. Returns them by
    identifier, in the order in which they come; "median of" networks by what these share.
    """
    alike: dict[ForecasterName, list[tuple[str, Scores]]] = {}
    for name, scores in scores_of_seeds:
        common = replace(name, kind=name.keys["forecaster"], seed=None, role=None, label=None)
        identifier = replace(common, seed=name.seed).identifier
        alike.setdefault(common, []).append((identifier, scores))
    return dict(
        members[0]
        if len(members) == 1
        else (f"median of {common.identifier}", median_scores([scores for _, scores in members]))
        for common, members in alike.items()
    )
