"""The gradient of a velocity field by finite differences."""

import numpy as np

from burstcast.arrays import FloatArray
from burstcast.systems.mfe_modes import MoehlisFaisstEckhardtModes

STEP = 0.005
# of order eight, at distances of one to four steps
WEIGHTS = (4 / 5, -1 / 5, 4 / 105, -1 / 280)


def velocity_gradient(
    modes: MoehlisFaisstEckhardtModes, amplitudes: FloatArray, *grid: FloatArray
) -> FloatArray:
    """Gradient ``(3, 3, ..., *grid)``; ``[i, j]`` is d u_i / d x_j."""

    def shifted(direction: int, distance: float) -> FloatArray:
        moved = [axis + distance * (number == direction) for number, axis in enumerate(grid)]
        return modes.velocity(amplitudes, *moved)

    slopes = [
        sum(
            weight * (shifted(direction, n * STEP) - shifted(direction, -n * STEP)) / STEP
            for n, weight in enumerate(WEIGHTS, 1)
        )
        for direction in range(3)
    ]
    return np.stack(slopes, axis=1)
