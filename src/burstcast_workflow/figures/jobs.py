"""Inputs and settings of jobs of the rule of figures (`burstcast_workflow.figures.registry`)."""

from typing import Any

from snakemake.io import local

from burstcast_workflow.campaign.campaign import Campaign
from burstcast_workflow.figures.registry import FIGURES, figure_case, files_of, settings_of
from burstcast_workflow.stages.stages import Stages
from burstcast_workflow.tables.declarations import SECTIONS
from burstcast_workflow.tables.registry import table_names, table_of

_SCRIPT = "figures/figure.py"


class FigureJobs:
    """Inputs, parameters and place in the report, by the wildcards of a figure's job."""

    def __init__(self, stages: Stages, published: str) -> None:
        self._stages, self._published = stages, published
        self._campaign = stages.campaign
        stages.read_code(_SCRIPT, {"burstcast.figures": [*FIGURES]})

    def case(self, wildcards: Any) -> str:
        """The case that a figure shows."""
        return figure_case(self._campaign, wildcards.figure, wildcards.of_case)

    def files(self, wildcards: Any) -> dict[str, Any]:
        """Inputs of a figure."""
        figure = FIGURES[wildcards.figure]
        paths = files_of(self._campaign, figure, self.case(wildcards))
        inputs: dict[str, Any] = {
            name: self._stages.in_results(path) for name, path in paths.items()
        }
        overlay = figure.published and self._campaign.config.figures.published_overlay
        if overlay or figure.always_published:
            inputs["published"] = local(self._published)
        return inputs

    def settings(self, wildcards: Any) -> Any:
        """Settings of a figure."""
        return settings_of(self._campaign, FIGURES[wildcards.figure], self.case(wildcards))

    def code(self, wildcards: Any) -> dict[str, str]:
        """Code of a figure: the script of all figures, the figure's own module."""
        by_name = {"burstcast.figures": [wildcards.figure]}
        return self._stages.code_of(_SCRIPT, {"case": self.case(wildcards)}, by_name)

    def category(self, wildcards: Any) -> str:
        """Section of the report that a figure stands in."""
        return SECTIONS[FIGURES[wildcards.figure].section]

    def labels(self, wildcards: Any) -> dict[str, str]:
        """Labels of a figure in the report: its name, and the case, which is a switch there."""
        places = [file.path.partition("/")[0] for file in FIGURES[wildcards.figure].files.values()]
        several = any(place.endswith("_cases") for place in places)
        case = "several" if several else self.case(wildcards)
        return {"figure": wildcards.figure, "case": case}


def captions(campaign: Campaign) -> dict[str, dict[str, str]]:
    """Captions of figures and tables by name, for the report."""
    return {
        "figures": {name: figure.caption for name, figure in FIGURES.items()},
        "tables": {name: table_of(name).description for name in table_names(campaign)},
    }
