"""Actuation: other equations over an interval.

Source: section "Control of extreme events" of the paper. Its control raises the Reynolds number to
2000 for 1.5 Lyapunov times, from one Lyapunov time before the window in which an event is expected.
"""

import dataclasses
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from burstcast.base.arrays import BoolArray, ByteArray, FloatArray
from burstcast.systems.base import DynamicalSystem
from burstcast.systems.forced import forced_system
from burstcast.systems.parameters import SHARE, Parameters, SystemParameters

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
    names = [field.name for field in dataclasses.fields(system) if field.init]
    unknown = sorted(set(parameters) - set(names))
    if unknown:
        raise ValueError(
            f"the actuation changes {', '.join(unknown)}, which the system does not have; "
            f"its parameters are {', '.join(names) or 'none'}"
        )
    changed = {}
    for name, value in parameters.items():
        unactuated = getattr(system, name)
        changed[name] = value if strength == 1 else unactuated + strength * (value - unactuated)
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

    @classmethod
    def of(
        cls,
        names: Sequence[str],
        system: DynamicalSystem,
        actuated: DynamicalSystem,
        strength: float,
    ) -> "ActuationValues":
        """Values of parameters by name: of the equations, or the share of the actuator alone."""
        if list(names) == [SHARE]:
            return cls((0.0,), (strength,), (-strength,))
        off, on = SystemParameters.of(system, names), SystemParameters.of(actuated, names)
        return cls(off.defaults, on.defaults)

    def schedule(self, acting: ByteArray | BoolArray) -> FloatArray:
        """Schedule ``(steps, parameters, batch)`` of an actuator.

        ``acting``: Number of the actuation during each step, ``(steps, batch)``.
        """
        values = [self.off, self.on]
        if self.reversed:
            values.append(self.reversed)
        chosen = np.array(values)[acting.astype(np.uint8)]
        return np.ascontiguousarray(chosen.transpose(0, 2, 1))


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
