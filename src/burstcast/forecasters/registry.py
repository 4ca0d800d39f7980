"""Forecasters by name: the module ``burstcast.forecasters.<kind>`` holds the kind ``<kind>``.

A new kind is one new module with one concrete subclass of `Forecaster` in it; nothing has to be
registered. Modules with a leading underscore hold what several kinds share.
"""

import burstcast.forecasters
from burstcast.discovery import concrete_classes, module_names, suggestion
from burstcast.forecasters.base import Forecaster

_OTHERS = ("base", "registry")
AWARE_KINDS = ("esn_aware", "quadratic_aware", "quadratic_aware_filtered")
"""Kinds that learn how the flow depends on parameters, from series with schedules."""


def available_kinds() -> list[str]:
    """Names of all the kinds that learn from series alone, sorted."""
    others = (*_OTHERS, *AWARE_KINDS)
    return [name for name in module_names(burstcast.forecasters) if name not in others]


def linearises(kind: str) -> bool:
    """Whether a kind linearises its forecasts, so that it has Lyapunov exponents."""
    return forecaster_class(kind).advance_tangent is not Forecaster.advance_tangent


def learns_parameters(kind: str) -> bool:
    """Whether a kind learns how the flow depends on parameters; equations need not learn."""
    found = forecaster_class(kind)
    return found.aware and not found.needs_equations


def forecaster_class(kind: str) -> type[Forecaster]:
    """Find the class of the forecasters of a kind: "esn", "equations", ...

    Raises
    ------
    ValueError
        If there is no such kind.
    TypeError
        If its module does not define just one.

    Examples
    --------
    >>> from burstcast.forecasters.registry import available_kinds, forecaster_class
    >>> forecaster_class("analogues").__name__, "esn" in available_kinds()
    ('Analogues', True)
    """
    available = [*available_kinds(), *AWARE_KINDS]
    if kind not in available:
        raise ValueError(
            f"unknown kind of forecaster {kind!r}{suggestion(kind, available)}; "
            f"the available kinds are {', '.join(available)}"
        )
    classes = concrete_classes(burstcast.forecasters, kind, Forecaster)  # type: ignore[type-abstract]
    if len(classes) != 1:
        names = ", ".join(found.__name__ for found in classes) or "none"
        raise TypeError(f"burstcast.forecasters.{kind} must define one forecaster, not {names}")
    return classes[0]
