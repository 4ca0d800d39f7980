"""Stiff systems: implicit schemes of scipy with an adaptive step, in place of Runge-Kutta's.

A trajectory is integrated by itself, so that it does not depend on others of its batch. This takes
milliseconds for each step and trajectory: let the time step be as long as the sampling interval.
"""

from collections.abc import Sequence
from typing import Any, ClassVar, Literal

import numpy as np

from burstcast.base.arrays import FloatArray
from burstcast.systems.base import DynamicalSystem, has_own
from burstcast.systems.forced import ForcedSystem


class StiffSystem(DynamicalSystem):
    """A system of stiff equations; its `jacobian`, if it has one, is given to the scheme."""

    method: ClassVar[Literal["Radau", "BDF", "LSODA"]] = "Radau"
    """Scheme of `scipy.integrate.solve_ivp`."""
    relative_tolerance: ClassVar[float] = 1e-9
    absolute_tolerance: ClassVar[float] = 1e-12

    def flow_map(self, state: FloatArray, time_step: float) -> FloatArray:
        """State one integration step later, both of shape ``(dimension, ...)``."""
        # jobs of other systems would pay for this import
        from scipy.integrate import solve_ivp

        columns = np.asarray(state, dtype=np.float64).reshape(self.dimension, -1)
        advanced = np.empty_like(columns)
        options: dict[str, Any] = {
            "method": self.method,
            "t_eval": [time_step],
            "rtol": self.relative_tolerance,
            "atol": self.absolute_tolerance,
        }
        if has_own(self, "jacobian"):
            options["jac"] = lambda _, y: self.jacobian(y)
        for number, start in enumerate(columns.T):
            solution = solve_ivp(
                lambda _, y: self.right_hand_side(y),
                (0.0, time_step),
                start,
                **options,
            )
            if not solution.success:
                raise FloatingPointError(f"{self.method}: {solution.message}")
            advanced[:, number] = solution.y[:, -1]
        return advanced.reshape(state.shape)

    def forced(self, force: Sequence[float]) -> DynamicalSystem:
        """The system with a constant force, by the same scheme and tolerances."""
        return _ForcedStiffSystem(self, force)


class _ForcedStiffSystem(ForcedSystem, StiffSystem):
    """A stiff system with a force, by the implicit scheme and the tolerances of the system."""

    def __init__(self, system: StiffSystem, force: Sequence[float]) -> None:
        super().__init__(system, force)
        for name in ("method", "relative_tolerance", "absolute_tolerance"):
            object.__setattr__(self, name, getattr(system, name))
