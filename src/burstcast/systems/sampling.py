"""Initial states that a system draws by itself."""

import numpy as np

from burstcast.base.arrays import FloatArray, float_array
from burstcast.systems.base import DynamicalSystem


def sampled_initial_states(
    system: DynamicalSystem, series: int, generator: np.random.Generator
) -> FloatArray:
    """Initial states ``(dimension, series)`` from a system's own sampler."""
    name = f"{type(system).__name__}.sample_initial_states"
    states = np.array(float_array(system.sample_initial_states(series, generator), name))
    if states.shape != (system.dimension, series):
        raise ValueError(
            f"{name} must return the shape ({system.dimension}, {series}), not {states.shape}"
        )
    if not np.isfinite(states).all():
        raise ValueError(f"{name} returned a state that is not finite")
    return states
