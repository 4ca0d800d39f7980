"""Figures of a campaign: the cases that each is made for, its files and settings.

A figure is a module of `burstcast.figures`, whose function declares what it is made of
(`burstcast_workflow.figures.declarations`). One rule makes all of them
(``workflow/rules/figures.smk``).
"""

from collections.abc import Mapping
from typing import Any

from burstcast.base.discovery import suggestion
from burstcast_workflow.campaign.campaign import Campaign
from burstcast_workflow.campaign.job_settings import check_paths, names_of, settings_of_job
from burstcast_workflow.campaign.shown import Choices, Shown
from burstcast_workflow.figures.declarations import Declaration, keep, remembered
from burstcast_workflow.tables.declarations import SECTIONS


def _declared() -> dict[str, Declaration]:
    """Declarations of all figures, checked, in the order of the report."""
    from burstcast.figures.registry import available_figures, caption, figure_of  # loads Matplotlib

    figures = {name: Declaration.of(figure_of(name), caption(name)) for name in available_figures()}
    for name, figure in figures.items():
        places = [file.path.partition("/")[0] for file in figure.files.values() if not file.of_each]
        gathered = [file.path.partition("/")[0] for file in figure.files.values() if file.of_each]
        for noun, values, allowed in (
            ("section", [figure.section], [*SECTIONS]),
            ("choice of cases", [figure.cases], names_of(Choices)),
            ("place", places, [*names_of(Shown), "case"]),
            ("place", gathered, names_of(Campaign)),
        ):
            for value in values:
                if value not in allowed:
                    similar = suggestion(value, allowed)
                    raise ValueError(f"the figure {name} declares the {noun} {value!r}{similar}")
        try:
            check_paths(figure.paths)
        except LookupError as error:
            raise ValueError(f"the figure {name}: {error.args[0]}") from None

    def place(name: str) -> tuple[str, int]:
        return SECTIONS[figures[name].section], figures[name].position

    return {name: figures[name] for name in sorted(figures, key=place)}


_remembered = remembered()
FIGURES: Mapping[str, Declaration] = _remembered.figures or _declared()
"""All figures by name, in the order of the report."""


def keep_figures() -> None:
    """Remember what figures declare (`burstcast_workflow.figures.declarations`)."""
    if not _remembered.figures:
        keep(_remembered.code, FIGURES)


def cases_of(campaign: Campaign, figure: Declaration) -> list[str]:
    """Cases that a figure is made for."""
    if figure.needs_networks and not campaign.networks:
        return []
    cases = getattr(Choices(campaign), figure.cases)
    return [case for case in cases if not figure.only_flows or campaign.cases[case].is_flow]


def files_of(campaign: Campaign, figure: Declaration, case: str) -> dict[str, str | list[str]]:
    """Files of a figure by the name of its argument, below the results directory."""
    shown = Shown(campaign, case)
    return {name: shown.paths(file) for name, file in figure.files.items()}


def settings_of(campaign: Campaign, figure: Declaration, case: str) -> dict[str, Any]:
    """Settings of a figure by path."""
    return settings_of_job(campaign, figure.paths, {"case": case})


def figure_case(campaign: Campaign, name: str, suffix: str) -> str:
    """Case that a figure shows: named by its name's end, or the first that it is made for."""
    if suffix:
        return suffix.removeprefix("_")
    return next(iter(cases_of(campaign, FIGURES[name])), campaign.example.case)


def figures_by_name(campaign: Campaign) -> dict[str, str]:
    """All figures of a campaign: the name of each file, and the figure that it shows."""
    return {
        figure if index == 0 else f"{figure}_{case}": figure
        for figure, drawn in FIGURES.items()
        for index, case in enumerate(dict.fromkeys(cases_of(campaign, drawn)))
    }


def figure_names(campaign: Campaign) -> list[str]:
    """Names of all figures of a campaign."""
    return [*figures_by_name(campaign)]
