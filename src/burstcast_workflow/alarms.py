"""Who raises alarms: every forecaster, committees of networks, and what needs no forecast."""

from collections.abc import Iterable
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
        Its name: that of its forecaster, ``esn-N1000-RV-committee``, or one of `BASELINES`.
    name
        What its key columns are taken from.
    members
        Forecasters that vote; none for baselines.
    """

    case: str
    identifier: str
    name: ForecasterName
    members: tuple[CaseForecaster, ...]

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
        *(
            Alarm(
                case,
                f"{name.identifier}-committee",
                replace(name, kind=f"{name.kind}_committee"),
                tuple(members),
            )
            for name, members in committees.items()
            if len(members) > 1
        ),
    ]


def alarm_records(campaign: Campaign, cases: Iterable[str]) -> list[dict[str, Any]]:
    """Records for jobs: alarms of cases, their members' identifiers, and their key columns."""
    return [
        {
            "case": alarm.case,
            "alarm": alarm.identifier,
            "members": [one.name.identifier for one in alarm.members],
            "compared": alarm.compared,
            "keys": {
                "case": alarm.case,
                "reynolds": campaign.reynolds(alarm.case),
                **alarm.name.keys,
                "alarm": alarm.identifier,
            },
        }
        for case in cases
        for alarm in alarms_of(campaign, case)
    ]
