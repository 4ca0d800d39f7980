"""Forecasters that vote in the committees that figures show."""

from dataclasses import replace

from burstcast_workflow.campaign.campaign import Campaign, CaseForecaster


def shown_voters(campaign: Campaign, case: str) -> list[CaseForecaster]:
    """Networks of the example's size and strategy if they are several, then filters."""
    forecasters = campaign.select(case=case)
    example = replace(campaign.example.name, seed=None)
    networks = [one for one in forecasters if replace(one.name, seed=None) == example]
    return [
        *(networks if len(networks) > 1 else []),
        *(one for one in forecasters if one.kind.has_filter),
    ]
