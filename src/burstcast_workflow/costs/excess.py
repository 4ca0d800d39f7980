"""Cost of seeds or series above their bounds: a part of the message that refuses them."""

import copy
from collections.abc import Mapping, Sequence
from contextlib import suppress
from itertools import product
from typing import Any

from burstcast_workflow.campaign.campaign import Campaign
from burstcast_workflow.config.cases import block_cases
from burstcast_workflow.config.derived import completed
from burstcast_workflow.config.loading import ConfigError, Excess
from burstcast_workflow.config.model import Configuration
from burstcast_workflow.costs.model import Cost, CostModel

_OF_A_NETWORK = ("training", "forecast", "horizon", "long_term")
_UNITS = ((365.25 * 86400, "years"), (86400.0, "days"), (3600.0, "hours"), (1.0, "seconds"))


def with_costs(error: ConfigError, config: Mapping[str, Any]) -> ConfigError:
    """Add to messages about numbers above their bounds what these would cost, if that is known."""
    problems = list(error.problems)
    for excess in error.excesses:
        # nothing is predicted of other settings, or where other mistakes leave no campaign
        with suppress(ValueError, LookupError, TypeError):
            cost = _cost(_allowed(config, error.excesses), excess)
            place = [text.startswith(f"{excess.name} is ") for text in problems].index(True)
            size, unit = next(one for one in _UNITS if cost.seconds >= 2 * one[0])
            words = f"{_rounded(cost.seconds / size)} {unit} on one core"
            if cost.memory_mib > 2048:
                words += f" and {_rounded(cost.memory_mib / 1024)} GiB of memory"
            problems[place] += f"; {excess.value} would take about {words}"
    return ConfigError(problems, error.excesses)


def _rounded(value: float) -> str:
    return f"{float(f'{value:.2g}'):,.0f}"


def _allowed(config: Mapping[str, Any], excesses: Sequence[Excess]) -> Campaign:
    """The campaign with bounds in place of what is above them, and one seed."""
    allowed = copy.deepcopy(dict(config))
    for excess in excesses:
        section: Any = allowed
        for part in excess.path[:-1]:
            section = section[part]
        section[excess.path[-1]] = 1 if excess.path[-1] == "seeds" else excess.bound
    return Campaign(completed(Configuration.model_validate(allowed)).dump())


def _cost(campaign: Campaign, excess: Excess) -> Cost:
    """Cost of all networks of a block that differ by their seeds, or of an ensemble."""
    model, path = CostModel(campaign), excess.path
    if path[-2:] == ("ensemble", "series"):
        case = str(path[1]) if path[0] == "cases" else campaign.example.case
        cost, factor = model.predicted("integration", {"case": case}), excess.value / excess.bound
        return Cost(factor * cost.seconds, factor * cost.memory_mib)
    if path[-2:] != ("esn", "seeds"):
        raise ValueError(f"no cost of {excess.name}")
    block = campaign.config.campaign[int(path[1])]
    costs = [
        model.predicted(work, {"case": case, "forecaster": f"esn-N{size}-{validation}-seed0"})
        for case in block_cases(block)
        for axes in block.forecasters.networks
        for size, validation in product(axes.neurons, axes.validation)
        for work in _OF_A_NETWORK
    ]
    seconds = excess.value * sum(cost.seconds for cost in costs)
    return Cost(seconds, max(cost.memory_mib for cost in costs))
