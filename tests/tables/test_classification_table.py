"""Scores of forecasts: what is compared with what, and what does not count."""

import numpy as np

from burstcast.base.names import parsed
from burstcast.tables.makers.classification_table import make
from burstcast.tables.makers.registry import Gathered

LOW, HIGH, LOST = [0.05, 0.05, 0.05], [0.05, 0.2, 0.2], [np.nan] * 3
# first and largest true observable of each window, those of the forecast, the washout's largest
POINTS = [
    ("true_positive", LOW, HIGH, LOW, HIGH, 0.05),
    ("false_positive", LOW, LOW, LOW, HIGH, 0.05),
    ("false_negative", LOW, HIGH, LOW, LOW, 0.05),
    ("true_negative", LOW, LOW, LOW, LOW, 0.05),
    ("", LOW, HIGH, LOW, HIGH, 0.1),  # skipped: the washout reaches the threshold
    ("", LOW, HIGH, LOW, HIGH, 0.5),  # skipped
    ("true_positive", LOW, HIGH, LOW, HIGH, np.nextafter(0.1, 0)),
    ("false_positive", HIGH, HIGH, LOW, HIGH, 0.05),  # the true event is under way
    ("false_negative", LOW, HIGH, HIGH, HIGH, 0.05),  # the forecast one is
    ("false_negative", LOW, HIGH, LOST, LOST, 0.05),
    ("true_negative", LOW, LOW, LOST, LOST, 0.05),
]
OUTCOMES = ("true_positive", "false_positive", "false_negative", "true_negative")


def rows_of(points, series):
    columns = [np.asarray(column) for column in zip(*points, strict=True)]
    _, first, largest, forecast_first, forecast_largest, washouts = columns
    forecast = {
        **{"first": forecast_first, "largest": forecast_largest},
        "diverged": np.zeros(len(points), dtype=bool),
        **dict.fromkeys(["member_first", "member_largest"], np.empty((len(points), 0, 3))),
    }
    truth = {"series": np.asarray(series), "first": first, "largest": largest}
    return make(
        forecasts=[Gathered(parsed("equations"), forecast)],
        evaluation_set={**truth, "washout_maximum": washouts},
        **{"calibration": None, "case": "Re400", "root_seed": 1, "event_threshold": 0.1},
        **{"prediction_times_lt": [1.0], "window_lt": 1.0, "resolution_lt": 0.5},
        **{"resamples": 200, "confidence": 0.9},
    )


def test_forecast_and_truth_are_judged_alike_and_events_under_way_are_skipped():
    for point in POINTS:
        equations, always = rows_of([point], [0])["classification"]
        assert {name for name in OUTCOMES if equations[name]} == {point[0]} - {""}
        happened = point[0] in ("true_positive", "false_negative")
        alarm = {"true_positive" if happened else "false_positive"} if point[0] else set()
        assert {name for name in OUTCOMES if always[name]} == alarm
        assert always["forecaster"] == "permanent_alarm"


def test_points_of_all_series_are_counted_and_resampled_by_series():
    tables = rows_of(POINTS, np.arange(len(POINTS)) % 4)
    row = tables["classification"][0]
    assert [row[name] for name in OUTCOMES] == [2, 2, 3, 2]
    assert (row["precision"], row["recall"]) == (0.5, 0.4)
    # two of the nine that count
    assert row["invalid_fraction"] == 2 / 9
    assert np.isnan(tables["classification"][1]["invalid_fraction"])
    ends = {row["metric"]: row for row in tables["classification_intervals"][:3]}
    for metric in ("precision", "recall", "f_score"):
        assert ends[metric]["low"] < row[metric] < ends[metric]["high"]
    # alike in all series: nothing is open
    alike = rows_of(POINTS[:3] * 4, np.repeat(np.arange(4), 3))["classification_intervals"]
    assert {(row["low"], row["high"]) for row in alike[:3]} == {(0.5, 0.5)}
