"""A learnt precursor: a classifier of the present state and some of the past.

The classifiers come from `burstcast.probability.precursor`.
"""

from collections.abc import Sequence
from dataclasses import dataclass, fields
from typing import Self

from burstcast import durations
from burstcast.arrays import FloatArray
from burstcast.forecasters._event_classifier import (
    EventClassifier,
    LabelledPoints,
    with_known,
)
from burstcast.forecasters.base import ForecasterRecord, ForecastingCase
from burstcast.probability.precursor import Precursor, PrecursorOptions, precursor_features


@dataclass(frozen=True)
class LearntPrecursor(EventClassifier):
    """Probabilities by a classifier for each prediction window.

    Examples
    --------
    >>> import numpy as np
    >>> from burstcast.forecasters._options import options_of_kind
    >>> from burstcast.forecasters.registry import classifier_class
    >>> from burstcast.systems.lorenz63 import Lorenz63
    >>> generator = np.random.default_rng(0)
    >>> washouts = generator.normal(size=(2000, 9, 3))   # points, steps, components
    >>> happened = washouts[:, -1, :1] > 1.0             # points, windows
    >>> points = LabelledPoints(washouts, happened, series=np.arange(2000) // 500)
    >>> options = options_of_kind("precursor") | {"classifier": "logistic"}
    >>> case = ForecastingCase(Lorenz63(), 0.01, 1, 20, options)
    >>> fitted = classifier_class("precursor").fit(points, case)
    >>> found = fitted.probabilities(generator.normal(size=(5, 9, 3)))
    >>> found.shape
    (5, 1)
    """

    precursor: Precursor  #: the classifiers, fitted

    @classmethod
    def fit(cls, points: LabelledPoints, case: ForecastingCase) -> Self:
        """Fit the classifiers to the present and the lags of each point."""
        options = precursor_options(case)
        features = with_known(precursor_features(points.washouts, options.lags), points.known)
        return cls(Precursor.fit(features, points.happened, options))

    def probabilities(self, washouts: FloatArray, known: FloatArray | None = None) -> FloatArray:
        """Probability of an event in each window (see `EventClassifier.probabilities`)."""
        features = precursor_features(washouts, self.precursor.options.lags)
        return self.precursor.probabilities(with_known(features, known))

    def record(self) -> ForecasterRecord:
        """Training data of the classifiers, which are fitted again."""
        return ForecasterRecord(self.precursor.record())

    @classmethod
    def restore(cls, record: ForecasterRecord, case: ForecastingCase) -> Self:
        """Fit the classifiers again, to the same bits."""
        return cls(Precursor.restore(record.arrays, precursor_options(case)))


def precursor_options(case: ForecastingCase) -> PrecursorOptions:
    """Options of a case, with its lags in steps."""
    lags = lag_steps(case.options["lags_lt"], case.steps_per_lyapunov_time)
    names = {field.name for field in fields(PrecursorOptions)} - {"lags"}
    return PrecursorOptions(lags=lags, **{name: case.options[name] for name in names})


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
