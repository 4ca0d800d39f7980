"""The report of a campaign as one page: ``snakemake --reporter burstcast`` writes report.html.

The files that rules flag with ``report()`` go to `burstcast_report.page`, with their labels and
captions. Snakemake imports all plugins whenever it starts: burstcast's other modules are imported
only when a report is made.
"""

from dataclasses import dataclass, field
from html import escape
from pathlib import Path
from typing import Any

from snakemake_interface_report_plugins.reporter import ReporterBase
from snakemake_interface_report_plugins.settings import ReportSettingsBase


@dataclass
class PageSettings(ReportSettingsBase):  # type: ignore[misc]
    """Options of the command line: ``--report-burstcast-path``."""

    path: Path = field(
        default=Path("report.html"),
        metadata={"help": "file of the page", "required": False, "env_var": False},
    )


class PageReporter(ReporterBase):  # type: ignore[misc]
    """Writes the page."""

    def render(self) -> None:
        """Write it, whole or not at all."""
        from burstcast_report.page import Flagged, page
        from burstcast_workflow.costs.records import rule_costs
        from burstcast_workflow.harness.storage import write_text
        from burstcast_workflow.start import names_of_rules
        from burstcast_workflow.tables.registry import table_of

        workflow = self.dag.workflow
        names = names_of_rules(workflow)

        def caption(record: Any) -> str:
            # a job writes several tables, for which Snakemake has one caption
            table = record.labels.get("table")
            return f"<p>{escape(table_of(table).says)}</p>" if table else str(record.caption)

        flagged = [
            Flagged(Path(record.path), dict(record.labels), caption(record))
            for subcategories in self.results.values()
            for records in subcategories.values()
            for record in records
        ]
        # a job without times ends before it begins, by Snakemake's defaults
        known = [job for job in self.jobs if job.starttime <= job.endtime]
        first, last = (job.starttime for job in known), (job.endtime for job in known)
        text = page(
            flagged,
            names["campaign"],
            Path(names["run"].results),
            self.workflow_description,
            rule_costs(workflow, names["costs"]),
            (min(first), max(last)) if known else None,
        )
        write_text(self.settings.path, text)
