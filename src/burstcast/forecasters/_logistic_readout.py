"""Logistic regression of several events on one set of features, with a penalty on squares."""

import numpy as np
import scipy

from burstcast.base.arrays import BoolArray, FloatArray

_STEPS, _LEAST_STEP = 100, 1e-6
_TOLERANCE = 1e-9
"""Newton decrement at which a fit has converged, per point."""
_FLAT = 1e-13
"""Rise of the loss per point that is rounding: no reason to halve a step at the minimum."""
_LEAST_CURVATURE = 1e-10
_NEGLIGIBLE = 1e-4
"""Penalties below which the sum of squares of a principal component is left out."""
_ROWS = 4096
"""Points whose products are summed at a time: bounds the memory."""


def fit_logistic(features: FloatArray, happened: BoolArray, penalty: float) -> FloatArray:
    """Weights of features for the log-odds of each event.

    They minimise the sum over points of the logarithmic loss, plus half the penalty times the
    squared weights of features of zero mean and unit variance; the bias is free. Newton's method
    finds them, in principal components where there are fewer points than features.

    ``features``: ``(points, features)``. ``happened``: Whether each event followed, ``(points,
    events)``. Shape ``(features + 1, events)``, the bias last, of features as they are.

    Examples
    --------
    >>> import numpy as np
    >>> from burstcast.forecasters._logistic_readout import event_probability, fit_logistic
    >>> features = np.random.default_rng(0).normal(size=(500, 2))
    >>> weights = fit_logistic(features, features[:, :1] > 0.5, penalty=1.0)
    >>> event_probability(weights, np.array([[0.0, 0.0], [2.0, 0.0]])).round().ravel().tolist()
    [0.0, 1.0]
    """
    mean, scale = features.mean(axis=0), features.std(axis=0)
    scale = np.where(scale > 0, scale, 1.0)
    standard, rotation = (features - mean) / scale, None
    if len(features) < features.shape[1]:
        standard, rotation = _principal_components(standard, penalty)
    standard = np.column_stack([standard, np.ones(len(features))])
    ridge = np.full(standard.shape[1], float(penalty))
    ridge[-1] = 0.0
    weights = np.stack(
        [_newton(standard, labels, ridge) for labels in happened.T.astype(np.float64)], axis=1
    )
    if rotation is not None:
        weights = np.vstack([rotation @ weights[:-1], weights[-1:]])
    weights[:-1] /= scale[:, np.newaxis]
    weights[-1] -= mean @ weights[:-1]
    return weights


def _principal_components(features: FloatArray, penalty: float) -> tuple[FloatArray, FloatArray]:
    """Principal components of fewer points than features, and the rotation back to features.

    Loss and penalty are the same in them. Components that the penalty leaves no weight are left
    out. Shapes ``(points, components)`` and ``(features, components)``.
    """
    squares, vectors = np.linalg.eigh(features @ features.T)
    # rounding leaves components of no size at all, which nothing can be divided by
    kept = squares > max(_NEGLIGIBLE * penalty, 1e-12 * squares[-1])
    size = np.sqrt(squares[kept])
    return vectors[:, kept] * size, features.T @ (vectors[:, kept] / size)


def _newton(features: FloatArray, wanted: FloatArray, ridge: FloatArray) -> FloatArray:
    """Weights at the minimum, by Newton's method with halved steps where the loss would rise."""
    share = (wanted.sum() + 0.5) / (len(wanted) + 1)
    weights = np.zeros(len(ridge))
    weights[-1] = np.log(share / (1 - share))
    odds, loss = features @ weights, np.inf
    for _ in range(_STEPS):
        probability = scipy.special.expit(odds)
        gradient = features.T @ (wanted - probability) - ridge * weights
        root = np.sqrt(probability * (1 - probability) + _LEAST_CURVATURE)
        curvature = np.diag(ridge)
        for rows in range(0, len(features), _ROWS):
            weighted = features[rows : rows + _ROWS] * root[rows : rows + _ROWS, np.newaxis]
            curvature += weighted.T @ weighted
        step = scipy.linalg.cho_solve(scipy.linalg.cho_factor(curvature), gradient)
        along, factor = features @ step, 1.0
        bound = loss + _FLAT * len(wanted)
        while (new := _loss(odds + factor * along, wanted, ridge, weights + factor * step)) > bound:
            factor *= 0.5
            if factor < _LEAST_STEP:
                return weights
        weights, odds, loss = weights + factor * step, odds + factor * along, new
        if step @ gradient < _TOLERANCE * len(wanted):
            break
    return weights


def _loss(odds: FloatArray, wanted: FloatArray, ridge: FloatArray, weights: FloatArray) -> float:
    return float(np.logaddexp(0.0, odds).sum() - wanted @ odds + 0.5 * (ridge * weights**2).sum())


def event_probability(weights: FloatArray, features: FloatArray) -> FloatArray:
    """Probability of each event by weights of `fit_logistic`, ``(points, events)``.

    Each point is summed by itself: a matrix product would round it by the points beside it.
    """
    rows = np.ascontiguousarray(features)
    sums = [(rows * each).sum(axis=1) for each in np.ascontiguousarray(weights[:-1].T)]
    return np.asarray(scipy.special.expit(np.stack(sums, axis=1) + weights[-1]))
