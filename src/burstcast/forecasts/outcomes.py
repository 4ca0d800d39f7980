"""Outcomes by forecast probability, from which scores of probabilities are computed.

Forecasts are counted by series, so that intervals of scores resample whole series: starting points
of one series are not independent. Scores are functions of the counts summed over series.
"""

from dataclasses import dataclass

import numpy as np

from burstcast.base.arrays import BoolArray, FloatArray, IntArray


@dataclass(frozen=True)
class Outcomes:
    """Counts of forecasts by their value."""

    #: distinct values of forecasts, rising, ``(levels,)``: probabilities, or any score that rises
    #: with the probability
    levels: FloatArray
    #: forecasts of each level, ``(..., levels)``: by series, summed over series, or by resample
    points: IntArray
    events: IntArray  #: forecasts of each level that an event followed, ``(..., levels)``

    def total(self) -> "Outcomes":
        """Sum over all series."""
        return Outcomes(self.levels, self.points.sum(axis=-2), self.events.sum(axis=-2))

    def resampled(self, weights: IntArray) -> "Outcomes":
        """Sums over resampled series, by their weights ``(resamples, series)``."""
        # counts are whole numbers below 2^53: exact, and BLAS computes the product
        factors = weights.astype(np.float64)
        return Outcomes(
            self.levels,
            np.rint(factors @ self.points).astype(np.int64),
            np.rint(factors @ self.events).astype(np.int64),
        )

    def at(self, values: FloatArray) -> "Outcomes":
        """Outcomes with new values, never falling, for the levels; levels of NaN are left out."""
        defined = ~np.isnan(values)
        if (np.diff(values[defined]) < 0).any():
            raise ValueError("values that fall would change the order of the forecasts")
        points, events = self.points[..., defined], self.events[..., defined]
        levels, first = np.unique(values[defined], return_index=True)
        if not levels.size:
            return Outcomes(levels, points, events)
        return Outcomes(
            levels,
            np.add.reduceat(points, first, axis=-1),
            np.add.reduceat(events, first, axis=-1),
        )


def outcomes_by_series(
    forecast: FloatArray, happened: BoolArray, scored: BoolArray, series: IntArray, count: int
) -> Outcomes:
    """Count the outcomes of forecasts in each of ``count`` series, ``(count, levels)``.

    ``forecast``, ``happened``, ``scored``, ``series``: Probability or score of each starting point,
    whether an event followed, whether it counts, and its series, ``(points,)``.
    """
    values, rows, true = forecast[scored], series[scored], happened[scored]
    if not np.isfinite(values).all():
        raise ValueError("a probability or score is not finite")
    levels, column = np.unique(values, return_inverse=True)
    shape = (count, levels.size)
    cell = rows * levels.size + column

    def tally(cells: IntArray) -> IntArray:
        counts = np.bincount(cells, minlength=shape[0] * shape[1]).astype(np.int64)
        return counts.reshape(shape)

    return Outcomes(levels, tally(cell), tally(cell[true]))
