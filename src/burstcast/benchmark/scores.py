"""Scores of forecasts of a case, with intervals, by the functions that the workflow uses."""

import csv
import dataclasses
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from burstcast import random_streams
from burstcast.arrays import FloatArray
from burstcast.benchmark.cases import BenchmarkCase
from burstcast.benchmark.data import CaseData
from burstcast.benchmark.forecast_files import Forecasts
from burstcast.data.starting_points import crossing_points
from burstcast.files.atomic_files import atomic
from burstcast.forecast.classification import bootstrap_interval
from burstcast.forecast.horizon_intervals import resampled_averages
from burstcast.forecast.windows import crosses
from burstcast.forecasters._recorded import recorded_horizons
from burstcast.probability.alarms import counts_at
from burstcast.probability.intervals import ratio_with_interval
from burstcast.probability.lead_times import lead_time_scores, lead_times
from burstcast.probability.outcomes import outcomes_by_series
from burstcast.probability.scores import resampled_scores
from burstcast.probability.votes import share_of_votes
from burstcast.statistics.resampling import bootstrap_weights, percentile_interval

BINS = 11
"""Equally wide bins of the probability, of the calibration error among others."""
RESAMPLES, CONFIDENCE = 1000, 0.95

_BY_TIME = ("precision", "recall", "f_score", "brier_skill", "calibration_error")
_OF_ALL = ("mean_lead_time_lt", "missed_fraction", "mean_horizon_lt", "median_horizon_lt")


@dataclass(frozen=True)
class Score:
    """A score with its bootstrap interval; NaN where it is not defined."""

    metric: str  #: its name, as in the tables of a campaign
    #: prediction time in Lyapunov times; None for a score of all prediction times together
    prediction_time_lt: float | None
    #: value, low, high: the score, and both ends of the interval
    value: float
    low: float
    high: float


def probabilities(case: BenchmarkCase, forecasts: Forecasts) -> FloatArray:
    """Probability of an event in each window: given, or the share of the members that have one.

    Shape ``(points, prediction times)``.
    """
    if forecasts.probability is not None:
        return forecasts.probability
    return np.stack(
        [
            share_of_votes(forecasts.members, *case.windows(time), case.event_threshold)
            for time in case.prediction_times_lt
        ],
        axis=1,
    )


def score_forecasts(
    data: CaseData, forecasts: Forecasts, alarm_threshold: float = 0.5, resamples: int = RESAMPLES
) -> list[Score]:
    """All scores of forecasts."""
    return [
        *_window_scores(data, forecasts, alarm_threshold, resamples),
        *_horizon_scores(data, forecasts, resamples),
    ]


def _window_scores(
    data: CaseData, forecasts: Forecasts, alarm_threshold: float, resamples: int
) -> list[Score]:
    """Scores of the windows at each prediction time, then of the lead times of alarms."""
    case, points, series = data.case, data.test.points, len(data.observable)
    threshold = case.event_threshold
    in_scored = data.test.seen.max(axis=1) < threshold
    found: list[Score] = []
    probability = probabilities(case, forecasts)
    for time, forecast in zip(case.prediction_times_lt, probability.T, strict=True):
        happened = crosses(data.test.truth, *case.windows(time), threshold)
        outcomes = outcomes_by_series(forecast, happened, in_scored, points.series, series)
        # each with the resamples that the tables of a campaign have
        streams = [
            random_streams.stream(data.seed, "bootstrap", case.name, name)
            for name in (f"{time:g}", str(float(time)))
        ]
        counts = counts_at(outcomes, alarm_threshold)
        ends = bootstrap_interval(counts, resamples, CONFIDENCE, streams[0])
        weights = bootstrap_weights(series, resamples, streams[1])
        for metric, score in resampled_scores(outcomes, weights, alarm_threshold, BINS).items():
            interval = ends.get(metric) or percentile_interval(score.samples, CONFIDENCE)
            found.append(Score(metric, time, float(score.value), *interval))
    leads = lead_times(
        probability >= alarm_threshold,
        case.window_steps,
        points,
        in_scored,
        crossing_points(data.observable, threshold),
    )
    generator = random_streams.stream(data.seed, "bootstrap", case.name, str(0.0))
    weights = bootstrap_weights(series, resamples, generator)
    scores = lead_time_scores(leads, series, case.prediction_times_lt, case.steps_per_lyapunov_time)
    for one in scores:
        values = ratio_with_interval(one.numerator, one.denominator, weights, CONFIDENCE)
        found.append(Score(one.metric, one.lead_time_lt, *values))
    return found


def _horizon_scores(data: CaseData, forecasts: Forecasts, resamples: int) -> Sequence[Score]:
    """Mean and median prediction horizon of the events; none where they were not forecast."""
    if forecasts.horizon is None:
        return []
    horizons = recorded_horizons(
        data.before_horizon(data.before_events),
        forecasts.horizon,
        data.before_events,
        data.truth_before_events,
        data.search,
    )
    generator = random_streams.stream(data.seed, "bootstrap", data.case.name, "events")
    weights = bootstrap_weights(len(horizons), resamples, generator)
    means, medians = resampled_averages(horizons, weights)
    return [
        Score(metric, None, float(average), *percentile_interval(samples, CONFIDENCE))
        for metric, average, samples in (
            ("mean_horizon_lt", horizons.mean(), means),
            ("median_horizon_lt", np.median(horizons), medians),
        )
    ]


def write_scores(path: str | Path, scores: Sequence[Score]) -> None:
    """Write all scores with their intervals to a CSV file."""
    columns = [field.name for field in dataclasses.fields(Score)]
    with atomic(path) as partial, open(partial, "w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerows([columns, *map(dataclasses.astuple, scores)])


def scores_text(scores: Sequence[Score]) -> str:
    """Main scores as text: by prediction time, then of all prediction times together."""
    times = list(dict.fromkeys(one.prediction_time_lt for one in scores if one.metric == "f_score"))
    shown = {
        (one.metric, one.prediction_time_lt): f"{one.value:.3f} ({one.low:.3f} to {one.high:.3f})"
        for one in scores
    }
    lines = [["", *(f"{time:g} LT" for time in times)]]
    lines += [[metric, *(shown[metric, time] for time in times)] for metric in _BY_TIME]
    lines += [[metric, shown[metric, None]] for metric in _OF_ALL if (metric, None) in shown]
    return "\n".join(
        f"{line[0]:20}{''.join(cell.rjust(26) for cell in line[1:])}" for line in lines
    )
