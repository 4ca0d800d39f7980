"""Gather the summaries of all cases into the table of the dataset."""

from burstcast_workflow.harness.job import run_job
from burstcast_workflow.harness.settings import Settings
from burstcast_workflow.harness.storage import read_json
from burstcast_workflow.harness.tables import keyed_table, write_table
from burstcast_workflow.jobs.gather import files_of_cases, gathered
from burstcast_workflow.jobs.time_unit import lyapunov_time


def dataset_table(
    *,
    summaries: list[str],
    events: list[str],
    exponents: list[str],
    table: str,
    settings: Settings,
) -> None:
    """Write one row for each case."""
    events_of = files_of_cases(settings["cases"], events)
    # a case that is a part of another one has that one's
    whose = settings["exponents_of"]
    wanted = [{"identity": {"case": case}} for case in dict.fromkeys(whose.values())]
    found_of = files_of_cases(wanted, exponents)
    exponents_of = {case: found_of[other] for case, other in whose.items()}
    rows = []
    for record, path in gathered(settings["cases"], summaries):
        case, of_case = record["identity"]["case"], record["settings"]
        summary = read_json(path)
        exponents_found = read_json(exponents_of[case])
        leading, growth = exponents_found["leading"], exponents_found.get("leading_by_growth", {})
        rows.append(
            {
                **record["keys"],
                "series_generated": summary["series_generated"],
                "series_kept": summary["series_kept"],
                "laminarised_fraction": summary["laminarised_fraction"],
                "mean_observable": summary["mean_observable"],
                "events_per_series": read_json(events_of[case])["events_per_series"],
                "lyapunov_exponent": leading["mean"],
                "lyapunov_exponent_low": leading["low"],
                "lyapunov_exponent_high": leading["high"],
                "lyapunov_exponent_by_growth": growth.get("mean"),
                "lyapunov_exponent_by_growth_low": growth.get("low"),
                "lyapunov_exponent_by_growth_high": growth.get("high"),
                "lyapunov_exponent_paper": of_case["case.lyapunov.published_exponent"],
                "steps_per_lyapunov_time": lyapunov_time(of_case, exponents_of[case]),
            }
        )
    write_table(table, keyed_table(rows))


if __name__ == "__main__":
    run_job(snakemake, dataset_table)  # noqa: F821 - Snakemake puts it there
