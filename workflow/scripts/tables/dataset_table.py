"""Gather the summaries of a case into its row of the table of the dataset."""

from burstcast_workflow.harness.job import run_job
from burstcast_workflow.harness.settings import Settings
from burstcast_workflow.harness.storage import read_json
from burstcast_workflow.harness.tables import keyed_table, write_table
from burstcast_workflow.jobs.time_unit import lyapunov_time


def dataset_table(
    *, summary: str, events_summary: str, exponents: str, table: str, settings: Settings
) -> None:
    """Write one row."""
    dataset, found = read_json(summary), read_json(exponents)
    leading, growth = found["leading"], found.get("leading_by_growth", {})
    row = {
        **settings["keys"],
        "series_generated": dataset["series_generated"],
        "series_kept": dataset["series_kept"],
        "laminarised_fraction": dataset["laminarised_fraction"],
        "mean_observable": dataset["mean_observable"],
        "events_per_series": read_json(events_summary)["events_per_series"],
        "lyapunov_exponent": leading["mean"],
        "lyapunov_exponent_low": leading["low"],
        "lyapunov_exponent_high": leading["high"],
        "lyapunov_exponent_by_growth": growth.get("mean"),
        "lyapunov_exponent_by_growth_low": growth.get("low"),
        "lyapunov_exponent_by_growth_high": growth.get("high"),
        "lyapunov_exponent_paper": settings["case.lyapunov.published_exponent"],
        "steps_per_lyapunov_time": lyapunov_time(settings, exponents),
    }
    write_table(table, keyed_table([row]))


if __name__ == "__main__":
    run_job(snakemake, dataset_table)  # noqa: F821 - Snakemake puts it there
