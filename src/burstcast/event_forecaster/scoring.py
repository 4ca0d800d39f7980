"""Scores of an event forecaster for scikit-learn's model selection, where series are samples."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from burstcast.base.arrays import BoolArray, FloatArray
from burstcast.event_forecaster.estimator import Estimator
from burstcast.event_forecaster.forecaster import EventForecaster


@dataclass(frozen=True)
class EventScorer:
    """Score of the probabilities at all starting points in series, for an argument ``scoring``.

    ``EventScorer("neg_brier_score")`` is what ``"neg_brier_score"`` is elsewhere: an event
    forecaster finds its targets in the series, which scikit-learn's own scorers want beside them.
    """

    #: a name of `EventForecaster.scores` ("brier_skill"), a name or a scorer of scikit-learn
    #: ("neg_log_loss", ``make_scorer(...)``), or a function of outcomes and probabilities
    scoring: str | Callable[..., float]
    prediction_time: float | None = None  #: None: the first

    def __call__(self, forecaster: EventForecaster, series: Any, y: Any = None) -> float:
        """Score a fitted forecaster in test series, ``(series, time, component)``."""
        scoring, time = self.scoring, self.prediction_time
        if time is None:
            time = next(iter(forecaster.alarms_))
        if isinstance(scoring, str):
            if scoring in (scores := forecaster.scores(series, time)):
                return scores[scoring]
            from sklearn.metrics import get_scorer

            scoring = get_scorer(scoring)
        happened, probability = forecaster.outcomes(series, time)[:2]
        if not hasattr(scoring, "_score_func"):
            return float(scoring(happened, probability))
        threshold = forecaster.rule(time).threshold
        return float(scoring(_Answers(threshold), probability, happened))


@dataclass(frozen=True, repr=False)
class _Answers(Estimator):
    """A classifier whose samples are the probabilities themselves."""

    threshold: float

    @property
    def classes_(self) -> BoolArray:
        return np.array([False, True])

    def predict_proba(self, probability: FloatArray) -> FloatArray:
        return np.stack([1 - probability, probability], axis=1)

    def predict(self, probability: FloatArray) -> BoolArray:
        return np.asarray(probability >= self.threshold)
