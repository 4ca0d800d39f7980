"""Schedules of parameters of the equations, from the forms in which users give them."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from burstcast.base.arrays import FloatArray, float_array


def as_schedules(given: Any, series: int, steps: int, names: Sequence[str]) -> FloatArray:
    """Schedules of several series, ``(series, steps, parameters)``.

    ``given``: One value, or one for each parameter; one value for each series, ``(series,)`` or
    ``(series, parameters)``; or values in force from each sample to the next, ``(series, steps)``
    or ``(series, steps, parameters)``.

    Examples
    --------
    >>> as_schedules([400.0, 600.0], 2, 5, ["reynolds"]).shape
    (2, 5, 1)
    """
    values, number = float_array(given, "parameters"), len(names)
    whole = (series, steps, number)
    shapes: list[tuple[int, ...]] = [(number,), (series, number), whole]
    if number == 1:
        shapes = [(), (series,), (series, steps), *shapes]
    if values.shape not in shapes:
        raise ValueError(
            f"parameters have the shape {values.shape}; {series} series of {steps} steps and the "
            f"parameters {', '.join(names)} need one of {', '.join(map(str, shapes))}"
        )
    if not np.isfinite(values).all():
        raise ValueError(f"parameters ({', '.join(names)}) must be finite")
    if number == 1 and values.shape not in ((series, number), whole):
        values = values[..., np.newaxis]
    if values.ndim == 2:
        values = values[:, np.newaxis]
    return np.array(np.broadcast_to(values, whole), order="C")
