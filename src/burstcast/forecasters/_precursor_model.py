"""Probabilities of an event from observations, without a forecast trajectory.

A classifier of scikit-learn learns from the training series which present states, with some of the
past, are followed by an event in each prediction window. It is the baseline of forecasts by
trajectories, and better than these where an event can be recognised but not computed ahead. Source
of the term: Farazmand and Sapsis, "A variational approach to probing extreme events in turbulent
dynamical systems", Science Advances 3 (2017) e1701533, whose precursor is one quantity from theory.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Self

import numpy as np
from threadpoolctl import threadpool_limits

from burstcast.base.arrays import BoolArray, FloatArray
from burstcast.base.discovery import suggestion

CLASSIFIERS = ("boosting", "logistic")
"""Gradient boosting of trees; logistic regression on features and their products."""

TREES, LEAVES, LEARNING_RATE = 150, 12, 0.08
"""Number of boosted trees, leaves of each, and weight of each."""

DEGREE, PENALTY = 2, 1.0
"""Of the logistic regression: degree of the products of features, and strength of the penalty on
squared coefficients of features of unit variance."""


@dataclass(frozen=True)
class PrecursorTraining:
    """Options of a precursor's training."""

    classifier: str = "boosting"  #: one of `CLASSIFIERS`
    #: steps before the present whose components are features, beside the present components
    lags: Sequence[int] = ()

    def __post_init__(self) -> None:
        if self.classifier not in CLASSIFIERS:
            raise ValueError(
                f"unknown classifier {self.classifier!r}{suggestion(self.classifier, CLASSIFIERS)};"
                f" the available ones are {', '.join(CLASSIFIERS)}"
            )
        if any(lag < 1 for lag in self.lags) or len(set(self.lags)) < len(self.lags):
            raise ValueError(f"lags must be different steps from 1 on, not {list(self.lags)}")


def precursor_features(washouts: FloatArray, lags: Sequence[int] = ()) -> FloatArray:
    """Features of starting points: the present components, then those at each lag.

    ``washouts``: Observed states up to each starting point, ``(points, steps, component)``. Shape
    ``(points, component * (1 + lags))``.
    """
    steps = washouts.shape[1]
    if max(lags, default=0) >= steps:
        raise ValueError(f"a lag of {max(lags)} steps takes a longer washout than {steps} steps")
    return np.concatenate([washouts[:, -1 - lag] for lag in (0, *lags)], axis=1)


@dataclass(frozen=True)
class Precursor:
    """Classifiers of starting points, one for each prediction window.

    Attributes
    ----------
    options
        Options of the training.
    features, happened
        Training data: ``(points, features)`` and ``(points, windows)``.
    classifiers
        Fitted estimators of scikit-learn.

    Examples
    --------
    >>> generator = np.random.default_rng(0)
    >>> features = generator.normal(size=(2000, 2))
    >>> happened = features[:, :1] ** 2 > 2.0
    >>> precursor = Precursor.fit(features, happened, PrecursorTraining("logistic"))
    >>> precursor.probabilities(np.array([[0.0, 0.0], [3.0, 0.0]])).round().ravel().tolist()
    [0.0, 1.0]
    """

    options: PrecursorTraining
    features: FloatArray
    happened: BoolArray
    classifiers: tuple[Any, ...]

    @classmethod
    def fit(cls, features: FloatArray, happened: BoolArray, options: PrecursorTraining) -> Self:
        """Fit the classifiers.

        Parameters
        ----------
        features
            Features of starting points in the training series, ``(points, features)``
            (`precursor_features`).
        happened
            Whether an event followed in each window, ``(points, windows)``.
        options
            Options of the training.

        Raises
        ------
        ValueError
            If a window has an event after all points, or after none.
        """
        for window, share in enumerate(happened.mean(axis=0)):
            if share in (0.0, 1.0):
                followed = "none" if share == 0.0 else "each"
                raise ValueError(
                    f"{followed} of the {len(happened)} training points is followed by an event in "
                    f"prediction window {window}: there is only one class"
                )
        classifiers = [_classifier(options) for _ in happened.T]
        with threadpool_limits(limits=1):  # scikit-learn is loaded by now
            for classifier, events in zip(classifiers, happened.T, strict=True):
                classifier.fit(features, events)
        return cls(options, features, happened, tuple(classifiers))

    def probabilities(self, features: FloatArray) -> FloatArray:
        """Probabilities of an event in each window: ``(points, windows)``.

        Parameters
        ----------
        features
            Features of starting points, ``(points, features)``.
        """
        # threads wait for each other more than they work
        with threadpool_limits(limits=1):
            each = [classifier.predict_proba(features)[:, 1] for classifier in self.classifiers]
        return np.stack(each, axis=1)

    def record(self) -> dict[str, FloatArray]:
        """Training arrays from which `restore` fits the precursor again."""
        return {"features": self.features, "happened": self.happened.astype(np.float64)}

    @classmethod
    def restore(cls, record: Mapping[str, FloatArray], options: PrecursorTraining) -> Self:
        """Precursor from its `record`: fitted again, to the same bits."""
        return cls.fit(record["features"], record["happened"] > 0.5, options)


def _classifier(options: PrecursorTraining) -> Any:
    """Estimator of scikit-learn that has not been fitted."""
    # imported late: it takes longer than all the rest of the library
    if options.classifier == "boosting":
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
