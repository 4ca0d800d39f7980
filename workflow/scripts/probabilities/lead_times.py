"""How long before each event of the test series alarms came, and how many were false."""

from typing import Any

import numpy as np

from burstcast import durations
from burstcast.data.starting_points import SeriesPoints, crossing_points
from burstcast.files.netcdf import read_rows
from burstcast.forecast.classification import count_by_series
from burstcast.probability.intervals import ratio_with_interval
from burstcast.probability.lead_times import SeriesRatio, lead_time_scores, lead_times
from burstcast_workflow.harness.job import job
from burstcast_workflow.harness.settings import Settings
from burstcast_workflow.jobs.probabilities import CALIBRATED, case_probabilities, read_rules
from burstcast_workflow.jobs.tables import write_tables


@job
def measure_lead_times(
    *,
    ensemble: str,
    forecasts: list[str],
    evaluation_set: str,
    calibration: str,
    tables: list[str],
    settings: Settings,
) -> None:
    """Write how early events were warned of, and false alarms, with their intervals."""
    times = settings["classification.prediction_times_lt"]
    window_lt = settings["classification.window_lt"]
    rows: list[dict[str, Any]] = []
    case = case_probabilities(settings, forecasts, evaluation_set, calibration)
    points, series, threshold = case.points, case.points.series, settings["case.event_threshold"]
    steps = case.chosen["steps_per_lyapunov_time"]
    first = settings["case.training.series"]
    truth = read_rows(ensemble, "observable", first, first + series)
    events = crossing_points(truth, threshold)
    # where there was nothing to calibrate with, no alarm is known, and nothing is scored
    scored = points.scored(threshold) & case.is_calibrated
    rows_of_points = points.data["series"]
    windows = [
        (durations.steps(time, steps), durations.steps(time + window_lt, steps)) for time in times
    ]
    weights = case.weights(0.0)  # the same for all prediction times, too
    # how long each series was watched, in Lyapunov times
    starts = np.bincount(rows_of_points[scored], minlength=series).astype(np.float64)
    watched = starts * np.float64(settings["classification.start_spacing_lt"])
    for alarm in case.alarms:
        raised, false_alarms = [], []
        for time in times:
            rule = read_rules(case.chosen, alarm, time)[CALIBRATED]
            values = points.values(alarm, time, threshold)
            raised.append(rule.calibration(values) >= rule.threshold)
            happened = points.happened(time, threshold)
            counts = count_by_series(raised[-1], happened, scored, rows_of_points)
            false = counts.false_positive.astype(np.float64)
            false_alarms.append(SeriesRatio("false_alarms_per_lt", time, false, watched))
        found = lead_times(
            np.stack(raised, axis=1),
            windows,
            SeriesPoints(rows_of_points, points.data["step"]),
            scored,
            events,
        )
        for score in [*lead_time_scores(found, series, times, steps), *false_alarms]:
            value, low, high = ratio_with_interval(
                score.numerator, score.denominator, weights, settings["bootstrap.confidence"]
            )
            rows.append(
                {
                    **case.keys(alarm),
                    "lead_time_lt": score.lead_time_lt,
                    "metric": score.metric,
                    "value": value,
                    "low": low,
                    "high": high,
                }
            )
    write_tables(tables, settings, lead_times=rows)
