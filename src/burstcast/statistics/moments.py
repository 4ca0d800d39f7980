"""First and second moments of a state over time."""

from dataclasses import dataclass

from burstcast.base.arrays import FloatArray


@dataclass(frozen=True)
class StateMoments:
    """First and second moments of a state over time."""

    count: int
    mean: FloatArray  #: mean of a_i, ``(dimension,)``; NaN without states
    #: mean of a_i a_j (not of the deviations from the mean), ``(dimension, dimension)``; likewise
    mean_product: FloatArray
