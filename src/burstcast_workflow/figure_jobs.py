"""What the one rule of figures asks for each job (`burstcast_workflow.figure_registry`)."""

from pathlib import Path
from typing import Any

from snakemake.io import local

from burstcast_workflow.campaign import Campaign
from burstcast_workflow.figure_registry import FIGURES, caption, figure_case
from burstcast_workflow.fingerprint import Sources
from burstcast_workflow.harness.thresholds import INPUT as THRESHOLDS
from burstcast_workflow.report_sections import category
from burstcast_workflow.stages import Stages
from burstcast_workflow.tables.registry import table_names, table_of


class FigureJobs:
    """Inputs, parameters and place in the report, by the wildcards of a figure's job.

    Parameters
    ----------
    stages
        Where files lie.
    sources
        The code that jobs run.
    published
        File of the published values.
    """

    def __init__(self, stages: Stages, sources: Sources, published: str) -> None:
        self._stages, self._sources, self._published = stages, sources, published
        self._campaign = stages.campaign

    def case(self, wildcards: Any) -> str:
        """The case that a figure shows."""
        return figure_case(self._campaign, wildcards.figure, wildcards.of_case)

    def files(self, wildcards: Any) -> dict[str, Any]:
        """What a figure is drawn from."""
        figure = FIGURES[wildcards.figure]
        paths = figure.files(self._campaign, self.case(wildcards))
        found: dict[str, Any] = {
            name: self._stages.in_results(path) for name, path in paths.items()
        }
        if self._stages.has_quantiles:
            found[THRESHOLDS] = self._stages.thresholds_of(self.settings(wildcards))
        if figure.published and self._campaign.config["figures"]["published_overlay"]:
            found["published"] = local(self._published)
        return found

    def settings(self, wildcards: Any) -> Any:
        """What a figure's script reads."""
        figure, case = FIGURES[wildcards.figure], self.case(wildcards)
        values = figure.values(self._campaign, case)
        return self._campaign.settings(figure.reads, {"case": case}, values)

    def code(self, wildcards: Any) -> list[str]:
        """What a figure's script runs."""
        modules = self._campaign.modules({"case": self.case(wildcards)})
        return self._sources.fingerprint(f"figures/{wildcards.figure}.py", modules)

    def category(self, wildcards: Any) -> str:
        """Section of the report that a figure stands in."""
        return category("figures", wildcards.figure)

    def labels(self, wildcards: Any) -> dict[str, str]:
        """What the report calls a figure: its name, and the case, which is a switch there."""
        several = FIGURES[wildcards.figure].of_several_cases
        case = "several" if several else self.case(wildcards)
        return {"figure": wildcards.figure, "case": case}


def captions(campaign: Campaign, scripts: Path) -> dict[str, dict[str, str]]:
    """What figures and tables show, by their names, as the report asks for it.

    Parameters
    ----------
    scripts
        Directory of the figures' scripts, whose docstrings are the captions.
    """
    return {
        "figures": {name: caption(scripts / f"{name}.py") for name in FIGURES},
        "tables": {name: table_of(name).says for name in table_names(campaign)},
    }
