"""What tests of statistics share."""

from collections.abc import Callable, Iterable

from burstcast.arrays import FloatArray
from burstcast.statistics.reductions import SeriesReductions, reduce_series


def reduced(
    blocks: Iterable[FloatArray], observable: Callable[[FloatArray], FloatArray], edges: FloatArray
) -> SeriesReductions:
    """Reduce series, whose observable is a function of states ``(dimension, ...)``."""
    pairs = ((block, observable(block.transpose(2, 0, 1))) for block in blocks)
    return reduce_series(pairs, edges)
