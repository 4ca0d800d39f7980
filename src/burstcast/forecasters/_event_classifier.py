"""The interface of a classifier: probabilities of events from what is observed, no trajectory.

A classifier learns from starting points in the training series whether an event follows in each
prediction window. Its event is the one that it was trained with: one event threshold, one set of
windows.
"""

import abc
from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np

from burstcast.base.arrays import BoolArray, FloatArray, IntArray
from burstcast.forecasters._options import ClassifierOptions
from burstcast.forecasters.base import ForecasterKind, ForecastingCase


@dataclass(frozen=True)
class LabelledPoints:
    """Starting points in training series, and whether an event followed in each window."""

    washouts: FloatArray  #: observed states up to each point, ``(points, steps, dimension)``
    #: whether an event followed in each prediction window, ``(points, windows)``
    happened: BoolArray
    series: IntArray  #: row of each point's series, ``(points,)``
    #: further features, of what is known in advance, ``(points, features)`` (`known_features`);
    #: None: there are none
    exogenous: FloatArray | None = None

    def of(self, rows: BoolArray, windows: BoolArray) -> Self:
        """Some of the points, and the labels of some of the windows."""
        exogenous = None if self.exogenous is None else self.exogenous[rows]
        happened = self.happened[rows][:, windows]
        return type(self)(self.washouts[rows], happened, self.series[rows], exogenous)

    def check(self, prediction_times_lt: Sequence[float]) -> None:
        """Check that each window has points with an event after them, and points without one.

        ``prediction_times_lt``: Lyapunov times from a point to each window, for messages.
        """
        count = len(self.happened)
        for time, events in zip(prediction_times_lt, self.happened.sum(axis=0), strict=True):
            if events in (0, count):
                raise ValueError(
                    f"an event follows {events} of the {count} training points without an event "
                    f"under way, in the window that begins {time:g} Lyapunov times later: a "
                    "classifier needs both kinds of points; change event_threshold, or give more "
                    "or longer training series (in a campaign: training.series)"
                )


@dataclass(frozen=True)
class EventClassifier(ClassifierOptions, ForecasterKind, abc.ABC):
    """Probabilities of an event in each prediction window, straight from a washout."""

    has_trajectories: ClassVar[bool] = False

    @abc.abstractmethod
    def fit(self, points: LabelledPoints, case: ForecastingCase) -> Self:
        """Return a classifier that has learnt from labelled starting points.

        ``points``: Points of the training series; each window has points with an event and points
        without one. ``case``: What may be known beside them.
        """

    @abc.abstractmethod
    def probabilities(
        self, washouts: FloatArray, exogenous: FloatArray | None = None
    ) -> FloatArray:
        """Probability of an event in each window: ``(points, windows)``.

        ``exogenous``: Further features, as of the `LabelledPoints` of the training.
        """


def known_features(
    schedules: FloatArray, now: int, windows: Sequence[tuple[int, int]]
) -> FloatArray:
    """Features of what is known in advance: values now, and means over prediction windows.

    ``schedules``: Values in force over washouts and what follows, ``(points, steps, parameters)``.
    ``now``: Entry that is in force up to the starting point; -1 if there is none. ``windows``:
    Steps after the starting point at which each window begins and ends. Shape ``(points, (1 +
    windows) * parameters)``; without an entry for now, the means alone.

    Examples
    --------
    >>> known_features(np.arange(6.0).reshape(1, 6, 1), 1, [(1, 2), (2, 4)])
    array([[1. , 2.5, 4. ]])
    """
    features = [schedules[:, now + first : now + last + 1].mean(axis=1) for first, last in windows]
    if now >= 0:
        features.insert(0, schedules[:, now])
    return np.concatenate(features, axis=1)


def with_exogenous(features: FloatArray, exogenous: FloatArray | None) -> FloatArray:
    """Features of points ``(points, features)`` with features of exogenous inputs."""
    return features if exogenous is None else np.concatenate([features, exogenous], axis=1)
