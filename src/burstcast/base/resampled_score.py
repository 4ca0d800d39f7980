"""A score with its values on resamples, for paired comparisons."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from burstcast.base.arrays import FloatArray


@dataclass(frozen=True)
class ResampledScore:
    """A score of all data, ``()``, and of each resample, ``(resamples,)``."""

    value: float | FloatArray
    samples: FloatArray

    def __sub__(self, other: "ResampledScore") -> "ResampledScore":
        """Paired difference over common resamples."""
        return ResampledScore(self.value - other.value, self.samples - other.samples)


def median_score(scores: Sequence[ResampledScore]) -> ResampledScore:
    """Median over the members of a committee, in each resample."""
    return ResampledScore(
        np.median([score.value for score in scores], axis=0),
        np.median([score.samples for score in scores], axis=0),
    )


def median_scores(members: Sequence[Mapping[str, ResampledScore]]) -> dict[str, ResampledScore]:
    """Medians over members, for each score that all members have."""
    return {name: median_score([scores[name] for scores in members]) for name in members[0]}
