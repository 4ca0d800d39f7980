"""Series reduced to a histogram and moments, for long-term statistics.

They are summed step by step in the order of time, so that they do not depend on how the series are
cut up; but for products of many components, which are summed by matrix products.
"""

import itertools
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import Annotated, Any

import numpy as np

from burstcast.base.arrays import BoolArray, FloatArray, IntArray
from burstcast.base.files.described import Described
from burstcast.base.files.units import COMPONENT, COMPONENT_PRODUCT, NUMBER, OBSERVABLE
from burstcast.base.series_lengths import series_lengths, without_padding
from burstcast.statistics.densities import Histogram, check_edges, from_slots, slots

STEPS_PER_BLOCK = 64
"""Steps whose products are held at a time: bounds the memory, changes no result."""
_MANY_COMPONENTS = 100
"""Components of a state from which products are summed by matrix products."""


@dataclass(frozen=True)
class StateMoments:
    """First and second moments of a state over time."""

    count: int
    mean: FloatArray  #: mean of a_i, ``(dimension,)``; NaN without states
    #: mean of a_i a_j (not of the deviations from the mean), ``(dimension, dimension)``; likewise
    mean_product: FloatArray


@dataclass(frozen=True)
class LongTermStatistics:
    """Histogram and moments for long-term statistics."""

    histogram: Histogram  #: histogram of the observable
    moments: StateMoments  #: moments of the state

    @classmethod
    def from_arrays(cls, arrays: Mapping[str, Any]) -> "LongTermStatistics":
        """Statistics from the variables of their file (`statistics_variables`)."""
        return cls(
            Histogram(arrays["edge"], arrays["count"], int(arrays["below"]), int(arrays["above"])),
            StateMoments(int(arrays["states"]), arrays["mean"], arrays["mean_product"]),
        )


@dataclass(frozen=True)
class SeriesReductions:
    """Reductions of many series, each on its own."""

    edge: Annotated[FloatArray, Described("edge", OBSERVABLE, "edges of the histogram's bins")]
    run_count: Annotated[
        IntArray,
        Described(
            "start slot",
            NUMBER,
            "samples of each loop's observable below the first bin, in each bin, above the last",
        ),
    ]
    run_sum: Annotated[
        FloatArray,
        Described("start component", COMPONENT, "sums of each loop's state over time"),
    ]
    #: of a_i a_j with i <= j, row by row of the upper triangle
    run_product_sum: Annotated[
        FloatArray,
        Described("start pair", COMPONENT_PRODUCT, "sums of products of its components"),
    ]

    def __len__(self) -> int:
        return len(self.run_count)

    def merged(self, rows: BoolArray | IntArray | slice) -> LongTermStatistics:
        """Statistics of some series together, by their positions or a mask; there may be none."""
        counts = self.run_count[rows].sum(axis=0)
        number = int(counts.sum())
        divisor = number or np.nan
        dimension = self.run_sum.shape[1]
        products = np.empty((dimension, dimension))
        upper = np.triu_indices(dimension)
        products[upper] = self.run_product_sum[rows].sum(axis=0) / divisor
        products.T[upper] = products[upper]
        return LongTermStatistics(
            from_slots(self.edge, counts),
            StateMoments(number, self.run_sum[rows].sum(axis=0) / divisor, products),
        )


class SeriesAccumulator:
    """Reduces series while they are being made, on the edges of bins ``(bins + 1,)``."""

    def __init__(self, series: int, dimension: int, edges: FloatArray) -> None:
        check_edges(edges)
        self._edges = edges
        self._counts = np.zeros((series, len(edges) + 1), dtype=np.int64)
        self._sums = np.zeros((dimension, series))
        self._first, self._second = np.triu_indices(dimension)
        self._product_sums = np.zeros((len(self._first), series))

    def add(self, rows: IntArray, states: FloatArray, observable: FloatArray) -> None:
        """Add ``(steps, dimension, batch)`` states of some series, each at most once."""
        if not np.isfinite(states).all():
            raise ValueError("a state that is not finite has no moments")
        width = self._counts.shape[1]
        indices = slots(observable, self._edges) + width * np.arange(len(rows))
        counts = np.bincount(indices.ravel(), minlength=width * len(rows))
        self._counts[rows] += counts.reshape(len(rows), width)
        sums = self._sums[:, rows]
        if len(sums) >= _MANY_COMPONENTS:
            for state in states:
                sums += state
            self._sums[:, rows] = sums
            for column, row in enumerate(rows):
                trajectory = np.ascontiguousarray(states[:, :, column])
                self._product_sums[:, row] += (trajectory.T @ trajectory)[self._first, self._second]
            return
        product_sums = self._product_sums[:, rows]
        for start in range(0, len(states), STEPS_PER_BLOCK):
            block = states[start : start + STEPS_PER_BLOCK]
            products = block[:, self._first] * block[:, self._second]
            # One step after the other: the order of the additions, and with it the rounding, is
            # the same however the series are cut up.
            for state, product in zip(block, products, strict=True):
                sums += state
                product_sums += product
        self._sums[:, rows] = sums
        self._product_sums[:, rows] = product_sums

    def reductions(self) -> SeriesReductions:
        """Reductions of all that was added."""
        return SeriesReductions(
            self._edges, self._counts.copy(), self._sums.T.copy(), self._product_sums.T.copy()
        )


def reduce_series(
    blocks: Iterable[FloatArray],
    observable: Callable[[FloatArray], FloatArray],
    edges: FloatArray,
) -> SeriesReductions:
    """Reduce stored series.

    ``blocks``: The series, ``(series, time, component)`` each, shorter ones filled up with NaN:
    read a few at a time, all series need never be in the memory together. How they are grouped
    changes no result. ``edges``: Edges of the histogram's bins, ``(bins + 1,)``.
    """
    parts = []
    for block in itertools.chain.from_iterable(map(_of_equal_lengths, blocks)):
        accumulator = SeriesAccumulator(len(block), block.shape[2], edges)
        states = np.ascontiguousarray(block.transpose(1, 2, 0))
        accumulator.add(np.arange(len(block)), states, observable(states.transpose(1, 0, 2)))
        parts.append(accumulator.reductions())
    if not parts:
        raise ValueError("there are no series to reduce")
    return SeriesReductions(
        edges,
        np.concatenate([part.run_count for part in parts]),
        np.concatenate([part.run_sum for part in parts]),
        np.concatenate([part.run_product_sum for part in parts]),
    )


def _of_equal_lengths(block: FloatArray) -> list[FloatArray]:
    """Series as they are, or one by one where their lengths differ."""
    lengths = series_lengths(block)
    if lengths is None:
        return [block]
    if not lengths.all():
        raise ValueError("a series has no value that is finite, and cannot be reduced")
    return [series[np.newaxis] for series in without_padding(block)]
