"""Systems with a constant force on their right-hand side."""

from collections.abc import Sequence

import numpy as np

from burstcast.base.arrays import FloatArray
from burstcast.systems.base import DynamicalSystem, EnergyBudget, has_own


def forced_system(system: DynamicalSystem, force: Sequence[float]) -> DynamicalSystem:
    """A system with a constant force on its right-hand side (see `DynamicalSystem.forced`)."""
    return system.forced(force) if has_own(system, "forced") else ForcedSystem(system, force)


class ForcedSystem(DynamicalSystem):
    """A system with a constant force added to its right-hand side (see `forced_system`).

    It is not a dataclass: with an array among its fields it would have no hash, and not be
    compiled.
    """

    def __init__(self, system: DynamicalSystem, force: Sequence[float]) -> None:
        vector = np.asarray(force, dtype=np.float64)
        if vector.shape != (system.dimension,) or not np.isfinite(vector).all():
            raise ValueError(f"a force needs {system.dimension} finite components, not {force}")
        if type(self).flow_map is not type(system).flow_map:
            raise ValueError(
                f"a force is added to a right-hand side, but {type(system).__name__} has an "
                "integrator of its own: let the actuation change a parameter"
            )
        self._system = system
        self._force = vector
        # class variables of a system; here taken over from the system inside
        object.__setattr__(self, "dimension", system.dimension)
        object.__setattr__(self, "observable_name", system.observable_name)
        object.__setattr__(self, "observable_symbol", system.observable_symbol)

    def right_hand_side(self, state: FloatArray) -> FloatArray:
        """Time derivative of the state with the force (see `DynamicalSystem.right_hand_side`)."""
        return self._with_force(self._system.right_hand_side(state))

    def _with_force(self, slope: FloatArray) -> FloatArray:
        return slope + self._force.reshape((-1,) + (1,) * (slope.ndim - 1))

    def jacobian(self, state: FloatArray) -> FloatArray:
        """Jacobian of the right-hand side, which the force does not change."""
        return self._system.jacobian(state)

    def observable(self, state: FloatArray) -> FloatArray:
        """Observable of the system."""
        return self._system.observable(state)

    def energy_budget(self, state: FloatArray) -> EnergyBudget | None:
        """Budget of the system, with the work of the force in the input."""
        budget = self._system.energy_budget(state)
        if budget is None:
            return None
        work = budget.input
        for component, row in zip(self._force, state, strict=True):
            work = work + component * row
        return EnergyBudget(work, budget.dissipation)
