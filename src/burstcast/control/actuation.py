"""Actuation: other equations over an interval.

Source: section "Control of extreme events" of the paper. Its control raises the Reynolds number to
2000 for 1.5 Lyapunov times, from one Lyapunov time before the window in which an event is expected.
"""

import dataclasses
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from burstcast.arrays import BoolArray, ByteArray, FloatArray
from burstcast.systems.base import DynamicalSystem, EnergyBudget
from burstcast.systems.exponential import SemilinearSystem
from burstcast.systems.parameters import SHARE, Parameters
from burstcast.systems.stiff import StiffSystem

REVERSED = 2
"""Number of the reversed actuation: 0 is none, 1 the actuation."""


def actuated_system(
    system: DynamicalSystem,
    parameters: Mapping[str, float],
    force: Sequence[float] | None = None,
    strength: float = 1.0,
) -> DynamicalSystem:
    """Equations under actuation: other parameters, an added force, or both.

    ``parameters``: Parameters that change, and their values: ``{"reynolds": 2000.0}`` in the paper.
    ``force``: Constant, one number per component, added to the right-hand side. ``strength``:
    Parameters change by this share of the difference, and the force is this share of ``force``.
    Between Reynolds numbers of 400 and 2000, a strength of 0.25 is 800.

    Examples
    --------
    >>> from burstcast.control.actuation import actuated_system
    >>> from burstcast.systems.mfe import MoehlisFaisstEckhardt
    >>> flow = MoehlisFaisstEckhardt(reynolds=400.0)
    >>> actuated_system(flow, {"reynolds": 2000.0}, strength=0.25).reynolds
    800.0
    """
    if not parameters and force is None:
        raise ValueError("an actuation changes a parameter of the equations or adds a force")
    if not strength > 0:
        raise ValueError(f"the strength of an actuator must be positive, not {strength}")
    changed = _under_share(system, parameters, force, strength)
    if changed.dimension != system.dimension:
        raise ValueError(
            f"an actuation must leave the number of components of a state as it is, "
            f"{system.dimension}, not make it {changed.dimension}"
        )
    return changed


def _with_parameters(
    system: DynamicalSystem, parameters: Mapping[str, float], strength: float
) -> DynamicalSystem:
    if not dataclasses.is_dataclass(system):
        raise ValueError("only the parameters of a system that is a dataclass can be changed")
    known = [field.name for field in dataclasses.fields(system) if field.init]
    unknown = sorted(set(parameters) - set(known))
    if unknown:
        raise ValueError(
            f"the actuation changes {', '.join(unknown)}, which the system does not have; "
            f"its parameters are {', '.join(known) or 'none'}"
        )
    changed = {}
    for name, value in parameters.items():
        own = getattr(system, name)
        changed[name] = value if strength == 1 else own + strength * (value - own)
    try:
        return dataclasses.replace(system, **changed)
    except ValueError as error:
        raise ValueError(f"at a strength of {strength:g}, {error}") from error


@dataclass(frozen=True)
class ActuationValues:
    """Values of each parameter for aware forecasters, with the actuator off and on."""

    off: tuple[float, ...]
    on: tuple[float, ...]
    reversed: tuple[float, ...] = ()  #: likewise; empty: the actuation cannot be reversed

    def schedule(self, acting: ByteArray | BoolArray) -> FloatArray:
        """Schedule ``(steps, parameters, batch)`` of an actuator.

        ``acting``: Number of the actuation during each step, ``(steps, batch)``.
        """
        values = np.array([one for one in (self.off, self.on, self.reversed) if one])
        return np.ascontiguousarray(values[acting.astype(np.uint8)].transpose(0, 2, 1))


@dataclass(frozen=True)
class ActuatorShare(Parameters):
    """The share of an actuator that is in force, as the one parameter of a schedule.

    At a share of 0 the flow is free; 1 is the whole actuation, whatever it consists of: changed
    parameters, a force, or both. Shares may lie between and beyond; a negative one reverses a
    force.
    """

    free: DynamicalSystem = field(kw_only=True)  #: the equations without actuation
    #: parameters that the actuation changes, and their values at a share of 1
    changed: Mapping[str, float] = field(kw_only=True)
    #: force that is added at a share of 1, one number per component; None: there is none
    force: Sequence[float] | None = field(kw_only=True)
    _made: dict[float, DynamicalSystem] = field(
        init=False, repr=False, compare=False, default_factory=dict
    )

    @classmethod
    def of(
        cls,
        system: DynamicalSystem,
        changed: Mapping[str, float],
        force: Sequence[float] | None = None,
    ) -> "ActuatorShare":
        """Share of an actuator that is described as in `actuated_system`."""
        actuated_system(system, changed, force)
        return cls((SHARE,), (0.0,), free=system, changed=changed, force=force)

    def system(self, values: Sequence[float]) -> DynamicalSystem:
        """Equations under a share of the actuation."""
        (share,) = (float(value) for value in values)
        # systems with a force are equal only to themselves: one for each share is compiled once
        if share not in self._made:
            self._made[share] = _under_share(self.free, self.changed, self.force, share)
        return self._made[share]


def reversed_actuation(
    system: DynamicalSystem, force: Sequence[float], strength: float = 1.0
) -> DynamicalSystem:
    """Equations under the opposite force (parameters as of `actuated_system`)."""
    return forced_system(system, [-strength * component for component in force])


def _under_share(
    system: DynamicalSystem,
    parameters: Mapping[str, float],
    force: Sequence[float] | None,
    share: float,
) -> DynamicalSystem:
    if share == 0:
        return system
    changed = _with_parameters(system, parameters, share) if parameters else system
    if force is None:
        return changed
    return forced_system(changed, [share * component for component in force])


def forced_system(system: DynamicalSystem, force: Sequence[float]) -> "ForcedSystem":
    """A system with a constant force on its right-hand side, integrated by the system's scheme.

    The Runge-Kutta scheme and the schemes of `SemilinearSystem` and `StiffSystem` integrate systems
    with a force; a `flow_map` that a class defines in place of them does not.
    """
    if isinstance(system, SemilinearSystem):
        return _ForcedSemilinearSystem(system, force)
    if isinstance(system, StiffSystem):
        return _ForcedStiffSystem(system, force)
    return ForcedSystem(system, force)


class ForcedSystem(DynamicalSystem):
    """A system with a constant force added to its right-hand side (see `forced_system`).

    It is not a dataclass: the force is a vector over the components, and an array among the fields
    of a system would be taken for a parameter that differs between the trajectories of a batch.
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


class _ForcedSemilinearSystem(ForcedSystem, SemilinearSystem):
    """A semilinear system with a force, which its scheme treats as a part of `nonlinear`."""

    _system: SemilinearSystem

    def linear_rates(self) -> FloatArray:
        """Linear rates of the system, which the force does not change."""
        return self._system.linear_rates()

    def nonlinear(self, state: FloatArray) -> FloatArray:
        """All that is not linear, the force included, ``(dimension, ...)``."""
        return self._with_force(self._system.nonlinear(state))


class _ForcedStiffSystem(ForcedSystem, StiffSystem):
    """A stiff system with a force, by the implicit scheme and the tolerances of the system."""

    def __init__(self, system: StiffSystem, force: Sequence[float]) -> None:
        super().__init__(system, force)
        for name in ("method", "relative_tolerance", "absolute_tolerance"):
            object.__setattr__(self, name, getattr(system, name))
