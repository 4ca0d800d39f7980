"""The Brier score, its skill against climatology, and its decomposition.

Sources: Brier, Monthly Weather Review 78 (1950); Murphy, Journal of Applied Meteorology 12 (1973);
Stephenson, Coelho & Jolliffe, Weather and Forecasting 23 (2008), for bins that hold several
probabilities.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from burstcast.base.arrays import FloatArray, IntArray
from burstcast.forecasts.classification import ratio
from burstcast.forecasts.outcomes import Outcomes


def base_rate(outcomes: Outcomes) -> FloatArray:
    """Share of the forecasts that an event followed; NaN without forecasts."""
    return ratio(outcomes.events.sum(axis=-1), outcomes.points.sum(axis=-1))


def brier_score(outcomes: Outcomes) -> FloatArray:
    """Mean square difference between probability and outcome (1: event, 0: none)."""
    levels, events = outcomes.levels, outcomes.events
    errors = events * (1 - levels) ** 2 + (outcomes.points - events) * levels**2
    return ratio(errors.sum(axis=-1), outcomes.points.sum(axis=-1))


def brier_skill(outcomes: Outcomes) -> FloatArray:
    """Brier skill score: 1 - Brier score / uncertainty of the sample.

    1 is perfect, 0 as good as climatology; NaN where all outcomes are alike. The climatology is the
    sample's own, which knows more than any forecaster could: the strictest reference.

    Examples
    --------
    >>> import numpy as np
    >>> from burstcast.forecasts.brier import brier_skill
    >>> from burstcast.forecasts.outcomes import Outcomes
    >>> outcomes = Outcomes(np.array([0.1, 0.9]), np.array([90, 10]), events=np.array([9, 9]))
    >>> round(float(brier_skill(outcomes)), 3)
    0.39
    """
    rate = base_rate(outcomes)
    return np.asarray(1 - ratio(brier_score(outcomes), rate * (1 - rate)))


@dataclass(frozen=True)
class Binned:
    """Outcomes in equally wide bins of the probability; arrays of shape ``(..., bins)``."""

    #: points, events: forecasts in each bin, and how many of them an event followed
    points: IntArray
    events: IntArray
    #: mean probability of the forecasts in the bin; NaN where there are none
    mean_probability: FloatArray

    @property
    def frequency(self) -> FloatArray:
        """Share of the forecasts in each bin that an event followed; NaN in empty bins."""
        return ratio(self.events, self.points)


def bin_of(levels: FloatArray, bins: int) -> IntArray:
    """Bin of each probability: bin i holds [i, i + 1) / bins; the last one also holds 1."""
    if ((levels < 0) | (levels > 1)).any():
        raise ValueError("probabilities lie between 0 and 1")
    # a share of votes that rounding has put just below its bin's edge belongs into that bin
    return np.minimum(np.floor(levels * bins + 1e-9), bins - 1).astype(np.int64)


def binned(outcomes: Outcomes, bins: int) -> Binned:
    """Gather outcomes in equally wide bins of the probability."""
    # bins rise with the levels: levels of a bin lie side by side
    present, first = np.unique(bin_of(outcomes.levels, bins), return_index=True)

    def gather(values: FloatArray | IntArray) -> npt.NDArray[Any]:
        sums = np.zeros((*values.shape[:-1], bins), dtype=values.dtype)
        if first.size:
            sums[..., present] = np.add.reduceat(values, first, axis=-1)
        return sums

    points, events = gather(outcomes.points), gather(outcomes.events)
    return Binned(points, events, ratio(gather(outcomes.points * outcomes.levels), points))


def decomposition(outcomes: Outcomes, bins: int) -> dict[str, FloatArray]:
    """Decompose the Brier score over equally wide bins of the probability.

    The score is reliability - resolution + uncertainty. ``reliability``: Mean square difference
    between a bin's probability and how often events followed: 0 is best. ``resolution``: How far
    the bins' frequencies lie from the base rate: large is good. It is the generalised one of
    Stephenson et al., which takes up what varies within bins, so that the parts add up.
    ``uncertainty``: Variance of the outcomes: the Brier score of climatology.
    """
    whole, rate = binned(outcomes, bins), base_rate(outcomes)
    count = outcomes.points.sum(axis=-1)
    # where a bin is empty, its terms are zero
    mean, frequency = np.nan_to_num(whole.mean_probability), np.nan_to_num(whole.frequency)
    reliability = (whole.points * (mean - frequency) ** 2).sum(axis=-1)
    between = (whole.points * (frequency - rate[..., np.newaxis]) ** 2).sum(axis=-1)
    column = bin_of(outcomes.levels, bins)
    offset = outcomes.levels - mean[..., column]
    variance = (outcomes.points * offset**2).sum(axis=-1)
    covariance = ((outcomes.events - outcomes.points * frequency[..., column]) * offset).sum(
        axis=-1
    )
    return {
        "reliability": ratio(reliability, count),
        "resolution": ratio(between - variance + 2 * covariance, count),
        "uncertainty": np.asarray(rate * (1 - rate)),
    }


def calibration_error(outcomes: Outcomes, bins: int) -> FloatArray:
    """Mean |mean probability - frequency| over the bins' forecasts (Naeini et al., AAAI 2015)."""
    whole = binned(outcomes, bins)
    gaps = whole.points * np.abs(np.nan_to_num(whole.mean_probability - whole.frequency))
    return ratio(gaps.sum(axis=-1), outcomes.points.sum(axis=-1))
