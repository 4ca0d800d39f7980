"""Control by a committee: several networks, or the members of one forecaster's ensemble.

The share of them that forecasts an event is its probability (`burstcast.probability.votes`), and
the strategy's ``vote_share`` the probability at which it acts.
"""

from collections.abc import Sequence
from dataclasses import fields
from typing import Any, cast

from burstcast.control.experiment import ControlExperiment
from burstcast.control.monitors.base import Monitor
from burstcast.control.monitors.members import MemberForecasts, MembersMonitor
from burstcast.control.strategies.base import ControlStrategy
from burstcast.forecasters.base import Forecaster

VOTE_SHARE = "vote_share"
"""Setting of strategies that may ask several: the share of them that must forecast an event."""


def votes(strategy: type[ControlStrategy]) -> bool:
    """Whether a strategy may ask several."""
    return VOTE_SHARE in (field.name for field in fields(cast(Any, strategy)))


def monitor(
    strategy: ControlStrategy,
    experiment: ControlExperiment,
    forecasters: Sequence[Forecaster],
    alarm_rate: float,
    seed: int,
) -> Monitor:
    """Return the monitor of a committee.

    One network is a committee of one: it decides, whatever the share of the vote. A single
    forecaster with an ensemble leaves the vote to the members of its ensemble.

    Raises
    ------
    TypeError
        If the strategy has no share of a vote.
    """
    if not votes(type(strategy)):
        raise TypeError(f"{type(strategy).__name__} has no {VOTE_SHARE}")
    first, *others = forecasters
    if others or not first.provides_ensemble:
        return strategy.monitor(experiment, forecasters)
    # of a forecaster, monitors use what this has
    members = MemberForecasts(first)
    each = strategy.monitor(experiment, [cast(Forecaster, members)])
    return MembersMonitor(each, getattr(strategy, VOTE_SHARE))
