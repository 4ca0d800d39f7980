"""The convection model of E. N. Lorenz, "Deterministic nonperiodic flow", J. Atmos. Sci. 20 (1963).

Small, fast and thoroughly studied: a second system beside the shear flow, for tests and tutorials.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from burstcast.base.arrays import FloatArray
from burstcast.systems.base import DynamicalSystem


@dataclass(frozen=True)
class Lorenz63(DynamicalSystem):
    """dx/dt = sigma (y - x), dy/dt = x (rho - z) - y, dz/dt = x y - beta z; the observable is z.

    Parameters
    ----------
    sigma, rho, beta
        Prandtl number, Rayleigh number over its critical value, and aspect ratio. The defaults
        are the classical chaotic case.

    Raises
    ------
    ValueError
        If a parameter is not finite.

    Examples
    --------
    >>> import numpy as np
    >>> from burstcast.systems.lorenz63 import Lorenz63
    >>> Lorenz63(rho=20.0).right_hand_side(np.array([1.0, 2.0, 3.0])).tolist()
    [10.0, 15.0, -6.0]
    """

    sigma: float = 10.0
    rho: float = 28.0
    beta: float = 8.0 / 3.0

    dimension: ClassVar[int] = 3
    component_names: ClassVar[tuple[str, ...]] = ("x", "y", "z")
    observable_name: ClassVar[str] = "z"
    observable_symbol: ClassVar[str] = "z"
    case_defaults: ClassVar[Mapping[str, Any]] = {
        "event_threshold": 40.0,
        "ensemble": {
            "initial_state": [1.0, 1.0, 20.0],
            "perturbed_component": 3,
            "perturbation": 5.0,
            "time_step": 0.01,
            "sampling_stride": 2,
            "transient": 20.0,
            "duration": 80.0,
        },
        "density": {"range": [0.0, 50.0]},
        "fixed_point": {"variation": 0.1, "above": 0.0},
        "lyapunov": {"orthonormalisation_interval": 0.2},
    }

    def __post_init__(self) -> None:
        for name in ("sigma", "rho", "beta"):
            value = getattr(self, name)
            if not math.isfinite(value):
                raise ValueError(f"{name} must be finite, not {value}")

    def right_hand_side(self, state: FloatArray) -> FloatArray:
        """Time derivative of (x, y, z); both of shape ``(3, ...)``."""
        x, y, z = state
        derivative = np.empty_like(state)
        derivative[0] = self.sigma * (y - x)
        derivative[1] = x * (self.rho - z) - y
        derivative[2] = x * y - self.beta * z
        return derivative

    def jacobian(self, state: FloatArray) -> FloatArray:
        """Jacobian of the right-hand side, ``(3, 3, ...)``."""
        x, y, z = state
        j = np.zeros((3, *state.shape), dtype=state.dtype)
        j[0, 0] = -self.sigma
        j[0, 1] = self.sigma
        j[1, 0] = self.rho - z
        j[1, 1] = -1.0
        j[1, 2] = -x
        j[2, 0] = y
        j[2, 1] = x
        j[2, 2] = -self.beta
        return j

    def observable(self, state: FloatArray) -> FloatArray:
        """Return the component z, of shape ``(...)``."""
        return np.array(state[2])
