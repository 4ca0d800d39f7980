"""Binary classification of extreme events: counts, precision, recall, F-score.

Source: section "Precision and recall" of the paper. Scoring does not depend on the forecaster.
"""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from burstcast.base.arrays import FloatArray, IntArray

SCORES = ("precision", "recall", "f_score")
"""Names of the scores: properties of `ContingencyTable`."""


@dataclass(frozen=True)
class ContingencyTable:
    """How many forecasts of each outcome there are; integers, or arrays of one shape.

    Examples
    --------
    >>> from burstcast.forecasts.classification import ContingencyTable
    >>> counts = ContingencyTable(8, false_positive=2, false_negative=4, true_negative=86)
    >>> float(counts.precision), round(float(counts.recall), 3), round(float(counts.f_score), 3)
    (0.8, 0.667, 0.727)
    """

    true_positive: IntArray
    false_positive: IntArray
    false_negative: IntArray
    true_negative: IntArray

    @property
    def precision(self) -> FloatArray:
        """TP / (TP + FP); NaN without any alarm."""
        return ratio(self.true_positive, self.true_positive + self.false_positive)

    @property
    def recall(self) -> FloatArray:
        """TP / (TP + FN); NaN without any event."""
        return ratio(self.true_positive, self.true_positive + self.false_negative)

    @property
    def f_score(self) -> FloatArray:
        """2 TP / (2 TP + FP + FN); NaN where nothing was predicted and nothing happened."""
        return ratio(
            2 * self.true_positive,
            2 * self.true_positive + self.false_positive + self.false_negative,
        )


def ratio(numerator: npt.ArrayLike, denominator: npt.ArrayLike) -> FloatArray:
    """Quotient that is NaN, without a warning, where the denominator is zero."""
    top = np.asarray(numerator, dtype=np.float64)
    bottom = np.asarray(denominator, dtype=np.float64)
    return np.divide(top, bottom, out=np.full_like(bottom, np.nan), where=bottom != 0)
