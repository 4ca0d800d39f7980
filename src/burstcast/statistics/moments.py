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

    def merge(self, other: "StateMoments") -> "StateMoments":
        """Moments of the states of both."""
        if self.count == 0 or other.count == 0:
            return other if self.count == 0 else self
        count = self.count + other.count
        weight = other.count / count
        return StateMoments(
            count,
            (1 - weight) * self.mean + weight * other.mean,
            (1 - weight) * self.mean_product + weight * other.mean_product,
        )
