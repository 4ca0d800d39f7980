"""Ranking of starting points: by onsets, and by any time above the threshold."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from burstcast.base.arrays import FloatArray
from burstcast.base.declared import at, declaring, made_by, read
from burstcast.base.resampled_score import ResampledScore
from burstcast.forecasts.points import AlarmSource
from burstcast.forecasts.scores import EVENTS, PRECURSOR, Window, ranking_scores
from burstcast.forecasts.windows import WindowForecasts, WindowSummaries
from burstcast.systems.base import DynamicalSystem, has_own
from burstcast.systems.registry import make_space
from burstcast.tables.cells import with_interval
from burstcast.tables.makers._probabilities import CaseProbabilities, case_probabilities
from burstcast.tables.makers.registry import Rows


@declaring
def make(
    *,
    case: CaseProbabilities = made_by(case_probabilities),
    washouts: FloatArray = read("case/evaluation_set.nc:washout"),
    system: str = at("case.system"),
    parameters: Mapping[str, Any] = at("case.parameters"),
) -> dict[str, Rows]:
    """Areas below both curves, with intervals over the test series."""
    points, threshold = case.points, case.event_threshold
    truth = WindowSummaries(points.data["first"], points.data["largest"])
    here = points.scored(threshold)
    space = make_space(system, parameters)
    theory: FloatArray | None = None
    if isinstance(space, DynamicalSystem) and has_own(space, "precursor"):
        theory = space.precursor(washouts[:, -1].T)
    rows: Rows = []
    for time in case.times:
        weights = case.weights(time)[:, points.data["series"]][:, here]
        everything = np.vstack([np.ones(here.sum(), dtype=np.int64), weights])
        window = Window(*points.windows(time), threshold)
        for event in EVENTS:
            happened = window.happened(truth, event)[here]
            base = ResampledScore(happened.mean(), (weights @ happened) / weights.sum(axis=1))
            keys = {"prediction_time_lt": time, "event": event}
            strengths = [
                (case.keys(alarm), _strength(case, time, window, event, alarm))
                for alarm in case.alarms
            ]
            if theory is not None:
                strengths.append(({"forecaster": PRECURSOR, "alarm": PRECURSOR}, theory))
            for names, strength in strengths:
                resampled = ranking_scores(strength[here], happened, everything)
                scores = {
                    name: ResampledScore(values[0], values[1:])
                    for name, values in resampled.items()
                }
                rows += [
                    {**names, **keys, "metric": metric, **with_interval(score, case.confidence)}
                    for metric, score in {"base_rate": base, **scores}.items()
                ]
    return {"ranking": rows}


def _strength(
    case: CaseProbabilities, time: float, window: Window, event: str, alarm: AlarmSource
) -> FloatArray:
    forecasts = [case.points.forecasts[name] for name in alarm.forecasters]
    trajectories = [forecast for forecast in forecasts if isinstance(forecast, WindowForecasts)]
    if not trajectories:  # a baseline, or the probabilities of a classifier
        return case.points.values(alarm, time, window.threshold)
    strengths = [window.strength(forecast, event) for forecast in trajectories]
    return np.asarray(np.mean(strengths, axis=0))
