"""The report of a campaign: one page with its settings, numbers, warnings, figures and tables."""

from pathlib import Path
from typing import Any

from burstcast_workflow.harness.job import JobSettings, at, job, write_text
from burstcast_workflow.summary import found_warnings, summary_table


class ReportSettings(JobSettings):
    """Settings of the page."""

    report: dict[str, Any] = at("report")


@job
def report_page(
    *, figures: list[str], tables: list[str], template: str, page: str, settings: ReportSettings
) -> None:
    """Write the page."""
    # loaded here, with pandas: jobs from the cache start without it
    from burstcast_workflow.jobs.report import render, rows_of

    of_campaign = {Path(path).stem: Path(path) for path in tables}
    pictures = {Path(path).stem: Path(path) for path in figures}
    content: dict[str, Any] = {
        "numbers": rows_of(summary_table(of_campaign)),
        "warnings": found_warnings(of_campaign),
        "provenance": settings.provenance,
    }
    text = render(Path(template), settings.report, pictures, of_campaign, content)
    write_text(page, text)
