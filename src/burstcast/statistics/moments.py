"""First and second moments of a state over time."""

from dataclasses import dataclass

from burstcast.arrays import FloatArray


@dataclass(frozen=True)
class StateMoments:
    """First and second moments of a state over time.

    Attributes
    ----------
    count
        Number of states.
    mean
        Mean of a_i, ``(dimension,)``; NaN without states.
    mean_product
        Mean of a_i a_j (not of the deviations from the mean), ``(dimension, dimension)``; likewise.
    """

    count: int
    mean: FloatArray
    mean_product: FloatArray
