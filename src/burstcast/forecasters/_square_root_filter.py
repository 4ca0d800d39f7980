"""The ensemble square-root filter: an estimate of the present state from a noisy history.

The mean of an ensemble of states is the estimate, and its scatter the covariance of the error. A
model advances the members; each observation then moves their mean as the Kalman filter does, and
shrinks their deviations such that their covariance is the Kalman filter's, too. No random numbers
are needed (Whitaker & Hamill, "Ensemble data assimilation without perturbed observations", Monthly
Weather Review 130, 2002). The errors of the components of an observation are independent, so that
the components are assimilated one after the other.
"""

import math

import numpy as np

from burstcast.base.arrays import FloatArray


def symmetric_members(centre: FloatArray, deviation: FloatArray, members: int) -> FloatArray:
    """Ensemble around a state with exactly the covariance of independent errors.

    Members come in pairs on opposite sides of the centre, so that odd moments vanish as for a
    normal distribution, in directions from a table of cosines (the orthogonal matrix of the
    discrete cosine transform): sigma points as in the unscented Kalman filter (Julier & Uhlmann,
    Proceedings of the IEEE 92, 2004), but more of them. Nothing is random.

    ``centre``: ``(dimension, batch)``. ``deviation``: Standard deviation of the error of each
    component, ``(dimension,)``. Shape ``(dimension, members, batch)``.

    Examples
    --------
    >>> import numpy as np
    >>> from burstcast.forecasters._square_root_filter import symmetric_members
    >>> ensemble = symmetric_members(np.zeros((3, 1)), np.array([0.1, 0.1, 0.2]), 8)
    >>> np.cov(ensemble[..., 0]).diagonal().round(3).tolist()
    [0.01, 0.01, 0.04]
    """
    dimension, pairs = centre.shape[0], members // 2
    if members % 2 or pairs < dimension:
        raise ValueError(
            f"an ensemble of {members} members cannot stand for errors in {dimension} components: "
            f"it takes an even number, at least {2 * dimension}"
        )
    row, column = np.arange(1, dimension + 1)[:, np.newaxis], np.arange(pairs) + 0.5
    # row `pairs` of the transform would be zero: the constant row takes its place
    cosines = np.where(row < pairs, math.sqrt(2.0) * np.cos(math.pi * row * column / pairs), 1.0)
    directions = math.sqrt((members - 1) / members) * cosines
    offsets = deviation[:, np.newaxis] * np.concatenate([directions, -directions], axis=1)
    ensemble: FloatArray = centre[:, np.newaxis] + offsets[:, :, np.newaxis]
    return ensemble


def assimilate(
    ensemble: FloatArray, observation: FloatArray, noise: FloatArray, inflation: float
) -> FloatArray:
    """Ensembles after an observation of their first components, ``(rows, members, batch)``.

    ``ensemble``: Forecasts of the model for the time of the observation, ``(rows, members,
    batch)``. The first rows are observed; further rows are corrected by their covariance with
    these. ``observation``: ``(observed, batch)``. ``noise``: Standard deviation of the errors of
    the observation, ``(observed,)``. ``inflation``: Factor of the deviations from the mean before
    the observation: above 1, it makes up for errors of the model and for the finite ensemble. A
    member that is not finite makes its whole ensemble so.
    """
    # an ensemble that overflows is a result, not an error
    with np.errstate(over="ignore", invalid="ignore"):
        centre = mean(ensemble)
        deviation = inflation * (ensemble - centre[:, np.newaxis])
        for component, variance in enumerate(np.square(noise)):
            innovation = observation[component] - centre[component]
            gain, reduced = _gains(deviation, component, variance)
            observed = deviation[component].copy()
            centre += gain * innovation
            deviation -= reduced[:, np.newaxis] * observed
        updated: FloatArray = centre[:, np.newaxis] + deviation
    return updated


def combinations(forecast: FloatArray, observation: FloatArray, noise: FloatArray) -> FloatArray:
    """The update of `assimilate` as weights of the members, ``(batch, members, members)``.

    Members ``(rows, members)`` of a point before the observation, times its matrix, are the members
    after it, whatever the rows are. This is the faster form for ensembles with many more rows than
    members.

    ``forecast``: Observed components of the members before the observation, ``(observed, batch,
    members)``. ``observation``, ``noise``: As for `assimilate`.
    """
    forecast = np.ascontiguousarray(forecast)  # sums depend on the layout in their last bits
    _, batch, members = forecast.shape
    with np.errstate(over="ignore", invalid="ignore"):
        centre = forecast.mean(axis=2)
        deviation = forecast - centre[..., np.newaxis]
        weights = np.tile(np.eye(members), (batch, 1, 1))
        shift = np.zeros((batch, members))
        for component, variance in enumerate(np.square(noise)):
            own = deviation[component].copy()
            total = np.square(own).sum(axis=1) / (members - 1) + variance
            # known without error, and observed without error: nothing to learn
            certain = total == 0.0
            total[certain] = 1.0
            gain = np.where(certain, 0.0, 1.0 / ((members - 1) * total))
            reduced = gain / (1.0 + np.sqrt(variance / total))
            innovation = gain * (observation[component] - centre[component])
            covariance = (deviation * own).sum(axis=2)
            centre += covariance * innovation
            deviation -= (covariance * reduced)[..., np.newaxis] * own
            along = (weights * own[:, np.newaxis]).sum(axis=2)
            shift += along * innovation[:, np.newaxis]
            weights -= along[..., np.newaxis] * (reduced[:, np.newaxis] * own)[:, np.newaxis]
        weights += shift[..., np.newaxis]
        # of deviations from the mean, and the mean itself
        weights += 1.0 / members - weights.mean(axis=1, keepdims=True)
    return weights


def _gains(deviation: FloatArray, component: int, variance: float) -> tuple[FloatArray, FloatArray]:
    """Gains of the mean and of the deviations from an observed component, ``(rows, batch)``."""
    rows, members, batch = deviation.shape
    # sums go member by member, as the sum for the mean does
    covariance = np.zeros((rows, batch))
    for member in deviation.swapaxes(0, 1):
        covariance += member * member[component]
    total = covariance[component] / (members - 1) + variance
    # known without error, and observed without error: nothing to learn
    certain = total == 0.0
    total[certain] = 1.0
    gain = covariance / (members - 1) / total
    gain[:, certain] = 0.0
    return gain, gain / (1.0 + np.sqrt(variance / total))


def mean(ensemble: FloatArray) -> FloatArray:
    """Mean of ensembles ``(rows, members, batch)`` over their members, ``(rows, batch)``."""
    # member by member: the order of numpy's own sums may depend on the size of the batch
    total: FloatArray = ensemble[:, 0].copy()
    for member in range(1, ensemble.shape[1]):
        total += ensemble[:, member]
    total /= ensemble.shape[1]
    return total
