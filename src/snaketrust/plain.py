"""Plain data: parameters that mean the same are the same, in planning, in records and in scripts.

The order of keys, 1 or 1.0, a tuple or a list, a number of NumPy's or Python's make no difference.
"""

import math
from collections.abc import Iterable, Mapping
from typing import Any


def plain(value: Any, name: str = "settings") -> Any:
    """Copy data with sorted keys, tuples as lists, whole floats as integers, NumPy's as Python's.

    Raises `TypeError` for other types (the message names where), `ValueError` for numbers that are
    not finite.
    """
    if value is None or type(value) in (bool, int, str):
        return value
    if type(value) is float:
        if not math.isfinite(value):
            raise ValueError(f"{name} is {value}: only finite numbers are parameters")
        return int(value) if value.is_integer() else value
    if type(value) in (list, tuple):
        return [plain(item, f"{name}[{index}]") for index, item in enumerate(value)]
    if isinstance(value, Mapping):
        if odd := [key for key in value if type(key) not in (str, int)]:
            raise TypeError(f"{name} has the key {odd[0]!r}: only text and whole numbers are keys")
        keys = sorted(value, key=lambda key: (type(key) is int, key))
        return {key: plain(value[key], f"{name}.{key}") for key in keys}
    if type(value).__module__ == "numpy" and getattr(value, "ndim", 1) == 0:
        item = value.item()
        if type(item) is not type(value):
            return plain(item, name)
    # text with an origin, as Snakemake's paths are
    if isinstance(value, str) and type(value).__module__.startswith("snakemake"):
        return str.__str__(value)
    raise TypeError(
        f"{name} is {value!r} of type {type(value).__module__}.{type(value).__qualname__}: only "
        f"plain numbers, text, truth values, null, lists and mappings are parameters"
    )


def named(items: Any) -> dict[str, Any]:
    """Parameters of a rule by name, in its order; by position where one has no name."""
    names = {place: name for name, (place, _) in items._get_names()}
    return {names.get(place, str(place)): value for place, value in enumerate(items)}


def groups(files: Any, paths: Iterable[str]) -> dict[str, Any]:
    """Places of files among different paths, by the rule's names; a list where it has a list."""
    places = {path: place for place, path in enumerate(dict.fromkeys(paths))}
    numbers = [places[path] for path in paths]
    found: dict[str, Any] = {}
    named_places: set[int] = set()
    for name, (start, end) in files._get_names():
        found[name] = numbers[start] if end is None else numbers[start:end]
        named_places.update(range(start, start + 1 if end is None else end))
    unnamed = [number for place, number in enumerate(numbers) if place not in named_places]
    return {"": unnamed, **found} if unnamed else found
