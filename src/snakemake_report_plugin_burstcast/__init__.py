"""The report of a campaign, as a report plugin of Snakemake, which finds it by this name."""

from burstcast_report.reporter import PageReporter as Reporter
from burstcast_report.reporter import PageSettings as ReportSettings

__all__ = ["ReportSettings", "Reporter"]
