"""Put the tables of all cases below one another."""

from burstcast_workflow.harness.job import job
from burstcast_workflow.harness.settings import Settings
from burstcast_workflow.jobs.joined_tables import write_joined


@job
def join(*, of_cases: list[str], tables: list[str], settings: Settings) -> None:
    """Write the rows of all cases."""
    write_joined(of_cases, tables, settings)
