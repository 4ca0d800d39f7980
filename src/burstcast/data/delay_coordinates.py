"""Delay coordinates: past observations as further components of a state.

Where only a part of a state is observed, its past tells of the rest: generically, 2 D + 1 values of
one observable, at equal distances in time, determine the state on an attractor of dimension D
(Takens, Lecture Notes in Mathematics 898, 1981; Sauer, Yorke & Casdagli, Journal of Statistical
Physics 65, 1991).
"""

from collections.abc import Sequence
from typing import Any

import numpy as np

from burstcast.base.arrays import FloatArray
from burstcast.data.series_layout import as_series


def delay_coordinates(series: Any, delays: Sequence[int]) -> FloatArray:
    """Append past values to each state of series.

    Parameters
    ----------
    series
        ``(series, time, component)`` (`burstcast.data.series_layout`).
    delays
        How many steps back, each 1 at least.

    Returns
    -------
    ``(series, time - longest, component * (1 + delays))``: all components now, then all of them at
    each delay in turn. The first states of a series, which have no such past, are left out.

    Raises
    ------
    ValueError
        If a delay is less than a step, or no state has such a past.

    Examples
    --------
    >>> import numpy as np
    >>> from burstcast.data.delay_coordinates import delay_coordinates
    >>> series = np.arange(5.0).reshape(1, 5, 1)
    >>> delay_coordinates(series, [1, 2])[0].tolist()
    [[2.0, 1.0, 0.0], [3.0, 2.0, 1.0], [4.0, 3.0, 2.0]]
    """
    series = as_series(series)
    longest, samples = max(delays, default=0), series.shape[1]
    if any(delay < 1 for delay in delays):
        raise ValueError(f"delays must be whole numbers above 0, not {list(delays)}")
    if longest >= samples:
        raise ValueError(
            f"delays reach back by {longest} steps, but a series has {samples} samples"
        )
    parts = [series[:, longest - delay : samples - delay] for delay in (0, *delays)]
    return np.concatenate(parts, axis=2)


def delayed_name(name: str, delay: int) -> str:
    """Name of a delayed component: ``x(t-5)``."""
    return f"{name}(t-{delay})"
