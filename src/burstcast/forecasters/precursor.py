"""A learnt precursor: a classifier of the present state and some of the past.

The classifiers come from `burstcast.forecasters._precursor_model`.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Self

from burstcast.base import durations
from burstcast.base.arrays import FloatArray
from burstcast.forecasters._event_classifier import (
    EventClassifier,
    LabelledPoints,
    with_exogenous,
)
from burstcast.forecasters._options import PrecursorOptions
from burstcast.forecasters._precursor_model import Precursor, PrecursorTraining, precursor_features
from burstcast.forecasters.base import ForecasterRecord, ForecastingCase, fitted


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

    precursor: Precursor = fitted()  #: the classifiers

    def fit(self, points: LabelledPoints, case: ForecastingCase) -> Self:
        """Fit the classifiers to the present and the lags of each point."""
        training = self._training(case)
        features = with_exogenous(
            precursor_features(points.washouts, training.lags), points.exogenous
        )
        return self.with_fitted(precursor=Precursor.fit(features, points.happened, training))

    def probabilities(
        self, washouts: FloatArray, exogenous: FloatArray | None = None
    ) -> FloatArray:
        """Probability of an event in each window (see `EventClassifier.probabilities`)."""
        features = precursor_features(washouts, self.precursor.options.lags)
        return self.precursor.probabilities(with_exogenous(features, exogenous))

    def record(self) -> ForecasterRecord:
        """Training data of the classifiers, which are fitted again."""
        return ForecasterRecord(self.precursor.record())

    def restore(self, record: ForecasterRecord, case: ForecastingCase) -> Self:
        """Fit the classifiers again, to the same bits."""
        return self.with_fitted(precursor=Precursor.restore(record.arrays, self._training(case)))

    def _training(self, case: ForecastingCase) -> PrecursorTraining:
        """Options of the training, with lags in steps."""
        lags = lag_steps(self.lags_lt, case.steps_per_lyapunov_time)
        return PrecursorTraining(self.classifier, lags)


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
