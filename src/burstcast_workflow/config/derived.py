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
    said = {name: getattr(figures, name) for name in shown}
    shown |= {name: value for name, value in said.items() if value is not None}
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
    found = [
        (case, size, block.forecasters.esn.validation)
        for block in config.campaign
        if block.forecasters.esn is not None and not block.forecasters.esn.variants
        for case in block.case_names
        for size in block.forecasters.esn.neurons
    ]
    known = figures.example_forecaster and parsed(figures.example_forecaster)
    size = figures.fixed_neurons or (known.neurons if known else None)
    if size is None and found:
        counts = Counter(one for _, one, _ in found)
        size = max(counts, key=lambda one: (counts[one], one))
    alike = [one for one in found if one[1] == size and figures.example_case in (None, one[0])]
    cases = [case for case, *_ in alike] or config.case_names
    case = min(cases, key=lambda one: (_is_part(config, one), natural_order(one)), default=None)
    strategies = sorted({name for one, _, names in alike if one == case for name in names})
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
