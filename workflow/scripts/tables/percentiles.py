"""Take percentiles over networks of a table with one row for each network."""

from burstcast import tables
from burstcast_workflow.harness.job import run_job
from burstcast_workflow.harness.settings import Settings
from burstcast_workflow.harness.tables import read_table, write_table
from burstcast_workflow.table_metrics import NETWORK_KEYS, SUMMARIES


def take_percentiles(*, table: str, percentiles: str, settings: Settings) -> None:
    """Write the percentiles in long form."""
    summary = SUMMARIES[settings["table"]]
    keys = [*NETWORK_KEYS, *summary.keys]
    found = read_table(table)
    metrics = [metric for metric in summary.metrics if metric in found]
    write_table(percentiles, tables.percentiles(found, keys, metrics))


if __name__ == "__main__":
    run_job(snakemake, take_percentiles)  # noqa: F821 - Snakemake puts it there
