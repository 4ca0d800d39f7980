"""Bounds of settings that are other settings, as the model states them."""

import math
from collections.abc import Callable, Iterator, Mapping
from typing import Any

from burstcast_workflow.config.kinds import RELATIONS, Section
from burstcast_workflow.config.places import Place


def _is_multiple(value: float, unit: float) -> bool:
    """Whether value is unit times 1, 2, 3, ..., up to rounding errors."""
    ratio = value / unit
    return round(ratio) >= 1 and math.isclose(ratio, round(ratio), rel_tol=1e-9)


_HOLDS: dict[str, Callable[[Any, Any], bool]] = {
    "below": lambda value, other: value < other,
    "at_most": lambda value, other: value <= other,
    "at_least": lambda value, other: value >= other,
    "not_beyond": lambda value, other: value <= other,
    "multiple_of": _is_multiple,
    "one_of": lambda value, other: value in other,
    "within": lambda value, other: other[0] <= value <= other[1],
}


def out_of_bounds(section: Section) -> Iterator[str]:
    """Check settings against the settings that bound them; a message for each mistake."""
    settings = section.dump()
    for place in Place(type(section)).settings():
        # what bounds a setting of a case is in the same case
        if place.name.startswith("case_defaults."):
            continue
        for relation, other in place.relations.items():
            factors = [_at(settings, factor) for factor in other.split(" * ")]
            bound = factors[0] if len(factors) == 1 else math.prod(factors)
            value = _at(settings, place.name)
            for item in value if isinstance(value, list) else [value]:
                if item is None or isinstance(item, Mapping):  # left out; known to a job only
                    continue
                if bound not in (None, []) and not _HOLDS[relation](item, bound):
                    verb = "has" if isinstance(value, list) else "is"
                    limit = ", ".join(map(str, bound if isinstance(bound, list) else [bound]))
                    must = f"{RELATIONS[relation]} {other}, {limit}"
                    yield f"{place.name} {verb} {item}; it {must}"


def _at(settings: Mapping[str, Any], name: str) -> Any:
    """Value of a setting; in the blocks of the campaign, all its values."""
    value: Any = settings
    for count, part in enumerate(name.replace("[]", "").split(".")):
        if isinstance(value, list):
            rest = ".".join(name.replace("[]", "").split(".")[count:])
            found = [_at(block, rest) or [] for block in value]
            return sorted({item for items in found for item in items})
        value = value.get(part) if isinstance(value, Mapping) else None
    return value
