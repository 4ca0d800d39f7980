"""Controllers by name: whose forecasts decide under a strategy."""

from collections.abc import Sequence
from dataclasses import fields
from typing import Any, cast

from burstcast.control.experiment import ControlExperiment
from burstcast.control.policy import Members, Policy, at_random, by_members, by_vote
from burstcast.control.strategies.base import ControlStrategy

VOTE_SHARE = "vote_share"
"""Setting of strategies that may ask several: the share of them that must forecast an event."""


def votes(strategy: type[ControlStrategy]) -> bool:
    """Whether a strategy may ask several."""
    return VOTE_SHARE in (field.name for field in fields(cast(Any, strategy)))


def controlling_policy(
    role: str,
    strategy: ControlStrategy,
    experiment: ControlExperiment,
    forecasters: Sequence[Any],
    alarm_rate: float = 0.0,
    seed: int = 0,
) -> Policy:
    """Policy of a controller.

    ``role``: "forecaster": the one forecaster decides, or the strategy without any. "committee":
    several forecasters vote, or the members of the ensemble of one. One network is a committee of
    one: it decides, whatever the share of the vote. "random": alarms at random, the effect of the
    actuation alone; each flow has a random stream of its own. ``alarm_rate``: Share of looks at
    which random alarms are raised. ``seed``: Name of the stream of random alarms: the seed of the
    network that they are compared with.
    """
    if role == "random":
        looks = strategy.timing(experiment.schedule).most_looks
        return at_random(alarm_rate, experiment.draws("random alarms", looks, seed))
    if role == "forecaster":
        (forecaster,) = forecasters or [None]
        return strategy.policy(experiment, forecaster)
    if not votes(type(strategy)):
        raise TypeError(f"{type(strategy).__name__} has no {VOTE_SHARE}")
    if getattr(strategy, "reversible", False):
        raise ValueError("a committee cannot vote about the direction of a force")
    share: float = getattr(strategy, VOTE_SHARE)
    first, *others = forecasters
    if others:
        policies = [strategy.policy(experiment, forecaster) for forecaster in forecasters]
        return by_vote(policies, share)
    if not first.provides_ensemble:
        return strategy.policy(experiment, first)
    return by_members(strategy.policy(experiment, Members(first)), share)
