"""Score the forecasts of all forecasters at every prediction time."""

from collections.abc import Mapping, Sequence
from typing import Any

from burstcast import random_streams
from burstcast.forecast.classification import (
    SCORES,
    bootstrap_interval,
    count_by_series,
    score_forecasts,
    total,
)
from burstcast.forecast.event_probabilities import EventProbabilities
from burstcast.forecast.forecast_files import forecasts_from
from burstcast.forecast.windows import WindowSummaries, crosses
from burstcast.forecasters._names import PERMANENT_ALARM, ForecasterName
from burstcast.probability.alarm_rule import CALIBRATED, rules_of
from burstcast.tables.makers.registry import Declaration, Gathered, Rows

TABLES = Declaration(
    inputs={"evaluation_set": "series washout_maximum first largest", "calibration": ""},
    gathered={"forecasts": ""},
    settings="case root_seed=random_seed case.event_threshold classification.prediction_times_lt "
    "classification.window_lt classification.resolution_lt bootstrap.resamples "
    "bootstrap.confidence",
)


def make(
    *,
    forecasts: Sequence[Gathered],
    evaluation_set: Mapping[str, Any],
    calibration: Mapping[str, Any] | None,
    case: str,
    root_seed: int,
    event_threshold: float,
    prediction_times_lt: Sequence[float],
    window_lt: float,
    resolution_lt: float,
    resamples: int,
    confidence: float,
) -> dict[str, Rows]:
    """Counts and scores, and the bootstrap intervals of the scores.

    A classifier predicts an event where its calibrated probability reaches the alarm threshold;
    both are of ``calibration``, which cases without classifiers do not have. A permanent alarm is
    a row like a forecaster: with a base rate of one half it has an F-score of two thirds.
    """
    truth = WindowSummaries(evaluation_set["first"], evaluation_set["largest"])
    seen, series = evaluation_set["washout_maximum"], evaluation_set["series"]
    windows = round(window_lt / resolution_lt)
    found = [(one.name, forecasts_from(one.content)) for one in forecasts]
    always = WindowSummaries.always_crossing(truth.first.shape)
    rows, ends = [], []
    for name, forecast in [*found, (ForecasterName(PERMANENT_ALARM), always)]:
        for prediction_time in prediction_times_lt:
            first = round(prediction_time / resolution_lt) - 1
            if isinstance(forecast, EventProbabilities):
                assert calibration is not None
                rule = rules_of(calibration, name.identifier, prediction_time)[CALIBRATED]
                alarms = rule.alarms(forecast.at(prediction_time, event_threshold))
                happened = crosses(truth, first, windows, event_threshold)
                counts = count_by_series(alarms, happened, seen < event_threshold, series)
            else:
                counts = score_forecasts(
                    forecast,
                    truth,
                    seen,
                    series,
                    first_window=first,
                    windows=windows,
                    threshold=event_threshold,
                )
            whole = total(counts)
            row = {**name.keys, "prediction_time_lt": prediction_time}
            rows.append(
                {
                    **row,
                    **{outcome: int(count) for outcome, count in vars(whole).items()},
                    **{score: float(getattr(whole, score)) for score in SCORES},
                }
            )
            generator = random_streams.stream(root_seed, "bootstrap", case, str(prediction_time))
            intervals = bootstrap_interval(counts, resamples, confidence, generator)
            ends += [
                {**row, "metric": metric, "low": low, "high": high}
                for metric, (low, high) in intervals.items()
            ]
    return {"classification": rows, "classification_intervals": ends}
