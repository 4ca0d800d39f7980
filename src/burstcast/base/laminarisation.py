"""Laminarisation: from which value of the observable a flow counts as laminar.

Source: the paper discards "the time series whose maximum kinetic energy is larger than the
laminarization threshold", k > k_l, in its data and in the networks' long-term predictions. A value
equal to the threshold is therefore not laminar, whereas it belongs to an extreme event
(`burstcast.base.events`). In double precision the difference has not mattered so far: of 6.4
million energies of 400 flows at Re = 400, the nearest to k_l = 0.48 differs from it by 6e-8.
"""

import numpy as np

from burstcast.base.arrays import BoolArray, FloatArray, IntArray


def is_laminar(observable: FloatArray, threshold: float | None) -> BoolArray:
    """Mark laminar values: those above the threshold.

    Parameters
    ----------
    observable
        Observable of any shape; a value that is NaN is not laminar.
    threshold
        The laminarisation threshold, k_l; None: no value is laminar.

    Examples
    --------
    >>> import numpy as np
    >>> from burstcast.base.laminarisation import is_laminar
    >>> is_laminar(np.array([0.1, 0.49]), 0.48).tolist()
    [False, True]
    """
    if threshold is None:
        return np.zeros(np.shape(observable), dtype=bool)
    return np.asarray(observable > threshold)


def first_laminar_step(observable: FloatArray, threshold: float | None, axis: int = -1) -> IntArray:
    """Find the first step at which each series is laminar (see `is_laminar`).

    ``threshold``: The laminarisation threshold; None: no series is ever laminar. Returns steps from
    0, of the observable's shape without ``axis``; -1 where no step is laminar.
    """
    laminar = is_laminar(observable, threshold)
    return np.where(laminar.any(axis=axis), laminar.argmax(axis=axis), -1)
