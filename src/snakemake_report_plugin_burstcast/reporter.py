"""The report of a campaign as one page: ``snakemake --reporter burstcast`` writes report.html.

What Snakemake hands over, the files that rules flag with ``report()``, with their sections, labels
and captions, goes to `burstcast_workflow.report_page`. Snakemake looks through all plugins whenever
it starts, so that nothing of burstcast is imported before a report is made.
"""

from dataclasses import dataclass, field
from pathlib import Path

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
        from burstcast_workflow.report_page import Flagged, page
        from burstcast_workflow.why import names_of_rules

        names = names_of_rules(self.dag.workflow)
        flagged = [
            Flagged(Path(record.path), category.name, dict(record.labels), record.caption)
            for category, subcategories in self.results.items()
            for records in subcategories.values()
            for record in records
        ]
        # of a job without times Snakemake says that it ended before it began
        known = [job for job in self.jobs if job.starttime <= job.endtime]
        first, last = (job.starttime for job in known), (job.endtime for job in known)
        text = page(
            flagged,
            names["campaign"],
            Path(names["run"].results),
            self.workflow_description,
            (min(first), max(last)) if known else None,
        )
        target = Path(self.settings.path)
        partial = target.with_name(f".{target.name}.partial")
        partial.write_text(text, encoding="utf-8")
        partial.replace(target)
