"""Parameters of an event forecaster as a person may give them: checked, by their names."""

import copy
import dataclasses
import datetime
import math
import numbers
from collections.abc import Mapping, Sequence
from contextlib import suppress
from typing import Any

import numpy as np

from burstcast.data.clocks import SECONDS

Duration = float | str | datetime.timedelta
"""A number, in a unit that all durations share, or a duration with its unit: "10 minutes"."""

_LEAST = {
    "grid": 1,
    "neurons": 1,
    "searches": 1,
    "bayesian_points": 0,
    "noise": 0.0,
    "prior_forecasts": 0.0,
}
"""Smallest values of parameters; durations are compared with a sample where they are used."""


def checked_parameters(estimator: Any) -> dict[str, Any]:
    """Parameters with the types of their fields: 30.0 is a whole number, 1 one prediction time.

    ``estimator``: A dataclass whose annotations are texts.
    """
    checked = {}
    for field in dataclasses.fields(estimator):
        name, value = field.name, getattr(estimator, field.name)
        expected = str(field.type)
        if value is None and expected.endswith(" | None"):
            pass
        elif (expected := expected.removesuffix(" | None")) in ("int", "float"):
            value = _number(name, value, whole=expected == "int")
        elif expected == "Duration":
            value = _seconds(name, value) if has_unit(value) else _number(name, value)
        elif expected == "tuple[float, float]":
            if not _is_several(value) or len(value) != 2:
                raise TypeError(f"{name} must be two numbers, (low, high), not {value!r}")
            value = tuple(_number(name, number) for number in value)
        elif expected == "float | Sequence[float]":
            several = value if _is_several(value) else [value]
            value = tuple(_number(name, number) for number in several)
        elif expected.startswith("float |") and not isinstance(value, Mapping):
            value = _number(name, value)
        elif expected == "Observable" and (value is None or isinstance(value, float | bool)):
            raise TypeError(
                "observable must be the number of a component, counted from 0, its label, a "
                f"function of states, or a system, not {value!r}"
            )
        if name in _LEAST and value < _LEAST[name]:
            raise ValueError(f"{name} must be {_LEAST[name]:g} at least, not {value!r}")
        checked[name] = value
    return checked


def _seconds(name: str, value: Any) -> float:
    """Seconds of a duration with a unit: "10 minutes", "10min", a Timedelta, or an offset."""
    import pandas as pd

    from burstcast.data.times import is_number, time_step_of

    if not isinstance(value, str) or not is_number(value):
        with suppress(ValueError, TypeError):
            number, unit = time_step_of(value)
            return number * SECONDS[unit or "second"]
        with suppress(ValueError, TypeError):
            seconds = pd.Timedelta(value).total_seconds()
            if seconds > 0:
                return seconds
    raise ValueError(
        f"{name} is {value}, which is no duration: write a number, or a positive one with second, "
        f"minute, hour or day, such as '5 minutes', or a Timedelta"
    )


def has_unit(duration: Any) -> bool:
    """Whether a duration is in seconds, since it was given with a unit."""
    is_offset = hasattr(duration, "freqstr")  # of pandas
    return is_offset or isinstance(duration, str | datetime.timedelta | np.timedelta64)


def described(value: Any) -> str:
    """A parameter as messages name it: a short text that differs for other values."""
    return getattr(value, "__name__", None) or repr(value)


def copied(value: Any) -> Any:
    """A parameter that a user cannot change in place any more."""
    if isinstance(value, Mapping):
        return dict(value)
    return copy.copy(value) if isinstance(value, list | np.ndarray) else value


def is_same(value: Any, other: Any) -> bool:
    """Whether a parameter has the value of another one, as numbers or as texts."""
    if value is other:
        return True
    if isinstance(value, numbers.Real) and isinstance(other, numbers.Real):
        return bool(value == other)
    if isinstance(value, Sequence | np.ndarray) and isinstance(other, Sequence | np.ndarray):
        texts = isinstance(value, str), isinstance(other, str)
        return texts[0] == texts[1] and list(value) == list(other)
    if isinstance(value, Mapping) and isinstance(other, Mapping):
        return dict(value) == dict(other)
    return type(value) is type(other) and bool(value == other or repr(value) == repr(other))


def _is_several(value: Any) -> bool:
    is_sequence = isinstance(value, Sequence | np.ndarray) and not isinstance(value, str)
    return is_sequence and np.ndim(value) == 1


def _number(name: str, value: Any, *, whole: bool = False) -> Any:
    is_number = isinstance(value, numbers.Real) and not isinstance(value, bool)
    if not is_number or (whole and not (math.isfinite(value) and value == int(value))):
        raise TypeError(f"{name} must be a {'whole ' if whole else ''}number, not {value!r}")
    if not whole and not abs(value) < 2**53:  # nor NaN
        raise ValueError(f"{name} must be finite, and below 2^53, not {value!r}")
    return int(value) if whole else value
