"""Validation strategies by name: each is a class of some module of this package.

A new strategy is one new module with one concrete subclass of `ValidationStrategy` in it, which
says its `name`; nothing has to be registered.
"""

import burstcast.networks.validation_strategies
from burstcast.base.discovery import concrete_classes, module_names, suggestion
from burstcast.networks.validation_strategies.base import ValidationStrategy

VALIDATED_TOGETHER = ("RV", "SSV")
"""Strategies whose sums over the training data are computed in one scan of the grid."""


def available_strategies() -> list[str]:
    """Names of all the strategies, sorted."""
    return sorted(_classes())


def make_strategy(name: str) -> ValidationStrategy:
    """Make the strategy ``name``: "SSV", "RV", ..."""
    classes = _classes()
    if name not in classes:
        available = sorted(classes)
        raise ValueError(
            f"unknown validation strategy {name!r}{suggestion(name, available)}; "
            f"the available strategies are {', '.join(available)}"
        )
    return classes[name]()


def scanned_with(name: str) -> tuple[str, ...]:
    """Strategies that are validated in one go on the grid: the strategy ``name`` among them."""
    return VALIDATED_TOGETHER if name in VALIDATED_TOGETHER else (name,)


def strategy_module(name: str) -> str:
    """Name of the module that defines the strategy ``name`` (errors as of `make_strategy`)."""
    return type(make_strategy(name)).__module__


def _classes() -> dict[str, type[ValidationStrategy]]:
    classes: dict[str, type[ValidationStrategy]] = {}
    package = burstcast.networks.validation_strategies
    for module in module_names(package):
        for strategy in concrete_classes(package, module, ValidationStrategy):  # type: ignore[type-abstract]
            if strategy.name in classes:
                other = classes[strategy.name].__module__
                raise TypeError(f"{other} and {strategy.__module__} both define {strategy.name!r}")
            classes[strategy.name] = strategy
    return classes
