"""Settings that follow from the campaign where the config has null: examples and sizes."""

from collections import Counter
from collections.abc import Mapping
from typing import Any

from burstcast.base.names import parsed
from burstcast.base.natural_order import natural_order
from burstcast_workflow.config.model import Configuration

_STRATEGY = "RV"
"""Validation strategy of the example network, where the campaign has it."""

_SHOWN = {"example_case", "example_forecaster", "fixed_neurons"}


def completed(config: Configuration) -> Configuration:
    """Fill in what follows from the campaign.

    The example network is of the size that most cases have, the largest of those; of Recycle
    Validation if there is any; of seed 0; of the first case that has such networks, parts of
    other cases last. Without networks, the first case is the example, and no network is.
    """
    figures = config.figures
    shown = {**_example(config), **figures.model_dump(include=_SHOWN, exclude_none=True)}
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
        (case, name)
        for block in config.campaign
        for name in block.forecasters.names("esn")
        if name.label is None and name.seed == 0
        for case in block.case_names
    ]
    size = figures.fixed_neurons or parsed(figures.example_forecaster or "none").neurons
    if size is None and networks:
        counts = Counter(size for _, size in {(case, name.neurons) for case, name in networks})
        size = max(counts, key=lambda neurons: (counts[neurons], neurons or 0))
    alike = [
        (case, name)
        for case, name in networks
        if name.neurons == size and figures.example_case in (None, case)
    ]

    def place(case: str) -> tuple[Any, ...]:
        data = config.data_of(case)
        return data is not None and data.case is not None, natural_order(case)

    first = min([case for case, _ in alike] or config.case_names, key=place, default=None)
    names = {str(name.validation): name.identifier for case, name in alike if case == first}
    if not names:
        return {"example_case": first, "example_forecaster": None, "fixed_neurons": None}
    name = names.get(_STRATEGY) or names[min(names)]
    return {"example_case": first, "example_forecaster": name, "fixed_neurons": size}


def _followed(chosen: Any, shown: Mapping[str, Any]) -> dict[str, Any]:
    """Networks of a choice that leaves its size or strategy to the example: null."""
    example = parsed(shown["example_forecaster"] or "none")
    values = {"neurons": shown["fixed_neurons"], "validation": example.validation}
    return {
        axis: [value] if value is not None else []
        for axis, value in values.items()
        if getattr(chosen, axis) is None
    }
