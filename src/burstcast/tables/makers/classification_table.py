"""Score the forecasts of all forecasters at every prediction time."""

from collections.abc import Mapping, Sequence
from typing import Any

from burstcast import random_streams
from burstcast.forecast.classification import SCORES, bootstrap_interval, score_forecasts, total
from burstcast.forecast.windows import WindowSummaries
from burstcast.forecasters._names import PERMANENT_ALARM, ForecasterName
from burstcast.tables.makers.registry import Declaration, Gathered, Rows

TABLES = Declaration(
    inputs={"evaluation_set": "series washout_maximum first largest"},
    gathered={"forecasts": "first largest"},
    settings={
        "case": "case",
        "root_seed": "random_seed",
        "event_threshold": "case.event_threshold",
        "prediction_times_lt": "classification.prediction_times_lt",
        "window_lt": "classification.window_lt",
        "resolution_lt": "classification.resolution_lt",
        "resamples": "bootstrap.resamples",
        "confidence": "bootstrap.confidence",
    },
)


def make(
    *,
    forecasts: Sequence[Gathered],
    evaluation_set: Mapping[str, Any],
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

    A permanent alarm is a row like those of forecasters: with a base rate of one half it has an
    F-score of two thirds.
    """
    truth = WindowSummaries(evaluation_set["first"], evaluation_set["largest"])
    found = [
        (one.name, WindowSummaries(one.content["first"], one.content["largest"]))
        for one in forecasts
    ]
    always = WindowSummaries.always_crossing(truth.first.shape)
    rows, ends = [], []
    for name, forecast in [*found, (ForecasterName(PERMANENT_ALARM), always)]:
        for prediction_time in prediction_times_lt:
            counts = score_forecasts(
                forecast,
                truth,
                evaluation_set["washout_maximum"],
                evaluation_set["series"],
                first_window=round(prediction_time / resolution_lt) - 1,
                windows=round(window_lt / resolution_lt),
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
