"""Score the forecasts of all forecasters at every prediction time."""

from burstcast import random_streams
from burstcast.files.netcdf import read_netcdf
from burstcast.forecast.classification import SCORES, bootstrap_interval, score_forecasts, total
from burstcast.forecast.windows import WindowSummaries
from burstcast_workflow.harness.job import job
from burstcast_workflow.harness.settings import Settings
from burstcast_workflow.jobs.gather import gathered
from burstcast_workflow.jobs.tables import write_tables


@job
def classification_table(
    *, forecasts: list[str], evaluation_set: str, tables: list[str], settings: Settings
) -> None:
    """Write counts and scores, and the bootstrap intervals of the scores."""
    truth = read_netcdf(evaluation_set, "series", "washout_maximum", "first", "largest")
    resolution = settings["classification.resolution_lt"]
    rows, ends = [], []
    for keys, origin in gathered(settings, forecasts):
        forecast = WindowSummaries(**read_netcdf(origin.path, "first", "largest"))
        for prediction_time in settings["classification.prediction_times_lt"]:
            counts = score_forecasts(
                forecast,
                WindowSummaries(truth["first"], truth["largest"]),
                truth["washout_maximum"],
                truth["series"],
                first_window=round(prediction_time / resolution) - 1,
                windows=round(settings["classification.window_lt"] / resolution),
                threshold=settings["case.event_threshold"],
            )
            whole = total(counts)
            row = {**keys, "prediction_time_lt": prediction_time}
            rows.append(
                {
                    **row,
                    **{name: int(count) for name, count in vars(whole).items()},
                    **{name: float(getattr(whole, name)) for name in SCORES},
                }
            )
            generator = random_streams.stream(
                settings["random_seed"], "bootstrap", settings["case"], str(prediction_time)
            )
            for metric, (low, high) in bootstrap_interval(
                counts,
                settings["bootstrap.resamples"],
                settings["bootstrap.confidence"],
                generator,
            ).items():
                ends.append({**row, "metric": metric, "low": low, "high": high})
    write_tables(tables, settings, classification=rows, classification_intervals=ends)
