"""Score the forecasts of all forecasters at every prediction time."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from burstcast.base import random_streams
from burstcast.base.declared import at, declaring, gathered, read
from burstcast.base.names import PERMANENT_ALARM, ForecasterName
from burstcast.base.resampling import bootstrap_weights
from burstcast.forecasts.alarms import CALIBRATED, rules_of
from burstcast.forecasts.forecast_files import forecasts_from
from burstcast.forecasts.probabilities import EventProbabilities
from burstcast.forecasts.scores import SCORES, counts_at, outcomes_by_series
from burstcast.forecasts.windows import WindowForecasts, WindowSummaries, crosses, is_valid
from burstcast.tables.cells import between
from burstcast.tables.makers.registry import Gathered, Rows


@declaring
def make(
    *,
    forecasts: Sequence[Gathered] = gathered("forecasters/forecast.nc"),
    evaluation_set: Mapping[str, Any] = read(
        "case/evaluation_set.nc", "series washout_maximum first largest"
    ),
    calibration: Mapping[str, Any] | None = read("classified_case/calibration.json"),
    case: str = at("case"),
    root_seed: int = at("random_seed"),
    event_threshold: float = read("case/event_threshold.json:event_threshold"),
    prediction_times_lt: Sequence[float] = at("classification.prediction_times_lt"),
    window_lt: float = at("classification.window_lt"),
    resolution_lt: float = at("classification.resolution_lt"),
    resamples: int = at("bootstrap.resamples"),
    confidence: float = at("bootstrap.confidence"),
) -> dict[str, Rows]:
    """Counts and scores, and the bootstrap intervals of the scores.

    A classifier predicts an event where its calibrated probability reaches the alarm threshold;
    both are of ``calibration``, which cases without classifiers do not have. A permanent alarm is
    a row like a forecaster: with a base rate of one half it has an F-score of two thirds. Invalid
    forecasts predict no event; neither it nor a classifier has any.
    """
    truth = WindowSummaries(evaluation_set["first"], evaluation_set["largest"])
    # an event that is under way at the starting point needs no forecast
    scored = evaluation_set["washout_maximum"] < event_threshold
    series, windows = evaluation_set["series"], round(window_lt / resolution_lt)
    number_of_series = int(series.max(initial=-1)) + 1
    named_forecasts = [(file.name, forecasts_from(file.content)) for file in forecasts]
    always = WindowSummaries.always_crossing(truth.first.shape)
    rows, ends = [], []
    for name, forecast in [*named_forecasts, (ForecasterName(PERMANENT_ALARM), always)]:
        for prediction_time in prediction_times_lt:
            window = round(prediction_time / resolution_lt) - 1, windows, event_threshold
            invalid = float("nan")
            if isinstance(forecast, EventProbabilities):
                assert calibration is not None
                rule = rules_of(calibration, name.identifier, prediction_time)[CALIBRATED]
                alarms = rule.alarms(forecast.at(prediction_time, event_threshold))
            else:
                alarms = crosses(forecast, *window)
                if isinstance(forecast, WindowForecasts) and scored.any():
                    invalid = float((~is_valid(forecast, *window[:2]))[scored].mean())
            happened = crosses(truth, *window)
            outcomes = outcomes_by_series(
                alarms.astype(np.float64), happened, scored, series, number_of_series
            )
            whole = counts_at(outcomes.total(), 1.0)
            row = {**name.keys, "prediction_time_lt": prediction_time}
            rows.append(
                {
                    **row,
                    **{outcome: int(count) for outcome, count in vars(whole).items()},
                    **{score: float(getattr(whole, score)) for score in SCORES},
                    "invalid_fraction": invalid,
                }
            )
            generator = random_streams.stream(root_seed, "bootstrap", case, str(prediction_time))
            weights = bootstrap_weights(number_of_series, resamples, generator)
            samples = counts_at(outcomes.resampled(weights), 1.0)
            ends += [
                {**row, "metric": score, **between(getattr(samples, score), confidence)}
                for score in SCORES
            ]
    return {"classification": rows, "classification_intervals": ends}
