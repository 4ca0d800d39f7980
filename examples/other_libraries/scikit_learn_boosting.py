"""Gradient-boosted trees of scikit-learn as a classifier of a campaign.

A classifier for each prediction window: from what is observed now, and was a while ago, to the
probability of an event. It forecasts no trajectories.
"""

from dataclasses import dataclass

import numpy as np
from sklearn.ensemble import HistGradientBoostingClassifier

from burstcast.forecasters._event_classifier import EventClassifier
from burstcast.forecasters.base import ForecasterRecord, fitted


@dataclass(frozen=True)
class Boosting(EventClassifier):
    """Probabilities by boosted trees, which are fitted again when a file is read."""

    lags: tuple[float, ...] = (0, 5, 10, 20)  #: samples before the starting point
    trees: int = 150
    learning_rate: float = 0.08
    leaves: int = 12

    features: np.ndarray = fitted()
    happened: np.ndarray = fitted()
    classifiers: list = fitted()

    def fit(self, points, case):
        """Fit a classifier for each window."""
        return self._of(self._features(points.washouts), points.happened.astype(float))

    def probabilities(self, washouts, exogenous=None):
        """Probability of an event in each window, ``(points, windows)``."""
        features = self._features(washouts)
        return np.stack(
            [classifier.predict_proba(features)[:, 1] for classifier in self.classifiers], axis=1
        )

    def record(self):
        """The training data."""
        return ForecasterRecord({"features": self.features, "happened": self.happened})

    def restore(self, record, case):
        """Fit the classifiers again."""
        return self._of(record.arrays["features"], record.arrays["happened"])

    def _of(self, features, happened):
        classifiers = [
            HistGradientBoostingClassifier(
                max_iter=self.trees,
                learning_rate=self.learning_rate,
                max_leaf_nodes=self.leaves,
                early_stopping=False,
                random_state=0,
            ).fit(features, of_window > 0.5)
            for of_window in happened.T
        ]
        return self.with_fitted(features=features, happened=happened, classifiers=classifiers)

    def _features(self, washouts):
        reached = [int(lag) for lag in self.lags if lag < washouts.shape[1]]
        return np.concatenate([washouts[:, -1 - lag] for lag in reached], axis=1)
