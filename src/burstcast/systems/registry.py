"""Dynamical systems by name: the module ``burstcast.systems.<name>`` holds the system ``<name>``.

A new system is one new module with one concrete subclass of `DynamicalSystem` in it; nothing has to
be registered.
"""

import dataclasses
from collections.abc import Mapping

import burstcast.systems
from burstcast.discovery import checked_numbers, concrete_classes, module_names, suggestion
from burstcast.systems.base import DynamicalSystem


def available_systems() -> list[str]:
    """Names of all the systems, sorted."""
    return [name for name in module_names(burstcast.systems) if _systems_in(name)]


def make_system(name: str, parameters: Mapping[str, float]) -> DynamicalSystem:
    """Make the system ``name`` with these parameters.

    Parameters
    ----------
    name
        Name of a module of `burstcast.systems`: "mfe", "lorenz63", ...
    parameters
        Values of the fields of the system's class; those with a default may be left out.

    Raises
    ------
    ValueError
        If there is no such system; if a parameter is unknown, missing or not a finite number; or
        if the system itself rejects a value.
    TypeError
        If the module defines more than one system.
    """
    found = system_class(name)
    return found(**checked_numbers(f"system {name!r}", "parameter", found, parameters))


def system_class(name: str) -> type[DynamicalSystem]:
    """Find the class of the system ``name``.

    Raises
    ------
    ValueError
        If there is no such system.
    TypeError
        If the module defines more than one system.
    """
    classes = _systems_in(name) if name in module_names(burstcast.systems) else []
    if not classes:
        available = available_systems()
        raise ValueError(
            f"unknown system {name!r}{suggestion(name, available)}; "
            f"the available systems are {', '.join(available)}"
        )
    if len(classes) > 1:
        names = ", ".join(system_class.__name__ for system_class in classes)
        raise TypeError(f"burstcast.systems.{name} must define one system, not several: {names}")
    return classes[0]


def parameters_of(system: DynamicalSystem) -> dict[str, float]:
    """Values of all the parameters of a system, those with a default included, by their names."""
    assert dataclasses.is_dataclass(system)
    return {
        field.name: getattr(system, field.name)
        for field in dataclasses.fields(system)
        if field.init
    }


def _systems_in(module_name: str) -> list[type[DynamicalSystem]]:
    # the interface is abstract
    return concrete_classes(burstcast.systems, module_name, DynamicalSystem)  # type: ignore[type-abstract]
