"""Analysis of variance of a balanced design, by the method of moments.

Source: Searle, Casella & McCulloch, Variance Components (Wiley 1992), chapter 4.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy

from burstcast.base.arrays import FloatArray


@dataclass(frozen=True)
class FactorVariance:
    """Contribution of one factor."""

    degrees: int  #: degrees of freedom
    #: sum of the squares of the factor's effects in all cells, divided by ``degrees``; NaN without
    #: a degree of freedom
    mean_square: float
    #: standard deviation of the factor's effect: the root of its component of variance, which is
    #: its mean square less the residual one, over the number of cells of a level. 0 where levels
    #: differ by no more than the residual explains; NaN without a degree of freedom.
    standard_deviation: float


@dataclass(frozen=True)
class AnalysisOfVariance:
    """Analysis of variance by main effects."""

    mean: float
    factors: tuple[FactorVariance, ...]  #: effects of the factors, in the order of the axes
    #: effect of all interactions together; its standard deviation is the root of its mean square
    residual: FactorVariance


def analysis_of_variance(values: FloatArray) -> AnalysisOfVariance:
    """Separate the main effects of crossed factors, with one value in each cell.

    ``values``: An axis for each factor, its levels along the axis. The residual is what no main
    effect explains; without degrees of freedom it is unknown, and taken as zero in the components.

    >>> analysis = analysis_of_variance(np.array([[1.0, 2.0], [4.0, 5.0]]))
    >>> [round(part.mean_square, 6) for part in (*analysis.factors, analysis.residual)]
    [9.0, 1.0, 0.0]
    """
    if values.size == 0 or not np.isfinite(values).all():
        raise ValueError("every cell of a balanced design needs a value")
    mean, axes = float(values.mean()), range(values.ndim)
    squares, degrees = [], []
    for axis in axes:
        means = values.mean(axis=tuple(other for other in axes if other != axis))
        squares.append(float(np.square(means - mean).sum()) * values.size / len(means))
        degrees.append(len(means) - 1)
    total = float(np.square(values - mean).sum())
    left = values.size - 1 - sum(degrees)
    unexplained = _mean_square(max(0.0, total - sum(squares)), left)
    noise = unexplained if left else 0.0
    factors = []
    for axis, (square, free) in enumerate(zip(squares, degrees, strict=True)):
        mean_square = _mean_square(square, free)
        component = (mean_square - noise) * values.shape[axis] / values.size
        deviation = float(np.sqrt(max(0.0, component))) if free else float("nan")
        factors.append(FactorVariance(free, mean_square, deviation))
    residual = FactorVariance(left, unexplained, float(np.sqrt(unexplained)))
    return AnalysisOfVariance(mean, tuple(factors), residual)


def _mean_square(squares: float, degrees: int) -> float:
    return squares / degrees if degrees else float("nan")


def student_quantile(degrees: int, confidence: float) -> float:
    """Half-width of a two-sided interval in standard errors, by Student's distribution."""
    if degrees <= 0:
        return float("nan")
    return float(scipy.special.stdtrit(degrees, 0.5 + 0.5 * confidence))


def mean_and_margin(values: Sequence[float], confidence: float) -> tuple[float, float]:
    """Mean of independent values, and half the width of its Student interval, or NaN."""
    count = len(values)
    error = np.std(values, ddof=1) / np.sqrt(count) if count > 1 else np.nan
    return float(np.mean(values)), float(student_quantile(count - 1, confidence) * error)
