"""The model of E. N. Lorenz of a quantity on a latitude circle, with as many variables as wanted.

Source: E. N. Lorenz, "Predictability: a problem partly solved", Proc. Seminar on Predictability,
ECMWF (1996). Advection keeps the energy, a constant force supplies it, and damping removes it.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from burstcast.base.arrays import FloatArray, sum_of_rows
from burstcast.systems.base import DynamicalSystem, EnergyBudget, Symmetry


@dataclass(frozen=True)
class Lorenz96(DynamicalSystem):
    """dx_i/dt = (x_{i+1} - x_{i-2}) x_{i-1} - x_i + F on a circle; the observable is the energy.

    The energy is the mean over the variables, e = (1 / 2N) sum_i x_i^2.

    Parameters
    ----------
    forcing
        The constant force F. At 8, the default, the model is chaotic.
    variables
        Number N of variables, 4 at least.

    Raises
    ------
    ValueError
        If the forcing is not finite, or there are fewer than four variables.

    Examples
    --------
    >>> import numpy as np
    >>> from burstcast.systems.lorenz96 import Lorenz96
    >>> system = Lorenz96(forcing=8.0, variables=5)
    >>> system.right_hand_side(np.array([1.0, 2.0, 3.0, 4.0, 5.0])).tolist()
    [-3.0, 4.0, 11.0, 13.0, -5.0]
    >>> float(system.observable(np.array([1.0, 2.0, 3.0, 4.0, 5.0])))
    5.5
    """

    forcing: float = 8.0
    variables: int = 40

    observable_name: ClassVar[str] = "energy"
    observable_symbol: ClassVar[str] = "e"
    case_defaults: ClassVar[Mapping[str, Any]] = {
        "event_threshold": {"quantile": 0.95},
        "ensemble": {
            "time_step": 0.01,
            "sampling_stride": 5,
            "transient": 20.0,
            "duration": 60.0,
        },
        "density": {"range": [0.0, 30.0]},
        "fixed_point": {"variation": 0.1, "above": 0.0},
        "lyapunov": {"orthonormalisation_interval": 0.2},
    }

    def __post_init__(self) -> None:
        if not math.isfinite(self.forcing):
            raise ValueError(f"forcing must be finite, not {self.forcing}")
        if self.variables < 4:
            raise ValueError(f"variables must be 4 at least, not {self.variables}")

    @property
    def dimension(self) -> int:  # type: ignore[override]
        """Number of variables."""
        return self.variables

    @property
    def component_names(self) -> tuple[str, ...]:
        """Names of the variables: x1, x2, ..."""
        return tuple(f"x{number}" for number in range(1, self.variables + 1))

    def right_hand_side(self, state: FloatArray) -> FloatArray:
        """Time derivative of the variables; both of shape ``(variables, ...)``."""
        before, two_before, after = (np.roll(state, shift, axis=0) for shift in (1, 2, -1))
        derivative: FloatArray = (after - two_before) * before - state + self.forcing
        return derivative

    def jacobian(self, state: FloatArray) -> FloatArray:
        """Jacobian of the right-hand side, ``(variables, variables, ...)``."""
        number = self.variables
        j = np.zeros((number, *state.shape), dtype=state.dtype)
        for i in range(number):
            before, two_before, after = i - 1, i - 2, (i + 1) % number
            j[i, before] = state[after] - state[two_before]
            j[i, after] = state[before]
            j[i, two_before] = -state[before]
            j[i, i] = -1.0
        return j

    def observable(self, state: FloatArray) -> FloatArray:
        """Energy, mean over the variables, of shape ``(...)``."""
        return sum_of_rows(state * state) / (2 * self.variables)

    def sample_initial_states(self, series: int, generator: np.random.Generator) -> FloatArray:
        """States near the unstable fixed point x_i = F, ``(variables, series)``."""
        return self.forcing + generator.standard_normal((self.variables, series))

    def energy_budget(self, state: FloatArray) -> EnergyBudget:
        """Work of the force and damping: d/dt (1/2) sum x_i^2 = F sum x_i - sum x_i^2."""
        return EnergyBudget(
            input=self.forcing * sum_of_rows(state), dissipation=sum_of_rows(state * state)
        )

    def symmetries(self) -> tuple[Symmetry, ...]:
        """Shifts along the circle."""
        return (Symmetry(lambda state: np.roll(state, 1, axis=0), self.variables),)
