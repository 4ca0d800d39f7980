"""Honest probabilities of classifiers in the training series, with which they are calibrated."""

import numpy as np

from burstcast.base.arrays import FloatArray, IntArray
from burstcast.forecasters._event_classifier import EventClassifier, LabelledPoints
from burstcast.forecasters.base import ForecastingCase


def out_of_sample_probabilities(
    classifier: EventClassifier,
    points: LabelledPoints,
    case: ForecastingCase,
    washouts: FloatArray,
    series: IntArray,
    exogenous: FloatArray | None = None,
) -> FloatArray:
    """Probabilities ``(points, windows)`` by classifiers that have not learnt from the series.

    The training series are dealt out to ``classifier.folds`` folds, or as many as there are series.
    Where no event, or nothing but events, follow the points of the other folds in a window, the
    probability is 0, or 1. ``points``, ``case``: See `EventClassifier.fit`. ``series``: Training
    series of each washout. ``exogenous``: Further features of each, as of ``points``.
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
        others = ~np.isin(points.series, rows[fold::count])
        share = points.happened[others].sum(axis=0) / max(1, others.sum())
        probabilities[here] = share
        both = (share > 0) & (share < 1)
        if here.any() and both.any():
            fitted = classifier.fit(points.of(others, both), case)
            further = None if exogenous is None else exogenous[here]
            probabilities[np.ix_(here, both)] = fitted.probabilities(washouts[here], further)
    return probabilities
