"""Forecasters by name: the module ``burstcast.forecasters.<kind>`` holds the kind ``<kind>``.

A new kind is one new module with one concrete subclass of `Forecaster`, or of `EventClassifier`, in
it; nothing has to be registered. Modules with a leading underscore hold what several kinds share.
"""

import burstcast.forecasters
from burstcast.discovery import concrete_classes, module_names, suggestion
from burstcast.forecasters._event_classifier import EventClassifier
from burstcast.forecasters.base import Forecaster, ForecasterKind

_OTHERS = ("base", "registry")


def available_kinds() -> list[str]:
    """Names of all the kinds that learn from series alone, sorted."""
    return [kind for kind in all_kinds() if not learns_parameters(kind)]


def all_kinds() -> list[str]:
    """Names of all kinds, sorted."""
    return [name for name in module_names(burstcast.forecasters) if name not in _OTHERS]


def trajectory_kinds() -> list[str]:
    """Names of the kinds that forecast trajectories, sorted."""
    return [kind for kind in available_kinds() if kind_class(kind).has_trajectories]


def linearises(kind: str) -> bool:
    """Whether a kind linearises its forecasts, so that it has Lyapunov exponents."""
    found = kind_class(kind)
    return issubclass(found, Forecaster) and found.advance_tangent is not Forecaster.advance_tangent


def learns_parameters(kind: str) -> bool:
    """Whether a kind learns how the flow depends on parameters; equations need not learn."""
    found = kind_class(kind)
    return found.aware and not found.needs_equations


def kind_class(kind: str) -> type[ForecasterKind]:
    """Find the class of the forecasters of a kind: "esn", "equations", "precursor", ..."""
    if kind not in (available := all_kinds()):
        raise ValueError(
            f"unknown kind of forecaster {kind!r}{suggestion(kind, available)}; "
            f"the available kinds are {', '.join(available)}"
        )
    classes = concrete_classes(burstcast.forecasters, kind, ForecasterKind)  # type: ignore[type-abstract]
    if len(classes) != 1:
        names = ", ".join(found.__name__ for found in classes) or "none"
        raise TypeError(f"burstcast.forecasters.{kind} must define one forecaster, not {names}")
    return classes[0]


def forecaster_class(kind: str) -> type[Forecaster]:
    """Find the class of the forecasters of a kind that forecasts trajectories.

    Examples
    --------
    >>> from burstcast.forecasters.registry import available_kinds, forecaster_class
    >>> forecaster_class("analogues").__name__, "esn" in available_kinds()
    ('Analogues', True)
    """
    found = kind_class(kind)
    if not issubclass(found, Forecaster):
        raise ValueError(
            f"{kind} gives probabilities of events without a trajectory "
            "(burstcast.forecasters.registry.classifier_class); take a kind that forecasts states"
        )
    return found


def classifier_class(kind: str) -> type[EventClassifier]:
    """Find the class of a kind that gives probabilities without trajectories.

    Examples
    --------
    >>> from burstcast.forecasters.registry import classifier_class
    >>> classifier_class("precursor").has_trajectories
    False
    """
    found = kind_class(kind)
    if not issubclass(found, EventClassifier):
        raise ValueError(f"{kind} forecasts trajectories, from which probabilities follow")
    return found
