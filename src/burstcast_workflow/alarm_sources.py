"""Sources of alarms: every forecaster, committees, and baselines that need no forecast.

A committee consists of the members of ensembles: of all networks of a size and strategy, each of
which is one member, or of one forecaster that provides an ensemble (a filter, analogues).
"""

from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Any

from burstcast_workflow.campaign import Campaign, CaseForecaster
from burstcast_workflow.identifiers import ForecasterName

BASELINES = ("climatology", "observable_now")
"""Alarms without a forecast: by the base rate alone, and by the observable at this moment."""


@dataclass(frozen=True)
class AlarmSource:
    """Source of alarms in a case.

    Attributes
    ----------
    case
        The case.
    name
        Its name: that of its forecaster, ``esn-N1000-RV-committee``,
        ``quadratic_filtered-committee``, or one of `BASELINES`.
    forecasters
        Forecasters that vote; none for baselines.
    """

    case: str
    name: ForecasterName
    forecasters: tuple[CaseForecaster, ...] = ()

    @property
    def committee(self) -> bool:
        """Whether all members of the forecasters' ensembles vote, not their single forecasts."""
        return self.name.role == "committee"

    @property
    def compared(self) -> bool:
        """Whether it is compared with others: all but the single networks of an ensemble."""
        return self.name.seed is None


def alarm_sources(campaign: Campaign, case: str) -> list[AlarmSource]:
    """All sources of alarms in a case: baselines, forecasters, then committees."""
    forecasters = campaign.select(case=case)
    groups: dict[ForecasterName, list[CaseForecaster]] = {}
    for one in forecasters:
        groups.setdefault(replace(one.name, seed=None), []).append(one)
    committees = [
        AlarmSource(case, replace(name, role="committee"), tuple(voters))
        for name, voters in groups.items()
        if len(voters) > 1 or voters[0].kind.provides_ensemble
    ]
    return [
        *(AlarmSource(case, ForecasterName(name)) for name in BASELINES),
        *(AlarmSource(case, one.name, (one,)) for one in forecasters),
        # committees of several networks come first
        *sorted(committees, key=lambda source: len(source.forecasters) == 1),
    ]


def shown_committees(campaign: Campaign, case: str) -> list[AlarmSource]:
    """Committees of a case that figures show: of the example's size and strategy, of filters."""
    example = replace(campaign.example.name, seed=None, role="committee")
    return [
        source
        for source in alarm_sources(campaign, case)
        if source.name == example or (source.committee and source.forecasters[0].kind.has_filter)
    ]


def shown_voters(campaign: Campaign, case: str) -> list[CaseForecaster]:
    """Forecasters that vote in the committees that figures show."""
    return [one for source in shown_committees(campaign, case) for one in source.forecasters]


def alarm_records(campaign: Campaign, case: str) -> list[dict[str, Any]]:
    """Records for jobs of all sources of alarms in a case, with their key columns."""
    return _records(campaign, alarm_sources(campaign, case))


def committee_records(campaign: Campaign, case: str) -> list[dict[str, Any]]:
    """Records for jobs of the committees of a case that figures show."""
    return _records(campaign, shown_committees(campaign, case))


def voter_records(campaign: Campaign, case: str) -> list[dict[str, Any]]:
    """Records for jobs of `shown_voters`, with the settings of their kinds."""
    return [
        {
            "identity": one.identity,
            "settings": campaign.settings(["forecaster.options"], one.identity, {}),
        }
        for one in shown_voters(campaign, case)
    ]


def _records(campaign: Campaign, sources: Iterable[AlarmSource]) -> list[dict[str, Any]]:
    return [
        {
            "alarm": source.name.identifier,
            "forecasters": [one.name.identifier for one in source.forecasters],
            "committee": source.committee,
            "compared": source.compared,
            "keys": {
                **campaign.case_keys(source.case),
                **source.name.keys,
                "alarm": source.name.identifier,
            },
        }
        for source in sources
    ]
