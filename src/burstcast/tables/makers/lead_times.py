"""Lead times of alarms before events of the test series, and false alarms."""

import numpy as np

from burstcast.base import durations
from burstcast.base.declared import at, declaring, made_by, read
from burstcast.base.files.netcdf import read_rows
from burstcast.data.starting_points import SeriesPoints, crossing_points
from burstcast.forecasts.alarms import CALIBRATED
from burstcast.forecasts.lead_times import SeriesRatio, lead_time_scores, lead_times
from burstcast.tables.makers._probabilities import CaseProbabilities, case_probabilities
from burstcast.tables.makers.registry import Rows


@declaring
def make(
    *,
    case: CaseProbabilities = made_by(case_probabilities),
    ensemble: str = read("case/ensemble.nc:path"),
    training_series: int = at("case.training.series"),
    start_spacing_lt: float = at("classification.start_spacing_lt"),
    window_lt: float = at("classification.window_lt"),
) -> dict[str, Rows]:
    """Lead times and false alarms with their intervals."""
    points, series, threshold = case.points, case.points.series, case.event_threshold
    times, steps = case.times, case.chosen["steps_per_lyapunov_time"]
    truth = read_rows(ensemble, "observable", training_series, training_series + series)
    events = crossing_points(truth, threshold)
    # where there was nothing to calibrate with, no alarm is known, and nothing is scored
    in_scored = points.scored(threshold) & case.is_calibrated
    rows_of_points = points.data["series"]
    windows = [
        (durations.steps(time, steps), durations.steps(time + window_lt, steps)) for time in times
    ]
    weights = case.weights(0.0)  # the same for all prediction times, too
    # how long each series was watched, in Lyapunov times
    starts = np.bincount(rows_of_points[in_scored], minlength=series).astype(np.float64)
    watched = starts * np.float64(start_spacing_lt)
    rows: Rows = []
    for alarm in case.alarms:
        raised, false_alarms = [], []
        for time in times:
            rule = case.rules(alarm, time)[CALIBRATED]
            values = points.values(alarm, time, threshold)
            raised.append(rule.alarms(values))
            happened = points.happened(time, threshold)
            wrong = rows_of_points[raised[-1] & ~happened & in_scored]
            false = np.bincount(wrong, minlength=series).astype(np.float64)
            false_alarms.append(SeriesRatio("false_alarms_per_lt", time, false, watched))
        warnings_given = lead_times(
            np.stack(raised, axis=1),
            windows,
            SeriesPoints(rows_of_points, points.data["step"]),
            in_scored,
            events,
        )
        for score in [*lead_time_scores(warnings_given, series, times, steps), *false_alarms]:
            keys = {"lead_time_lt": score.lead_time_lt, "metric": score.metric}
            interval = score.with_interval(weights, case.confidence)
            rows.append({**case.keys(alarm), **keys, **interval})
    return {"lead_times": rows}
