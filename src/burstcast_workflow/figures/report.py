"""What the page of a campaign says beside its results (`burstcast_workflow.jobs.report`)."""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from burstcast_workflow.campaign.campaign import Campaign
from burstcast_workflow.campaign.loading import load
from burstcast_workflow.figures.registry import FIGURES, figures_by_name
from burstcast_workflow.harness.settings import leaves
from burstcast_workflow.project import project_root
from burstcast_workflow.tables.declarations import SECTIONS
from burstcast_workflow.tables.registry import table_names, table_of

# What differs in every campaign and is shown elsewhere, or changes no result.
_LEFT_OUT = ("campaign", "results", "figures", "cache_gb", "rerun_libraries")


def report_of(campaign: Campaign) -> dict[str, Any]:
    """Name of the campaign; what was computed, a row for each case; settings that differ; sections.

    A setting that differs from the paper is its path, its value here and there. A section has a
    title, figures and tables, each with name, title and caption.
    """
    sections = [_section(campaign, name) for name in SECTIONS]
    return {
        "name": Path(campaign.config.results).name,
        "cases": [_computed(campaign, case) for case in campaign.case_names],
        "settings": other_settings(campaign.config.dump()),
        "sections": [section for section in sections if section["figures"] or section["tables"]],
    }


def _computed(campaign: Campaign, case: str) -> dict[str, str]:
    networks = [network.name for network in campaign.networks if network.case == case]
    kinds = dict.fromkeys(network.name.kind for network in campaign.select(case=case))
    return {
        "case": case,
        "networks": str(len(networks)),
        "of neurons": ", ".join(map(str, sorted({network.neurons or 0 for network in networks}))),
        "validated by": ", ".join(sorted({str(network.validation) for network in networks})),
        "seeds": str(len({network.seed for network in networks})),
        "forecasters": ", ".join(kinds),
    }


def other_settings(config: Mapping[str, Any]) -> list[list[str]]:
    """Settings that differ from the paper's config.yaml: path, value here, value there."""
    here, there = _texts(config), _texts(load({}, defaults=project_root() / "config.yaml"))
    return [
        [path, here.get(path, ""), there.get(path, "")]
        for path in dict.fromkeys([*here, *there])
        if here.get(path) != there.get(path) and path.partition(".")[0] not in _LEFT_OUT
    ]


def _texts(config: Mapping[str, Any]) -> dict[str, str]:
    """Text of each setting by its path."""
    return {
        path: json.dumps(_without_nulls(value), ensure_ascii=False)
        for path, value in leaves(config)
    }


def _without_nulls(value: Any) -> Any:
    """A value whose mappings have no null: not all the kinds that a block could have."""
    if isinstance(value, Mapping):
        return {key: _without_nulls(item) for key, item in value.items() if item is not None}
    return [_without_nulls(item) for item in value] if isinstance(value, list) else value


def _section(campaign: Campaign, section: str) -> dict[str, Any]:
    figures = []
    for name, figure in figures_by_name(campaign).items():
        if FIGURES[figure].section == section:
            figures.append(
                {"name": name, "title": _title(name), "caption": FIGURES[figure].caption}
            )
    tables = [
        {"name": name, "title": _title(name), "caption": table_of(name).description}
        for name in table_names(campaign)
        if table_of(name).section == section
    ]
    return {"title": SECTIONS[section], "figures": figures, "tables": tables}


def _title(name: str) -> str:
    words = name.replace("_", " ")
    return words[:1].upper() + words[1:]
