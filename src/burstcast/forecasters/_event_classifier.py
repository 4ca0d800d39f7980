"""The interface of a classifier: probabilities of events from what is observed, no trajectory.

A classifier learns from starting points in the training series whether an event follows in each
prediction window. Its event is the one that it was trained with: one event threshold, one set of
windows.
"""

import abc
from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar, Self

from burstcast.arrays import BoolArray, FloatArray, IntArray
from burstcast.forecasters.base import ForecasterKind, ForecastingCase


@dataclass(frozen=True)
class LabelledPoints:
    """Starting points in training series, and whether an event followed in each window.

    Attributes
    ----------
    washouts
        Observed states up to each point, ``(points, steps, dimension)``.
    happened
        Whether an event followed in each prediction window, ``(points, windows)``.
    series
        Row of each point's series, ``(points,)``.
    """

    washouts: FloatArray
    happened: BoolArray
    series: IntArray

    def of(self, rows: BoolArray, windows: BoolArray) -> Self:
        """Some of the points, and the labels of some of the windows."""
        return type(self)(self.washouts[rows], self.happened[rows][:, windows], self.series[rows])

    def check(self, prediction_times_lt: Sequence[float]) -> None:
        """Check that each window has points with an event after them, and points without one.

        Parameters
        ----------
        prediction_times_lt
            Lyapunov times from a point to each window, for messages.

        Raises
        ------
        ValueError
            If a window has an event after all points, or after none.
        """
        count = len(self.happened)
        for time, events in zip(prediction_times_lt, self.happened.sum(axis=0), strict=True):
            if events in (0, count):
                raise ValueError(
                    f"an event follows {events} of the {count} training points without an event "
                    f"under way, in the window that begins {time:g} Lyapunov times later: a "
                    "classifier needs both kinds of points; change event_threshold, or raise "
                    "training.series or the length of the series"
                )


class EventClassifier(ForecasterKind):
    """Probabilities of an event in each prediction window, straight from a washout."""

    has_trajectories: ClassVar[bool] = False

    @classmethod
    @abc.abstractmethod
    def fit(cls, points: LabelledPoints, case: ForecastingCase) -> Self:
        """Learn from labelled starting points.

        Parameters
        ----------
        points
            Points of the training series; each window has points with an event and points without
            one.
        case
            What may be known beside them. Kinds with random numbers find the root of all streams
            as the option ``random_seed``.
        """

    def tuned(self, case: ForecastingCase) -> ForecastingCase:
        """Case in which `fit` takes this classifier's hyperparameters instead of choosing some.

        Probabilities are calibrated with classifiers of the same hyperparameters, which have learnt
        from fewer series.
        """
        return case

    @abc.abstractmethod
    def probabilities(self, washouts: FloatArray) -> FloatArray:
        """Probability of an event in each window: ``(points, windows)``.

        Parameters
        ----------
        washouts
            Observed states up to each starting point, ``(points, steps, dimension)``.
        """
