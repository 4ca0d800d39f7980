"""Parameters of an event forecaster as a person may give them: checked, by their names."""

import dataclasses
import math
import numbers
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

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
