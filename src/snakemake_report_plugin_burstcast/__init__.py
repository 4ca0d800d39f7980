"""The report of a campaign, as a report plugin of Snakemake, which finds it by this name."""

from snakemake_report_plugin_burstcast.reporter import PageReporter as Reporter
from snakemake_report_plugin_burstcast.reporter import PageSettings as ReportSettings

__all__ = ["ReportSettings", "Reporter"]
