"""Laminarisation: from which value of the observable a flow counts as laminar.

Source: the paper discards "the time series whose maximum kinetic energy is larger than the
laminarization threshold", k > k_l. A value equal to the threshold is therefore not laminar, whereas
it belongs to an extreme event (`burstcast.data.events`).
"""

import numpy as np

from burstcast.base.arrays import BoolArray, FloatArray, IntArray


def is_laminar(observable: FloatArray, threshold: float | None) -> BoolArray:
    """Mark laminar values: those above the threshold k_l; none without a threshold, and no NaN.

    Examples
    --------
    >>> is_laminar(np.array([0.1, 0.49]), 0.48).tolist()
    [False, True]
    """
    if threshold is None:
        return np.zeros(np.shape(observable), dtype=bool)
    return np.asarray(observable > threshold)


def first_laminar_step(observable: FloatArray, threshold: float | None, axis: int = -1) -> IntArray:
    """First laminar step of each series along ``axis``, from 0; -1 where no step is laminar."""
    laminar = is_laminar(observable, threshold)
    return np.where(laminar.any(axis=axis), laminar.argmax(axis=axis), -1)
