"""Settings in canonical form: settings of equal meaning have equal values and equal text.

Snakemake compares the parameters of a job by their representation. In canonical form the order of
keys, 1 or 1.0, a tuple or a list make no difference, and everything is plain JSON, which Snakemake
tracks; it does not track NumPy numbers, arrays or paths.
"""

import json
import math
from typing import Any


def canonical(value: Any, name: str = "settings") -> Any:
    """Copy plain data with sorted keys, tuples as lists, and whole floats as integers.

    ``value``: Nested mappings with text as keys, lists, tuples, text, finite numbers, truth values,
    None.
    """
    # exact types: subclasses (NumPy's float64, enumerations) have representations of their own
    if value is None or type(value) in (bool, int, str):
        return value
    if type(value) is float:
        if not math.isfinite(value):
            raise ValueError(f"{name} is {value}: only finite numbers are settings")
        return int(value) if value.is_integer() else value
    if type(value) in (list, tuple):
        return [canonical(item, f"{name}[{index}]") for index, item in enumerate(value)]
    if isinstance(value, dict):
        for key in value:
            if type(key) is not str:
                raise TypeError(f"{name} has the key {key!r}: only text can be a key")
        return {key: canonical(value[key], f"{name}.{key}") for key in sorted(value)}
    raise TypeError(
        f"{name} is {value!r} of type {type(value).__module__}.{type(value).__qualname__}: "
        "only plain numbers, text, truth values, null, lists and mappings are settings"
    )


def canonical_json(value: Any, name: str = "settings") -> str:
    """Text of the canonical form: one line of JSON, equal for equal settings."""
    return json.dumps(canonical(value, name), ensure_ascii=False, separators=(", ", ": "))
