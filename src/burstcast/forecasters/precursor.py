"""A learnt precursor: classifiers of the present state and some of the past.

A classifier of scikit-learn learns from the training series which present states, with some of the
past, are followed by an event in each prediction window. It is the baseline of forecasts by
trajectories, and better than these where an event can be recognised but not computed ahead. Source
of the term: Farazmand and Sapsis, "A variational approach to probing extreme events in turbulent
dynamical systems", Science Advances 3 (2017) e1701533, whose precursor is one quantity from theory.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Self

import numpy as np

from burstcast.base import durations
from burstcast.base.arrays import BoolArray, FloatArray
from burstcast.base.discovery import suggestion
from burstcast.base.threads import single_threaded
from burstcast.forecasters._event_classifier import (
    EventClassifier,
    LabelledPoints,
    with_exogenous,
)
from burstcast.forecasters._options import PrecursorOptions
from burstcast.forecasters.base import ForecasterRecord, ForecastingCase, fitted

CLASSIFIERS = ("boosting", "logistic")
"""Gradient boosting of trees; logistic regression on features and their products."""

TREES, LEAVES, LEARNING_RATE = 150, 12, 0.08
"""Number of boosted trees, leaves of each, and weight of each."""

DEGREE, PENALTY = 2, 1.0
"""Of the logistic regression: degree of the products of features, and strength of the penalty on
squared coefficients of features of unit variance."""


@dataclass(frozen=True)
class LearntPrecursor(PrecursorOptions, EventClassifier):
    """Probabilities by a classifier for each prediction window.

    Examples
    --------
    >>> import numpy as np
    >>> from burstcast.forecasters.precursor import LearntPrecursor
    >>> from burstcast.systems.lorenz63 import Lorenz63
    >>> generator = np.random.default_rng(0)
    >>> washouts = generator.normal(size=(2000, 9, 3))   # points, steps, components
    >>> happened = washouts[:, -1, :1] > 1.0             # points, windows
    >>> points = LabelledPoints(washouts, happened, series=np.arange(2000) // 500)
    >>> case = ForecastingCase(Lorenz63(), time_step=0.01, sampling_stride=1,
    ...     steps_per_lyapunov_time=20)
    >>> precursor = LearntPrecursor(classifier="logistic").fit(points, case)
    >>> precursor.probabilities(generator.normal(size=(5, 9, 3))).shape
    (5, 1)
    """

    lags: tuple[int, ...] = fitted()  #: steps before the present whose components are features
    #: training data, from which classifiers are fitted again: ``(points, features)``
    features: FloatArray = fitted()
    happened: BoolArray = fitted()  #: whether an event followed, ``(points, windows)``
    classifiers: tuple[Any, ...] = fitted()  #: estimators of scikit-learn, one for each window

    def fit(self, points: LabelledPoints, case: ForecastingCase) -> Self:
        """Fit the classifiers to the present and the lags of each point."""
        lags = lag_steps(self.lags_lt, case.steps_per_lyapunov_time)
        features = with_exogenous(precursor_features(points.washouts, lags), points.exogenous)
        return self._fitted(lags, features, points.happened)

    def _fitted(self, lags: tuple[int, ...], features: FloatArray, happened: BoolArray) -> Self:
        classifiers = fitted_classifiers(self.classifier, features, happened)
        return self.with_fitted(
            lags=lags, features=features, happened=happened, classifiers=classifiers
        )

    def probabilities(
        self, washouts: FloatArray, exogenous: FloatArray | None = None
    ) -> FloatArray:
        """Probability of an event in each window (see `EventClassifier.probabilities`)."""
        features = with_exogenous(precursor_features(washouts, self.lags), exogenous)
        # threads wait for each other more than they work
        with single_threaded():
            each = [classifier.predict_proba(features)[:, 1] for classifier in self.classifiers]
        return np.stack(each, axis=1)

    def record(self) -> ForecasterRecord:
        """Training data of the classifiers, which are fitted again."""
        happened = self.happened.astype(np.float64)
        return ForecasterRecord({"features": self.features, "happened": happened})

    def restore(self, record: ForecasterRecord, case: ForecastingCase) -> Self:
        """Fit the classifiers again, to the same bits."""
        lags = lag_steps(self.lags_lt, case.steps_per_lyapunov_time)
        return self._fitted(lags, record.arrays["features"], record.arrays["happened"] > 0.5)


def lag_steps(
    lags_lt: Sequence[float], steps_per_lyapunov_time: int, washout: int | None = None
) -> tuple[int, ...]:
    """Steps of lags that are given in Lyapunov times.

    ``lags_lt``, ``steps_per_lyapunov_time``: The lags, and steps of a forecast in a Lyapunov time.
    ``washout``: Observed steps up to and including the present, in which lags must lie; None: not
    known.
    """
    name, unit = "forecasters.precursor.lags_lt", steps_per_lyapunov_time
    lags = tuple(durations.positive_steps(lag, unit, name) for lag in lags_lt)
    if len(set(lags)) < len(lags):
        raise ValueError(
            f"{name} is {lags_lt}, of which several are the same number of steps: a Lyapunov time "
            f"has {unit}"
        )
    if washout is not None and max(lags, default=0) >= washout:
        raise ValueError(
            f"{name} has {max(lags_lt):g}, a lag of {max(lags)} steps, but washout_lt holds the "
            f"present and {washout - 1} steps before it: raise washout_lt, or take shorter lags"
        )
    return lags


def precursor_features(washouts: FloatArray, lags: Sequence[int]) -> FloatArray:
    """Features of starting points: the present components, then those at each lag.

    ``washouts``: Observed states up to each starting point, ``(points, steps, component)``. Shape
    ``(points, component * (1 + lags))``.
    """
    steps = washouts.shape[1]
    if max(lags, default=0) >= steps:
        raise ValueError(f"a lag of {max(lags)} steps takes a longer washout than {steps} steps")
    return np.concatenate([washouts[:, -1 - lag] for lag in (0, *lags)], axis=1)


def fitted_classifiers(kind: str, features: FloatArray, happened: BoolArray) -> tuple[Any, ...]:
    """Fit a classifier for each window; each must have an event after some points, not after all.

    ``features``, ``happened``: ``(points, features)`` and ``(points, windows)``.
    """
    for window, share in enumerate(happened.mean(axis=0)):
        if share in (0.0, 1.0):
            followed = "none" if share == 0.0 else "each"
            raise ValueError(
                f"{followed} of the {len(happened)} training points is followed by an event in "
                f"prediction window {window}: there is only one class"
            )
    classifiers = [_classifier(kind) for _ in happened.T]
    with single_threaded():  # scikit-learn is loaded by now
        for classifier, events in zip(classifiers, happened.T, strict=True):
            classifier.fit(features, events)
    return tuple(classifiers)


def _classifier(kind: str) -> Any:
    """Estimator of scikit-learn that has not been fitted."""
    if kind not in CLASSIFIERS:
        raise ValueError(
            f"unknown classifier {kind!r}{suggestion(kind, CLASSIFIERS)}; the available ones are "
            f"{', '.join(CLASSIFIERS)}"
        )
    # imported late: it takes longer than all the rest of the library
    if kind == "boosting":
        from sklearn.ensemble import HistGradientBoostingClassifier

        return HistGradientBoostingClassifier(
            max_iter=TREES,
            max_leaf_nodes=LEAVES,
            learning_rate=LEARNING_RATE,
            early_stopping=False,
            random_state=0,
        )
    from sklearn.linear_model import LogisticRegression
    from sklearn.pipeline import make_pipeline
    from sklearn.preprocessing import PolynomialFeatures, StandardScaler

    return make_pipeline(
        StandardScaler(),
        PolynomialFeatures(DEGREE, include_bias=False),
        StandardScaler(),
        LogisticRegression(C=1.0 / PENALTY, max_iter=1000),
    )
