"""Probability density of the observable, and distances between two densities.

Source: section "Statistical prediction of extreme events" of the paper.
"""

import warnings
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from burstcast.base.arrays import FloatArray, IntArray
from burstcast.base.resampling import bootstrap_weights

SATURATED_ERROR = 1.0
"""Logarithmic error of a bin that is empty in either density (paper, below the MLE)."""

SETTLED = 0.01
"""Variation of an observable that has settled, in widths of its density's range."""


@dataclass(frozen=True)
class Histogram:
    """Counts of values in bins, which hold their lower edge; the last one holds both."""

    edges: FloatArray  #: edges of the bins, increasing, ``(bins + 1,)``
    counts: IntArray  #: values in each bin, ``(bins,)``
    #: below, above: values outside the range of the edges
    below: int = 0
    above: int = 0

    def __post_init__(self) -> None:
        check_edges(self.edges)
        if self.counts.shape != (len(self.edges) - 1,):
            raise ValueError(f"{len(self.edges)} edges do not bound {self.counts.shape} bins")
        if self.below < 0 or self.above < 0 or (self.counts < 0).any():
            raise ValueError("a histogram cannot hold negative counts")

    @property
    def inside(self) -> int:
        """Number of values in the bins."""
        return int(self.counts.sum())

    @property
    def density(self) -> FloatArray:
        """Probability density over the values inside the range, ``(bins,)``; NaN without any."""
        return self.counts / (self.inside or np.nan) / np.diff(self.edges)

    @property
    def cumulative(self) -> FloatArray:
        """Cumulative distribution at the edges, ``(bins + 1,)``; NaN without values inside."""
        return np.concatenate([[0], np.cumsum(self.counts)]) / (self.inside or np.nan)


def bin_edges(low: float, high: float, bins: int) -> FloatArray:
    """Edges of equal bins from ``low`` to ``high``, ``(bins + 1,)``."""
    return np.linspace(low, high, bins + 1)


def edges_over(values: FloatArray, bins: int) -> FloatArray:
    """Edges of equal bins from the smallest to the largest value, ``(bins + 1,)``."""
    return bin_edges(float(values.min()), float(values.max()), bins)


def check_edges(edges: FloatArray) -> None:
    """Raise ValueError unless these are the edges of at least one bin, increasing and finite."""
    if edges.ndim != 1 or len(edges) < 2 or not np.isfinite(edges).all():
        raise ValueError("a histogram needs at least two finite edges")
    if not (np.diff(edges) > 0).all():
        raise ValueError("the edges of a histogram must increase")


def slots(values: FloatArray, edges: FloatArray) -> IntArray:
    """Bin index of each value: 0 below the range, 1, 2, ... in the bins, bins + 1 above it."""
    if not np.isfinite(values).all():
        raise ValueError("a value that is not finite cannot be counted in a histogram")
    indices = np.searchsorted(edges, values, side="right")
    # the last bin holds its upper edge, too
    indices[values == edges[-1]] = len(edges) - 1
    return indices


def from_slots(edges: FloatArray, counts: IntArray) -> Histogram:
    """Histogram from the counts ``(bins + 2,)`` by the indices of `slots`."""
    return Histogram(edges, counts[1:-1], below=int(counts[0]), above=int(counts[-1]))


def histogram(values: FloatArray, edges: FloatArray) -> Histogram:
    """Count values, of any shape, in bins.

    Examples
    --------
    >>> import numpy as np
    >>> from burstcast.statistics.densities import bin_edges, histogram
    >>> histogram(np.array([0.1, 0.2, 0.7]), bin_edges(0.0, 1.0, 2)).counts.tolist()
    [2, 1]
    """
    check_edges(edges)
    indices = slots(values, edges)
    return from_slots(
        edges, np.bincount(indices.ravel(), minlength=len(edges) + 1).astype(np.int64)
    )


def mean_density(histograms: Sequence[Histogram]) -> FloatArray:
    """Mean of the densities of histograms with values in their range, ``(bins,)``."""
    if not histograms:
        raise ValueError("there is no density to average")
    for other in histograms[1:]:
        _check_common_bins(histograms[0], other)
    filled = [histogram.density for histogram in histograms if histogram.inside]
    if not filled:
        return histograms[0].density
    mean: FloatArray = np.mean(filled, axis=0)
    return mean


def density_interval(
    edges: FloatArray,
    counts: Sequence[IntArray],
    rows: Sequence[IntArray],
    *,
    resamples: int,
    confidence: float,
    generator: np.random.Generator,
) -> FloatArray:
    """Bootstrap interval of a mean density over flows, ``(2, bins)``.

    ``counts``: Of each density, values of each flow in each bin, ``(flows, bins)``. ``rows``: Row
    of each of these flows, ``(flows,)``: densities that share a flow are resampled with it.
    """
    drawn, places = np.unique(np.concatenate(rows), return_inverse=True)
    weights = bootstrap_weights(max(len(drawn), 1), resamples, generator)
    ends = np.cumsum([len(flows) for flows in rows])[:-1]
    densities = []
    for flows, places_of in zip(counts, np.split(places, ends), strict=True):
        sums = (weights[:, places_of] @ flows).astype(np.float64)
        inside = sums.sum(axis=1, keepdims=True)
        densities.append(sums / np.where(inside > 0, inside, np.nan) / np.diff(edges))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)  # of means of nothing
        samples = np.nanmean(densities, axis=0)
        tail = (1 - confidence) / 2
        return np.asarray(np.nanquantile(samples, [tail, 1 - tail], axis=0))


def kantorovich_metric(first: Histogram, second: Histogram) -> float:
    """Integral of the absolute difference of two cumulative distributions (paper, section 6).

    The distributions are straight in each bin: the integral is exact, also where they cross within
    a bin. In units of the observable; NaN where a histogram has no values inside its range.

    Examples
    --------
    >>> import numpy as np
    >>> from burstcast.statistics.densities import bin_edges, histogram, kantorovich_metric
    >>> edges = bin_edges(0.0, 1.0, 10)
    >>> first, second = histogram(np.full(5, 0.25), edges), histogram(np.full(5, 0.55), edges)
    >>> round(kantorovich_metric(first, second), 3)
    0.3
    """
    _check_common_bins(first, second)
    difference = first.cumulative - second.cumulative
    left, right = difference[:-1], difference[1:]
    bases = np.abs(left) + np.abs(right)
    # a trapezium, or two triangles where the sign changes
    triangles = (np.square(left) + np.square(right)) / np.where(bases > 0, bases, 1)
    areas = 0.5 * np.where(left * right < 0, triangles, bases) * np.diff(first.edges)
    return float(areas.sum())


def mean_logarithmic_error(first: Histogram, second: Histogram) -> float:
    """Mean over the bins of the difference of the densities' decimal logarithms (paper, MLE).

    A bin that is empty in either density counts an error of one.
    """
    _check_common_bins(first, second)
    if first.inside == 0 or second.inside == 0:
        return float("nan")
    errors = np.full(len(first.counts), SATURATED_ERROR)
    filled = (first.counts > 0) & (second.counts > 0)
    errors[filled] = np.abs(np.log10(first.density[filled]) - np.log10(second.density[filled]))
    return float(errors.mean())


def _check_common_bins(first: Histogram, second: Histogram) -> None:
    if not np.array_equal(first.edges, second.edges):
        raise ValueError("histograms can only be compared on common bins")
