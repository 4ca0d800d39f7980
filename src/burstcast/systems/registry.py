"""Dynamical systems by name, of this package and of modules of the user.

The module ``burstcast.systems.<name>`` holds the system ``<name>``. A system of one's own is named
by its module and class, ``my_flows.kuramoto:KuramotoSivashinsky``: any module that Python finds. A
system is one concrete subclass of `DynamicalSystem`; nothing has to be registered.
"""

import dataclasses
from collections.abc import Mapping
from typing import Any

import burstcast.systems
from burstcast.base.discovery import (
    classes_in,
    concrete_classes,
    imported,
    made,
    module_names,
    module_of,
    own_class,
    suggestion,
    unfinished,
)
from burstcast.systems.base import DynamicalSystem
from burstcast.systems.state_space import MEASURED, StateSpace, make_measured

_CLASS_VARIABLES = ("dimension", "observable_name", "observable_symbol")


def available_systems() -> list[str]:
    """Names of all the systems of this package, sorted; modules with mistakes are left out."""
    return [name for name in module_names(burstcast.systems) if _is_sound(name)]


def make_system(name: str, parameters: Mapping[str, float]) -> DynamicalSystem:
    """Make the system ``name`` with these parameters.

    ``name``: Name of a module of `burstcast.systems` ("mfe", "lorenz63", ...), or module and class
    of a user, "my_flows.kuramoto:KuramotoSivashinsky".
    """
    return made("system", name, "parameter", system_class(name), parameters)


def make_space(name: str, parameters: Mapping[str, Any]) -> StateSpace:
    """Make the state space of a case: a system (`make_system`), or `MEASURED`."""
    return make_measured(parameters) if name == MEASURED else make_system(name, parameters)


def system_class(name: str) -> type[DynamicalSystem]:
    """Find the class of the system ``name`` (see `make_system`)."""
    if ":" in name:
        return _complete(own_class(name, DynamicalSystem, "system"))  # type: ignore[type-abstract]
    if name not in module_names(burstcast.systems):
        raise ValueError(_unknown(name))
    module = imported(f"burstcast.systems.{name}")
    classes = concrete_classes(burstcast.systems, name, DynamicalSystem)  # type: ignore[type-abstract]
    if not classes:
        # an unfinished class; the interface itself, and bases of systems, are in other modules
        begun = [
            candidate
            for candidate in classes_in(module, DynamicalSystem)  # type: ignore[type-abstract]
            if candidate is not DynamicalSystem
        ]
        raise ValueError(unfinished(begun[0]) if begun else _unknown(name))
    if len(classes) > 1:
        names = ", ".join(system_class.__name__ for system_class in classes)
        raise TypeError(f"burstcast.systems.{name} must define one system, not several: {names}")
    return _complete(classes[0])


def parameters_of(system: DynamicalSystem) -> dict[str, float]:
    """Values of all the parameters of a system, those with a default included, by their names."""
    assert dataclasses.is_dataclass(system)
    return {
        field.name: getattr(system, field.name)
        for field in dataclasses.fields(system)
        if field.init
    }


def system_module(name: str) -> str:
    """Full name of the module of the system ``name``."""
    return module_of(name, burstcast.systems)


def _complete(candidate: type[DynamicalSystem]) -> type[DynamicalSystem]:
    if missing := _missing(candidate):
        raise ValueError(
            f"the class {candidate.__name__} of {candidate.__module__} lacks {', '.join(missing)}"
        )
    return candidate


def _unknown(name: str) -> str:
    available = available_systems()
    return (
        f"unknown system {name!r}{suggestion(name, available)}; the available systems are "
        f"{', '.join(available)}; a class in a module of yours is named <module>:<class>"
    )


def _is_sound(name: str) -> bool:
    try:
        classes = concrete_classes(burstcast.systems, name, DynamicalSystem)  # type: ignore[type-abstract]
    except ValueError:
        return False
    return any(not _missing(candidate) for candidate in classes)


def _missing(candidate: type[DynamicalSystem]) -> list[str]:
    """Class variables that a class lacks, as one that is made of another system does."""
    return [name for name in _CLASS_VARIABLES if not hasattr(candidate, name)]
