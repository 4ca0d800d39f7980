"""Parameters of an event forecaster as a person may give them: checked, by their names."""

import math
import numbers
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

_WHOLE = (
    "members",
    "neurons",
    "validation_series",
    "intervals_per_series",
    "grid",
    "bayesian_points",
    "sampling_stride",
    "random_seed",
)
_NUMBERS = (
    "window",
    "lyapunov_time",
    "sampling_interval",
    "washout",
    "validation_interval",
    "prior_forecasts",
    "calibration_spacing",
    "start_spacing",
    "noise",
)
_MAY_BE_NONE = ("validation_series", "intervals_per_series", "lyapunov_time")


def checked_parameters(given: Mapping[str, Any]) -> dict[str, Any]:
    """Parameters with the types that they must have: 30.0 is a whole number, 1 one prediction time.

    ``given``: Parameters of `burstcast.EventForecaster` by name.
    """
    found = dict(given)
    for name in (*_WHOLE, *_NUMBERS):
        if found[name] is not None or name not in _MAY_BE_NONE:
            found[name] = _number(name, found[name], whole=name in _WHOLE)
    for name in ("prediction_times", "tikhonov"):
        values = found[name] if _is_several(found[name]) else [found[name]]
        found[name] = tuple(_number(name, value) for value in values)
    for name in ("spectral_radius", "input_scaling"):
        if not _is_several(found[name]) or len(found[name]) != 2:
            raise TypeError(f"{name} must be two numbers, (low, high), not {found[name]!r}")
        found[name] = tuple(_number(name, value) for value in found[name])
    if not isinstance(found["event_threshold"], Mapping):
        found["event_threshold"] = _number("event_threshold", found["event_threshold"])
    observable = found["observable"]
    if isinstance(observable, str | float | bool) or observable is None:
        raise TypeError(
            "observable must be the number of a component, counted from 0, a function of states, "
            f"or a system, not {observable!r}"
        )
    return found


def _is_several(value: Any) -> bool:
    return (
        isinstance(value, Sequence | np.ndarray)
        and not isinstance(value, str)
        and np.ndim(value) == 1
    )


def _number(name: str, value: Any, *, whole: bool = False) -> Any:
    is_number = isinstance(value, numbers.Real) and not isinstance(value, bool)
    if not is_number or (whole and not (math.isfinite(value) and value == int(value))):
        raise TypeError(f"{name} must be a {'whole ' if whole else ''}number, not {value!r}")
    return int(value) if whole else value
