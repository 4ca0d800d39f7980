"""Score the forecasts of all networks at every prediction time."""

from typing import Any

from burstcast import random_streams
from burstcast.forecast.classification import bootstrap_interval, score_forecasts, total
from burstcast.forecast.windows import WindowSummaries
from burstcast_workflow.gather import CASE, NETWORK, by_key, gathered
from burstcast_workflow.job import Provenance, run_job
from burstcast_workflow.storage import read_netcdf
from burstcast_workflow.table_files import keyed_table, write_table


def main(inputs: Any, outputs: Any, settings: dict[str, Any], provenance: Provenance) -> None:
    """Write counts and scores, and the bootstrap intervals of the scores."""
    cases = by_key(settings["cases"], inputs.test_sets, CASE)
    test_sets = {
        case: read_netcdf(path, "series", "washout_maximum", "first", "largest")
        for case, path in cases.items()
    }
    thresholds = {record["case"]: record["event_threshold"] for record in settings["cases"]}
    bootstrap = settings["bootstrap"]
    resolution = settings["resolution_lt"]
    rows, intervals = [], []
    for keys, path in gathered(settings["networks"], inputs.forecasts, NETWORK):
        case = keys["case"]
        test_set = test_sets[case]
        forecast = read_netcdf(path, "first", "largest")
        for prediction_time in settings["prediction_times_lt"]:
            counts = score_forecasts(
                WindowSummaries(forecast["first"], forecast["largest"]),
                WindowSummaries(test_set["first"], test_set["largest"]),
                test_set["washout_maximum"],
                test_set["series"],
                first_window=round(prediction_time / resolution) - 1,
                windows=round(settings["window_lt"] / resolution),
                threshold=thresholds[case],
            )
            whole = total(counts)
            row = {**keys, "prediction_time_lt": prediction_time}
            rows.append(
                {
                    **row,
                    "true_positive": int(whole.true_positive),
                    "false_positive": int(whole.false_positive),
                    "false_negative": int(whole.false_negative),
                    "true_negative": int(whole.true_negative),
                    "precision": float(whole.precision),
                    "recall": float(whole.recall),
                    "f_score": float(whole.f_score),
                }
            )
            generator = random_streams.stream(
                settings["random_seed"], "bootstrap", case, str(prediction_time)
            )
            for metric, (low, high) in bootstrap_interval(
                counts, bootstrap["resamples"], bootstrap["confidence"], generator
            ).items():
                intervals.append({**row, "metric": metric, "low": low, "high": high})
    write_table(outputs.table, keyed_table(rows))
    write_table(outputs.intervals, keyed_table(intervals))


if __name__ == "__main__":
    run_job(snakemake, main)  # noqa: F821 - Snakemake puts it there
