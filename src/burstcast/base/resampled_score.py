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


def median_scores(members: Sequence[Mapping[str, ResampledScore]]) -> dict[str, ResampledScore]:
    """Medians over the members of a committee, in each resample, for each score that all have."""
    return {
        name: ResampledScore(
            np.median([scores[name].value for scores in members], axis=0),
            np.median([scores[name].samples for scores in members], axis=0),
        )
        for name in members[0]
    }
