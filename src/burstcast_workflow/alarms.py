"""Who raises alarms: every forecaster, committees, and what needs no forecast.

A committee is either of networks, all seeds of a size and strategy, or of the members of one
forecaster's ensemble: those of a filter, or single analogues.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Any

from burstcast_workflow.campaign import Campaign, CaseForecaster
from burstcast_workflow.identifiers import ForecasterName

BASELINES = ("climatology", "observable_now")
"""Alarms without a forecast: by the base rate alone, and by the observable at this moment."""


@dataclass(frozen=True)
class Alarm:
    """Who raises alarms in a case.

    Attributes
    ----------
    case
        The case.
    identifier
        Its name: that of its forecaster, ``esn-N1000-RV-committee``,
        ``quadratic_filtered-committee``, or one of `BASELINES`.
    name
        What its key columns are taken from.
    members
        Forecasters that vote; none for baselines.
    by_members
        Whether it is the members of their ensembles that vote.
    """

    case: str
    identifier: str
    name: ForecasterName
    members: tuple[CaseForecaster, ...]
    by_members: bool = False

    @property
    def compared(self) -> bool:
        """Whether it is compared with others: not the single networks of an ensemble."""
        return self.name.seed is None


def alarms_of(campaign: Campaign, case: str) -> list[Alarm]:
    """All who raise alarms in a case: baselines, forecasters, then committees."""
    forecasters = campaign.select(case=case)
    committees: dict[ForecasterName, list[CaseForecaster]] = {}
    for one in forecasters:
        if one.name.seed is not None:
            committees.setdefault(replace(one.name, seed=None), []).append(one)
    return [
        *(Alarm(case, name, ForecasterName(name), ()) for name in BASELINES),
        *(Alarm(case, one.name.identifier, one.name, (one,)) for one in forecasters),
        *(_committee(name, members) for name, members in committees.items() if len(members) > 1),
        *(
            _committee(one.name, [one], by_members=True)
            for one in campaign.ensemble_forecasters
            if one.case == case
        ),
    ]


def shown_committees(campaign: Campaign, case: str) -> list[Alarm]:
    """Committees of a case that figures show: of the example's size and strategy, of filters."""
    example = replace(campaign.example.name, seed=None, kind="esn_committee")
    return [
        alarm
        for alarm in alarms_of(campaign, case)
        if alarm.name == example or alarm.name.kind.endswith("_filtered_committee")
    ]


def shown_voters(
    campaign: Campaign, case: str, by_members: bool | None = None
) -> list[CaseForecaster]:
    """Who votes in the committees that are shown: all, or those whose members (do not) vote."""
    return [
        one
        for alarm in shown_committees(campaign, case)
        if by_members in (None, alarm.by_members)
        for one in alarm.members
    ]


def _committee(
    name: ForecasterName, members: Sequence[CaseForecaster], by_members: bool = False
) -> Alarm:
    identifier, kind = f"{name.identifier}-committee", f"{name.kind}_committee"
    named = replace(name, kind=kind)
    return Alarm(members[0].case, identifier, named, tuple(members), by_members)


def alarm_records(campaign: Campaign, case: str) -> list[dict[str, Any]]:
    """Records for jobs of all who raise alarms in a case, with their key columns.

    ``members`` are the forecasters that vote, ``ensembles`` those all of whose members vote.
    """
    return _records(campaign, alarms_of(campaign, case))


def committee_records(campaign: Campaign, case: str) -> list[dict[str, Any]]:
    """The same of the committees that figures show."""
    return _records(campaign, shown_committees(campaign, case))


def voter_records(campaign: Campaign, case: str, by_members: bool) -> list[dict[str, Any]]:
    """Records for jobs of one sort of those who vote in these, with the settings of their kinds."""
    return [
        {
            "identity": one.identity,
            "settings": campaign.settings(["forecaster.options"], one.identity, {}),
        }
        for one in shown_voters(campaign, case, by_members)
    ]


def _records(campaign: Campaign, alarms: Iterable[Alarm]) -> list[dict[str, Any]]:
    return [
        {
            "alarm": alarm.identifier,
            "members": [] if alarm.by_members else identifiers,
            "ensembles": identifiers if alarm.by_members else [],
            "compared": alarm.compared,
            "keys": {
                **campaign.case_keys(alarm.case),
                **alarm.name.keys,
                "alarm": alarm.identifier,
            },
        }
        for alarm in alarms
        for identifiers in [[one.name.identifier for one in alarm.members]]
    ]
