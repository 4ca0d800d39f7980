"""Gather the summaries of a case into its row of the table of the dataset."""

from burstcast_workflow.harness.job import job
from burstcast_workflow.harness.settings import Settings
from burstcast_workflow.harness.storage import read_json
from burstcast_workflow.jobs.gather import case_keys
from burstcast_workflow.jobs.tables import with_ends, write_tables
from burstcast_workflow.jobs.time_unit import lyapunov_time

ENDS = ("mean", "low", "high")


@job
def dataset_table(
    *, summary: str, events_summary: str, exponents: str, tables: list[str], settings: Settings
) -> None:
    """Write one row."""
    dataset, found = read_json(summary), read_json(exponents)
    leading, growth = found["leading"], found.get("leading_by_growth", {})
    row = {
        **case_keys(settings),
        "series_generated": dataset["series_generated"],
        "series_kept": dataset["series_kept"],
        "laminarised_fraction": dataset["laminarised_fraction"],
        "mean_observable": dataset["mean_observable"],
        "events_per_series": read_json(events_summary)["events_per_series"],
        **with_ends("lyapunov_exponent", *map(leading.get, ENDS)),
        **with_ends("lyapunov_exponent_by_growth", *map(growth.get, ENDS)),
        "lyapunov_exponent_paper": settings["case.lyapunov.published_exponent"],
        "steps_per_lyapunov_time": lyapunov_time(settings, exponents),
    }
    write_tables(tables, settings, dataset=[row])
