"""Sources of alarms in a case: forecasters, committees, and baselines without forecasts.

A committee votes with all networks of a size and strategy, or with the members of one ensemble.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TypeAlias

from burstcast.base.names import ForecasterName, parsed
from burstcast.forecasts.event_probabilities import EventProbabilities
from burstcast.forecasts.windows import WindowForecasts

BASELINES = ("climatology", "observable_now")
"""Alarms without a forecast: by the base rate alone, and by the observable at this moment."""


@dataclass(frozen=True)
class AlarmSource:
    """Source of alarms in a case."""

    #: its name: its forecaster's, ``esn-N1000-RV-committee``, ``quadratic_filtered-committee``, or
    #: one of `BASELINES`
    name: ForecasterName
    #: identifiers of the forecasters that vote; none for baselines
    forecasters: tuple[str, ...] = ()

    @property
    def identifier(self) -> str:
        """Name of the source of alarms in tables and files."""
        return self.name.identifier

    @property
    def committee(self) -> bool:
        """Whether all members of the forecasters' ensembles vote, not their single forecasts."""
        return self.name.role == "committee"

    @property
    def compared(self) -> bool:
        """Whether it is compared with others: all but the single networks of an ensemble."""
        return self.name.seed is None


Forecasts: TypeAlias = Mapping[str, WindowForecasts | EventProbabilities]
"""Forecasts of a case by the identifier of the forecaster."""


def alarm_sources(forecasts: Forecasts) -> list[AlarmSource]:
    """All sources of alarms in a case: baselines, forecasters, then committees."""
    groups: dict[ForecasterName, list[str]] = {}
    for name in forecasts:
        groups.setdefault(replace(parsed(name), seed=None), []).append(name)
    committees = []
    for common, voters in groups.items():
        first = forecasts[voters[0]]
        if len(voters) > 1 or (isinstance(first, WindowForecasts) and first.member_first.size):
            committees.append(AlarmSource(replace(common, role="committee"), tuple(voters)))
    committees.sort(key=lambda source: len(source.forecasters) == 1)  # several networks first
    baselines = [AlarmSource(ForecasterName(name)) for name in BASELINES]
    return baselines + [AlarmSource(parsed(name), (name,)) for name in forecasts] + committees
