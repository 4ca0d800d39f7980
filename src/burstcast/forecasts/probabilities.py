"""Probabilities of events from classifiers, and out-of-sample forecasts of training series.

Each training series is forecast by a forecaster that was fitted without it.
"""

import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from burstcast.base.arrays import BoolArray, FloatArray, IntArray
from burstcast.base.files.described import Described
from burstcast.base.files.units import LYAPUNOV_TIMES, NUMBER, OBSERVABLE
from burstcast.base.left_out import LeftOut
from burstcast.forecasters._event_classifier import EventClassifier, LabelledPoints
from burstcast.forecasters.base import Forecaster, ForecastingCase
from burstcast.forecasts.windows import WindowForecasts, joined, window_forecasts


@dataclass(frozen=True)
class EventProbabilities:
    """Probabilities of one event at many starting points, by prediction time."""

    probability: Annotated[
        FloatArray,
        Described(
            "point prediction_time",
            NUMBER,
            "probability of an event in the window at each prediction time, not calibrated",
        ),
    ]
    prediction_time_lt: Annotated[
        FloatArray,
        Described("prediction_time", LYAPUNOV_TIMES, "time from the starting point to the window"),
    ]
    #: a single number
    event_threshold: Annotated[
        FloatArray, Described("threshold", OBSERVABLE, "observable that the event reaches")
    ]

    def at(self, prediction_time_lt: float, event_threshold: float) -> FloatArray:
        """Probabilities at one prediction time, ``(points,)``."""
        (columns,) = np.nonzero(self.prediction_time_lt == prediction_time_lt)
        threshold = self.event_threshold.item()
        if event_threshold != threshold or not columns.size:
            raise ValueError(
                f"probabilities are of events beyond {threshold:g} and prediction times "
                f"{self.prediction_time_lt.tolist()}, not of {event_threshold:g} and "
                f"{prediction_time_lt:g}"
            )
        return np.asarray(self.probability[:, columns[0]])


def out_of_sample_forecasts(
    forecaster: Forecaster,
    training: FloatArray,
    case: ForecastingCase,
    washout: int,
    observable: Callable[[FloatArray], FloatArray],
    washouts: FloatArray,
    series: IntArray,
    boundaries: tuple[int, ...],
    left_out: Sequence[LeftOut] | None = None,
) -> WindowForecasts:
    """Forecast from starting points in the training series, refitted without the point's series.

    ``training``, ``case``, ``washout``: Arguments of `Forecaster.leave_one_out`. ``washouts``,
    ``series``: Washout of each point, ``(points, steps, dimension)``, and row of its training
    series, ``(points,)``. ``left_out``: Series that are left out together, and those of them that
    have points; None: each by itself.
    """
    rows, parts = [], []
    for here, refitted in refitted_without(forecaster, training, case, washout, series, left_out):
        rows.append(here)
        parts.append(window_forecasts(refitted, observable, washouts[here], boundaries))
    order = np.argsort(np.concatenate(rows))
    forecasts = joined(parts)
    return WindowForecasts(**{name: values[order] for name, values in vars(forecasts).items()})


def refitted_without(
    forecaster: Forecaster,
    training: FloatArray,
    case: ForecastingCase,
    washout: int,
    series: IntArray,
    left_out: Sequence[LeftOut] | None = None,
) -> Iterator[tuple[IntArray, Forecaster]]:
    """Points of some series, and a forecaster that has not learnt from these series.

    Series without points are left out. Arguments: as of `out_of_sample_forecasts`.
    """
    if left_out is None:  # as a class of one's own may have it
        forecast = [np.array([row]) for row in range(len(training))]
        refits = forecaster.leave_one_out(training, case, washout)
    else:
        forecast = [each.forecast for each in left_out]
        refits = forecaster.leave_one_out(training, case, washout, left_out)
    for own, refitted in zip(forecast, refits, strict=True):
        here = np.flatnonzero(np.isin(series, own))
        if here.size:
            yield here, refitted.within(forecaster.limits)


_WORTH_A_WORD = 5.0
"""Seconds of a calibration below which nothing announces it."""
_SAMPLE = 16
"""Points whose forecasts tell how long all of them take, at most."""


def announcement(
    forecaster: Forecaster,
    observable: Callable[[FloatArray], FloatArray],
    washouts: FloatArray,
    boundaries: tuple[int, ...],
) -> Iterator[str]:
    """A sentence on how long forecasts by an ensemble take, before they begin, if it is long.

    Nothing for less than five seconds of processor time, nor for single forecasts. Arguments: as of
    `window_forecasts`.
    """
    some = washouts[:: max(1, -(-len(washouts) // _SAMPLE))]
    if not forecaster.provides_ensemble or not len(some):
        return
    # the first call compiles
    members = window_forecasts(forecaster, observable, some[:1], boundaries).member_first.shape[1]
    start = time.process_time()
    window_forecasts(forecaster, observable, some, boundaries)
    seconds = (time.process_time() - start) * len(washouts) / len(some)
    if seconds >= _WORTH_A_WORD:
        yield (
            f"calibration begins: {len(washouts)} starting points, each forecast by an ensemble of "
            f"{members} members, take some {rounded(seconds)} of processor time or less"
        )


def rounded(seconds: float) -> str:
    """A duration in words, with one digit."""
    if seconds < 90:
        return f"{max(1.0, float(f'{seconds:.1g}')):g} s"
    return f"{float(f'{seconds / 60:.1g}'):g} minutes"


def out_of_sample_probabilities(
    classifier: EventClassifier,
    points: LabelledPoints,
    case: ForecastingCase,
    washouts: FloatArray,
    series: IntArray,
    exogenous: FloatArray | None = None,
    linked: BoolArray | None = None,
) -> FloatArray:
    """Probabilities ``(points, windows)`` by classifiers that have not learnt from the series.

    The training series are dealt out to ``classifier.folds`` folds, or as many as there are series.
    Where no event, or nothing but events, follow the points of the other folds in a window, the
    probability is 0, or 1. ``points``, ``case``: See `EventClassifier.fit`. ``series``: Training
    series of each washout. ``exogenous``: Further features of each, as of ``points``. ``linked``:
    Series that share samples, ``(series, series)``, which are left out together; None: none do.
    """
    rows = np.unique(np.concatenate([points.series, series]))
    count = min(classifier.folds, len(rows))
    if count < 2:
        raise ValueError(
            "probabilities of training points by classifiers that have not learnt from them take "
            f"two training series and two folds at least, not {len(rows)} and {classifier.folds}"
        )
    probabilities = np.empty((len(washouts), points.happened.shape[1]))
    for fold in range(count):
        here = np.isin(series, rows[fold::count])
        without = rows[fold::count]
        if linked is not None:
            without = np.flatnonzero(linked[without].any(axis=0))
        others = ~np.isin(points.series, without)
        share = points.happened[others].sum(axis=0) / max(1, others.sum())
        probabilities[here] = share
        both = (share > 0) & (share < 1)
        if here.any() and both.any():
            fitted = classifier.fit(points.of(others, both), case)
            further = None if exogenous is None else exogenous[here]
            probabilities[np.ix_(here, both)] = fitted.probabilities(washouts[here], further)
    return probabilities
