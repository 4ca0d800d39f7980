"""Put the tables of all cases below one another."""

from burstcast_workflow.harness.job import run_job
from burstcast_workflow.harness.settings import Settings
from burstcast_workflow.jobs.joined_tables import write_joined


def join(*, of_cases: list[str], tables: list[str], settings: Settings) -> None:
    """Write the rows of all cases."""
    write_joined(of_cases, tables, settings)


if __name__ == "__main__":
    run_job(snakemake, join)  # noqa: F821 - Snakemake puts it there
