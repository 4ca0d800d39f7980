"""Two coupled FitzHugh-Nagumo units, whose mean has extreme events by itself.

Source: G. Ansmann, R. Karnatak, K. Lehnertz, U. Feudel, "Extreme events in excitable systems and
mechanisms of their generation", Phys. Rev. E 88 (2013) 052911. Most of the time both units make
small oscillations; at irregular, long intervals both are excited at once.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from burstcast.base.arrays import FloatArray
from burstcast.systems.base import DynamicalSystem


@dataclass(frozen=True)
class FitzHughNagumoPair(DynamicalSystem):
    """Two units with diffusive coupling in x; the observable is the mean of x_1 and x_2.

    dx_i/dt = x_i (a - x_i) (x_i - 1) - y_i + k (x_j - x_i), dy_i/dt = b_i x_i - c y_i.
    """

    #: a, b1, b2, c: parameters of the units, which differ in b alone
    a: float = -0.025794
    b1: float = 0.0065
    b2: float = 0.0135
    c: float = 0.02
    k: float = 0.128  #: strength of the coupling

    dimension: ClassVar[int] = 4
    observable_name: ClassVar[str] = "mean excitation"
    observable_symbol: ClassVar[str] = r"\bar{x}"
    case_defaults: ClassVar[Mapping[str, Any]] = {
        "event_threshold": 0.6,  # small oscillations stay below 0.25, excitations reach 0.86
        "ensemble": {
            "initial_state": [0.0, 0.0, 0.0, 0.0],
            "perturbed_component": 1,
            "perturbation": 0.1,
            "time_step": 0.5,
            "sampling_stride": 4,  # forty samples of a small oscillation
            "transient": 10000.0,
            "duration": 12000.0,  # one excitation on average
        },
        # what decides about an excitation is small: noise of 0.01, the shear flow's, drowns it
        "training": {"series": 20, "noise": 0.0001},
        "density": {"range": [-0.4, 0.9]},
        "fixed_point": {"variation": 0.01, "above": -0.4},
        "lyapunov": {"orthonormalisation_interval": 10.0},
        "recycle_validation": {"series": 10, "intervals_per_series": 30},
    }

    def __post_init__(self) -> None:
        for name in ("a", "b1", "b2", "c", "k"):
            value = getattr(self, name)
            if not math.isfinite(value):
                raise ValueError(f"{name} must be finite, not {value}")

    def right_hand_side(self, state: FloatArray) -> FloatArray:
        """Time derivative of (x_1, x_2, y_1, y_2); both of shape ``(4, ...)``."""
        x1, x2, y1, y2 = state
        exchange = self.k * (x2 - x1)
        derivative = np.empty_like(state)
        derivative[0] = x1 * (self.a - x1) * (x1 - 1.0) - y1 + exchange
        derivative[1] = x2 * (self.a - x2) * (x2 - 1.0) - y2 - exchange
        derivative[2] = self.b1 * x1 - self.c * y1
        derivative[3] = self.b2 * x2 - self.c * y2
        return derivative

    def jacobian(self, state: FloatArray) -> FloatArray:
        """Jacobian of the right-hand side, ``(4, 4, ...)``."""
        j = np.zeros((4, *state.shape), dtype=state.dtype)
        for i, b in enumerate((self.b1, self.b2)):
            x = state[i]
            j[i, i] = (self.a - x) * (x - 1.0) - x * (x - 1.0) + x * (self.a - x) - self.k
            j[i, 1 - i] = self.k
            j[i, 2 + i] = -1.0
            j[2 + i, i] = b
            j[2 + i, 2 + i] = -self.c
        return j

    def observable(self, state: FloatArray) -> FloatArray:
        """Mean of x_1 and x_2, of shape ``(...)``."""
        mean: FloatArray = 0.5 * (state[0] + state[1])
        return mean
