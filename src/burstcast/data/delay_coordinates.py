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
from burstcast.base.series_lengths import array_or_list, padded, without_padding
from burstcast.data.series_layout import labelled_series


def delay_coordinates(series: Any, delays: Sequence[int]) -> FloatArray | list[FloatArray]:
    """Append past values to each state of series.

    Parameters
    ----------
    series
        ``(series, time, component)`` (`burstcast.data.series_layout`), or a list of series of
        unequal lengths.
    delays
        How many steps back, each 1 at least.

    Returns
    -------
    ``(series, time - longest, component * (1 + delays))``: all components now, then all of them at
    each delay in turn. The first states of a series, which have no such past, are left out. Of
    series of unequal lengths, a list of ``(time - longest, component * (1 + delays))``.

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
    return array_or_list(with_delays(labelled_series(series).states, delays))


def with_delays(states: FloatArray, delays: Sequence[int]) -> FloatArray:
    """States ``(series, time, component)`` with past values; shorter series end with NaN."""
    longest, series = max(delays, default=0), without_padding(states)
    if any(delay < 1 for delay in delays):
        raise ValueError(f"delays must be whole numbers above 0, not {list(delays)}")
    if longest >= (samples := min(map(len, series))):
        raise ValueError(
            f"delays reach back by {longest} steps, but a series has {samples} samples"
        )
    backwards = (0, *delays)
    return padded(
        [
            np.concatenate([run[longest - back : len(run) - back] for back in backwards], axis=1)
            for run in series
        ]
    )


def delayed_name(name: str, delay: int) -> str:
    """Name of a delayed component: ``x(t-5)``."""
    return f"{name}(t-{delay})"
