"""Forecasters by name, of this package and of modules of the user.

The module ``burstcast.forecasters.<kind>`` holds the kind ``<kind>``. A forecaster of one's own is
named by its module and class, ``my_models:NVAR``: any module that Python finds. A kind is one
concrete subclass of `Forecaster`, or of `EventClassifier`; nothing has to be registered. Modules
with a leading underscore hold what several kinds share.
"""

import inspect
from collections.abc import Mapping
from typing import Any

import burstcast.forecasters
from burstcast.base.discovery import (
    concrete_classes,
    made,
    module_names,
    module_of,
    own_class,
    suggestion,
)
from burstcast.forecasters.base import Forecaster, ForecasterKind

_OTHERS = ("base", "check", "registry")


def available_kinds() -> list[str]:
    """Names of all the kinds of this package that learn from series alone, sorted."""
    return [kind for kind in all_kinds() if not kind_class(kind).learns_parameters]


def all_kinds() -> list[str]:
    """Names of all kinds of this package, sorted."""
    return [name for name in module_names(burstcast.forecasters) if name not in _OTHERS]


def trajectory_kinds() -> list[str]:
    """Names of the kinds of this package that forecast trajectories, sorted."""
    return [kind for kind in available_kinds() if kind_class(kind).has_trajectories]


def kind_class(kind: str) -> type[ForecasterKind]:
    """Find the class of a kind: "esn", "precursor", or "my_models:NVAR" of one's own."""
    if ":" in kind:
        return own_class(kind, ForecasterKind, "forecaster")
    if kind not in (available := all_kinds()):
        raise ValueError(
            f"unknown kind of forecaster {kind!r}{suggestion(kind, available)}; the available "
            f"kinds are {', '.join(available)}; a class in a module of yours is named "
            "<module>:<class>"
        )
    classes = concrete_classes(burstcast.forecasters, kind, ForecasterKind)
    if len(classes) != 1:
        names = ", ".join(candidate.__name__ for candidate in classes) or "none"
        raise TypeError(f"burstcast.forecasters.{kind} must define one forecaster, not {names}")
    return classes[0]


def class_of(kind: str | ForecasterKind | type[ForecasterKind]) -> type[ForecasterKind]:
    """Find the class of a kind that is given by its name, its class, or an object of it."""
    if isinstance(kind, str):
        return kind_class(kind)
    if isinstance(kind, type) and issubclass(kind, ForecasterKind):
        return kind
    if isinstance(kind, ForecasterKind):
        return type(kind)
    raise TypeError(
        f"kind must be the name of a kind, a class of forecasters or a forecaster, not {kind!r}"
    )


def make_kind(kind: str, options: Mapping[str, Any]) -> ForecasterKind:
    """Make an unfitted forecaster, or classifier, of a kind.

    Parameters
    ----------
    kind
        As for `kind_class`.
    options
        Values of its options; options without a value have their default.

    Raises
    ------
    ValueError
        If there is no such kind or option, or a value is of another type than the option.

    Examples
    --------
    >>> make_kind("nvar", {"lags": 3})
    NVAR(lags=3, ridge=1e-06)
    """
    return make_kind_of(kind_class(kind), options)


def make_kind_of(kind: type[ForecasterKind], options: Mapping[str, Any]) -> ForecasterKind:
    """Make an unfitted forecaster of a class (`make_kind`)."""
    return made("forecaster", kind_name(kind), "option", kind, options)


def as_forecaster(kind: ForecasterKind) -> Forecaster:
    """A forecaster of trajectories; refuses classifiers."""
    if not isinstance(kind, Forecaster):
        raise ValueError(
            f"{kind_name(type(kind))} gives probabilities of events without a trajectory: take a "
            "kind that forecasts states"
        )
    return kind


def kind_name(kind: type[ForecasterKind]) -> str:
    """Name of a kind, by which `kind_class` finds it."""
    package, _, module = kind.__module__.rpartition(".")
    if package == burstcast.forecasters.__name__:
        return module
    return f"{kind.__module__}:{kind.__qualname__}"


def kind_module(kind: str) -> str:
    """Full name of the module of a kind."""
    return module_of(kind, burstcast.forecasters)


def sections_of_kind(kind: str) -> tuple[str, ...]:
    """Sections of options that a kind of this package has (`burstcast.forecasters._options`)."""
    bases = inspect.getmro(kind_class(kind))
    return tuple(vars(base)["section"] for base in bases if "section" in vars(base))


def options_of_kind(kind: str, sections: Mapping[str, Mapping[str, Any]]) -> dict[str, Any]:
    """Options of a kind of this package, from all of its sections; empty if it has none."""
    return {
        name: value
        for section in sections_of_kind(kind)
        for name, value in sections.get(section, {}).items()
    }
