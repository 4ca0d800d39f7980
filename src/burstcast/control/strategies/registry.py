"""Strategies of control by name: the module ``burstcast.control.strategies.<name>`` holds one.

A new strategy is one new module with one concrete subclass of `ControlStrategy` in it; nothing has
to be registered.
"""

from collections.abc import Mapping
from typing import Any

import burstcast.control.strategies
from burstcast.base.discovery import checked_values, concrete_classes, module_names, suggestion
from burstcast.control.strategies.base import ControlStrategy

_OTHERS = ("base", "registry")


def available_strategies() -> list[str]:
    """Names of all the strategies, sorted."""
    return [name for name in module_names(burstcast.control.strategies) if name not in _OTHERS]


def strategy_class(name: str) -> type[ControlStrategy]:
    """Class of a strategy: "receding_horizon", ..."""
    available = available_strategies()
    if name not in available:
        raise ValueError(
            f"unknown strategy of control {name!r}{suggestion(name, available)}; "
            f"the available strategies are {', '.join(available)}"
        )
    classes = concrete_classes(burstcast.control.strategies, name, ControlStrategy)  # type: ignore[type-abstract]
    if len(classes) != 1:
        names = ", ".join(strategy.__name__ for strategy in classes) or "none"
        raise TypeError(f"burstcast.control.strategies.{name} must define one, not {names}")
    return classes[0]


def make_strategy(name: str, settings: Mapping[str, Any]) -> ControlStrategy:
    """Make a strategy from values of the fields of its class; those with a default may be missing.

    Raises ValueError if there is no such strategy; if a setting is unknown, missing or not of its
    type; or if the strategy itself rejects a value.
    """
    strategy = strategy_class(name)
    values = checked_values(f"strategy of control {name!r}", "setting", strategy, settings)
    return strategy(**values)
