"""Gather the summaries of all cases into the table of the dataset."""

from typing import Any

from burstcast import durations
from burstcast_workflow.gather import CASE, by_key, gathered
from burstcast_workflow.job import Provenance, run_job
from burstcast_workflow.storage import read_json
from burstcast_workflow.table_files import keyed_table, write_table


def main(inputs: Any, outputs: Any, settings: dict[str, Any], provenance: Provenance) -> None:
    """Write one row for each case."""
    rows = []
    events, lyapunov = (
        by_key(settings["cases"], paths, CASE) for paths in (inputs.events, inputs.lyapunov)
    )
    for case, dataset in gathered(settings["cases"], inputs.dataset, CASE):
        summary = read_json(dataset)
        leading = read_json(lyapunov[case["case"]])["leading"]
        steps = case["steps_per_lyapunov_time"] or durations.steps_per_lyapunov_time(
            leading["mean"], case["sampling_interval"]
        )
        rows.append(
            {
                "case": case["case"],
                "reynolds": case["reynolds"],
                "series_generated": summary["series_generated"],
                "series_kept": summary["series_kept"],
                "laminarised_fraction": summary["laminarised_fraction"],
                "mean_kinetic_energy": summary["mean_observable"],
                "events_per_series": read_json(events[case["case"]])["events_per_series"],
                "lyapunov_exponent": leading["mean"],
                "lyapunov_exponent_low": leading["low"],
                "lyapunov_exponent_high": leading["high"],
                "lyapunov_exponent_paper": case["published_exponent"],
                "steps_per_lyapunov_time": steps,
            }
        )
    write_table(outputs.table, keyed_table(rows))


if __name__ == "__main__":
    run_job(snakemake, main)  # noqa: F821 - Snakemake puts it there
