"""Settings that follow from the campaign where the config has null: examples and sizes."""

from collections import Counter
from collections.abc import Mapping
from typing import Any

from burstcast.base.names import ForecasterName, parsed
from burstcast.base.natural_order import natural_order
from burstcast_workflow.config.model import Configuration

_STRATEGY = "RV"
"""Validation strategy of the example network, where the campaign has it."""


def completed(config: Configuration) -> Configuration:
    """Fill in what follows from the campaign.

    The example network is of the size that most cases have, the largest of those; of Recycle
    Validation if there is any; of seed 0; of the first case that has such networks, parts of
    other cases last. Without networks, the first case is the example, and no network is.
    """
    figures = config.figures
    shown = _example(config)
    given = {name: getattr(figures, name) for name in shown}
    shown |= {name: value for name, value in given.items() if value is not None}
    update: dict[str, Any] = {"figures": figures.model_copy(update=shown)}
    for name in ("statistics", "control"):
        section = getattr(config, name)
        forecasters = section.forecasters
        if forecasters.esn is not None:
            esn = forecasters.esn.model_copy(update=_followed(forecasters.esn, shown))
            forecasters = forecasters.model_copy(update={"esn": esn})
            update[name] = section.model_copy(update={"forecasters": forecasters})
    return config.model_copy(update=update)


def _example(config: Configuration) -> dict[str, Any]:
    """Example case and network, and the size that panels hold fixed."""
    figures = config.figures
    networks = [
        (case, size, block.forecasters.esn.validation)
        for block in config.campaign
        if block.forecasters.esn is not None and not block.forecasters.esn.variants
        for case in block.case_names
        for size in block.forecasters.esn.neurons
    ]
    example = figures.example_forecaster and parsed(figures.example_forecaster)
    size = figures.fixed_neurons or (example.neurons if example else None)
    if size is None and networks:
        counts = Counter(case_or_size for _, case_or_size, _ in networks)
        size = max(counts, key=lambda case_or_size: (counts[case_or_size], case_or_size))
    alike = [
        case_or_size
        for case_or_size in networks
        if case_or_size[1] == size and figures.example_case in (None, case_or_size[0])
    ]
    cases = [case for case, *_ in alike] or config.case_names
    case = min(
        cases,
        key=lambda case_or_size: (_is_part(config, case_or_size), natural_order(case_or_size)),
        default=None,
    )
    strategies = sorted(
        {name for case_or_size, _, names in alike if case_or_size == case for name in names}
    )
    if not strategies:
        return {"example_case": case, "example_forecaster": None, "fixed_neurons": None}
    strategy = _STRATEGY if _STRATEGY in strategies else strategies[0]
    name = ForecasterName("esn", size, strategy, 0).identifier
    return {"example_case": case, "example_forecaster": name, "fixed_neurons": size}


def _is_part(config: Configuration, case: str) -> bool:
    """Whether a case is a part of another one's state."""
    data = config.data_of(case)
    return data is not None and data.case is not None


def _followed(chosen: Any, shown: Mapping[str, Any]) -> dict[str, Any]:
    """Networks of a choice that leaves its size or strategy to the example: null."""
    example = shown["example_forecaster"]
    values = {
        "neurons": shown["fixed_neurons"],
        "validation": example and parsed(example).validation,
    }
    return {
        axis: [] if value is None else [value]
        for axis, value in values.items()
        if getattr(chosen, axis) is None
    }
