"""Parameters of the equations that differ between series or change in time, and their schedules.

A schedule holds the values in force from each state to the next, ``(steps, parameters, batch)``:
entry j is in force from step j to step j + 1. A washout of n states therefore has a schedule of
n - 1 entries, and a forecast of n steps one of n entries. Columns of a record that are known in
advance are parameters, too: entry j has their values in row j + 1.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, fields, is_dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np

from burstcast.base.arrays import FloatArray, IntArray
from burstcast.base.discovery import suggestion
from burstcast.base.exogenous import of_memory
from burstcast.systems.base import DynamicalSystem
from burstcast.systems.integration import integrate, integrate_switched

SHARE = "share"
"""The parameter that is the share of an actuator in force, and none of the equations' own."""


@dataclass(frozen=True)
class Parameters:
    """Named parameters of a case that schedules are about."""

    names: tuple[str, ...]  #: one name for each parameter, in the order of a schedule's second axis
    #: values in force where there is no schedule; empty where nothing is known without one
    defaults: tuple[float, ...]

    def __post_init__(self) -> None:
        if not self.names or len(self.defaults) not in (0, len(self.names)):
            raise ValueError(
                f"parameters need a value for each name, one at least: not the names "
                f"{list(self.names)} and the values {list(self.defaults)}"
            )

    def system(self, values: Sequence[float]) -> DynamicalSystem:
        """Equations under these values, one for each name."""
        raise ValueError(f"no equations are known for the parameters {', '.join(self.names)}")

    def constant(self, steps: int, batch: int, values: Sequence[float] | None = None) -> FloatArray:
        """Schedule of constant values, ``(steps, parameters, batch)``; by default the defaults."""
        values = self.defaults if values is None else values
        if not len(values):
            raise ValueError(
                f"{', '.join(self.names)}: values over the whole forecast must be given, for "
                f"nothing is known of them otherwise"
            )
        column = np.array(values, dtype=np.float64)
        return np.tile(column[:, np.newaxis], (steps, 1, batch))

    def over(
        self, memory: FloatArray, size: int, steps: int
    ) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Memory of a forecaster without inputs, its schedule of the next steps, and the later one.

        ``memory``: With or without a schedule (`burstcast.base.exogenous.carry`); without one, the
        case's own values are in force. ``size``: Rows of it without a schedule.
        """
        memory, schedule, later = of_memory(memory, size, len(self.names), steps)
        batch = memory.shape[-1]
        if schedule is None:
            schedule = self.constant(steps, batch)
        self.check(schedule, steps, batch)
        return memory, schedule, later

    def check(self, schedule: FloatArray, steps: int, batch: int) -> None:
        """Check a schedule."""
        expected = (steps, len(self.names), batch)
        if schedule.shape != expected:
            raise ValueError(
                f"a schedule of {', '.join(self.names)} over {steps} steps must have the shape "
                f"{expected}, not {schedule.shape}"
            )
        if not np.isfinite(schedule).all():
            raise ValueError(f"a schedule of {', '.join(self.names)} must be finite")


@dataclass(frozen=True)
class SystemParameters(Parameters):
    """Parameters that are fields of a system: a Reynolds number, for instance.

    Examples
    --------
    >>> from burstcast.systems.mfe import MoehlisFaisstEckhardt
    >>> parameters = SystemParameters.of(MoehlisFaisstEckhardt(400.0), ["reynolds"])
    >>> parameters.defaults, parameters.system([600.0]).reynolds
    ((400.0,), 600.0)
    """

    #: the equations, whose own values are in force where there is no schedule
    free: DynamicalSystem = field(kw_only=True)

    @classmethod
    def of(cls, system: DynamicalSystem, names: Sequence[str]) -> "SystemParameters":
        """Parameters of a system by the names of its fields."""
        field_names: list[str] = []
        if is_dataclass(system):
            field_names = [parameter.name for parameter in fields(system) if parameter.init]
        for name in names:
            if name not in field_names:
                raise ValueError(
                    f"{type(system).__name__} has no parameter {name!r}"
                    f"{suggestion(name, field_names)}; its parameters are "
                    f"{', '.join(field_names) or 'none'}"
                )
        defaults = tuple(float(getattr(system, name)) for name in names)
        return cls(tuple(names), defaults, free=system)

    def system(self, values: Sequence[float]) -> DynamicalSystem:
        """Equations with these values in place of the system's own."""
        free: Any = self.free  # a dataclass: `of` has looked
        changed: DynamicalSystem = replace(
            free, **{name: float(value) for name, value in zip(self.names, values, strict=True)}
        )
        return changed


def stretches(schedule: FloatArray) -> Iterator[tuple[slice, FloatArray]]:
    """Stretches of a schedule without a change: their steps, and values ``(parameters, batch)``."""
    steps = len(schedule)
    changed = (schedule[1:] != schedule[:-1]).any(axis=(1, 2))
    for start, stop in pairwise([0, *(np.flatnonzero(changed) + 1).tolist(), steps]):
        if stop > start:
            yield slice(start, stop), schedule[start]


def values_in(values: FloatArray) -> tuple[FloatArray, IntArray]:
    """Different values of a schedule, or of one step of it, ``(number, parameters)``.

    Returns also which of them each step and trajectory has, ``(steps, batch)`` or ``(batch,)``.
    """
    last = np.moveaxis(values, -2, -1)
    different, which = np.unique(
        last.reshape(math.prod(last.shape[:-1]), last.shape[-1]), axis=0, return_inverse=True
    )
    return different, np.asarray(which.reshape(last.shape[:-1]), dtype=np.int64)


def integrate_scheduled(
    parameters: Parameters,
    schedule: FloatArray,
    state: FloatArray,
    time_step: float,
    stride: int = 1,
) -> FloatArray:
    """Integrate a batch under parameters that change in time, ``(steps + 1, dimension, batch)``.

    ``schedule``: Values during each step of the result, ``stride`` integration steps each.
    """
    steps = len(schedule)
    parameters.check(schedule, steps, state.shape[1])
    different, which = values_in(schedule)
    if len(different) < 2:
        values = different[0].tolist() if len(different) else parameters.defaults
        return integrate(parameters.system(values), state, time_step, steps * stride, stride)
    systems = [parameters.system(values) for values in different.tolist()]
    choice = np.repeat(which, stride, axis=0)
    return integrate_switched(systems, choice, state, time_step, stride)
