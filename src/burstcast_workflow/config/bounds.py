"""Bounds of settings that are other settings, as the model states them."""

import math
from collections.abc import Callable, Iterator, Mapping
from functools import cache
from operator import ge, le, lt
from typing import Any, get_args

from burstcast_workflow.config.kinds import RELATIONS, Section


def _is_multiple(value: float, bound: float) -> bool:
    """Whether a value is a bound times 1, 2, 3, ..., up to rounding errors."""
    ratio = value / bound
    return round(ratio) >= 1 and math.isclose(ratio, round(ratio), rel_tol=1e-9)


_HOLDS: dict[str, Callable[[Any, Any], bool]] = {
    "below": lt,
    "at_most": le,
    "not_beyond": le,
    "at_least": ge,
    "multiple_of": _is_multiple,
    "one_of": lambda value, bound: value in bound,
    "within": lambda value, bound: bound[0] <= value <= bound[1],
}
"""Whether a value has a relation (`RELATIONS`) to a bound."""


def out_of_bounds(section: Section) -> Iterator[str]:
    """Check settings against the settings that bound them; a message for each mistake."""
    values = section.dump()
    for name, relation, other in _bounds(type(section)):
        bound, *factors = [_at(values, factor) for factor in other.split(" * ")]
        if factors:
            bound = math.prod(factors, start=bound)
        value = _at(values, name)
        for item in value if isinstance(value, list) else [value]:
            if item is None or isinstance(item, Mapping) or bound in (None, []):
                continue  # left out, or known to a job only
            if not _HOLDS[relation](item, bound):
                limit = ", ".join(map(str, bound if isinstance(bound, list) else [bound]))
                yield f"{name}: {RELATIONS[relation]} {other}, {limit} (got {item})"


@cache
def _bounds(model: type[Section], place: str = "") -> list[tuple[str, str, str]]:
    """Settings that are bounded by others, with the relation and the name of the other.

    They are read from the fields: to make the schema would take a tenth of a second at each start.
    """
    bounds: list[tuple[str, str, str]] = []
    for key, field in model.model_fields.items():
        name, extra = f"{place}{key}", field.json_schema_extra
        relations: Any = extra.get("relations", {}) if isinstance(extra, dict) else {}
        bounds += [(name, relation, other) for relation, other in relations.items()]
        # what bounds a setting of a case is in the same case
        for section in _sections(field.annotation) if name != "case_defaults" else ():
            bounds += _bounds(section, f"{name}.")
    return bounds


def _sections(kind: Any) -> Iterator[type[Section]]:
    """Sections in a type: of ``list[Block] | None`` the block."""
    if isinstance(kind, type) and issubclass(kind, Section):
        yield kind
    for inside in get_args(kind):
        yield from _sections(inside)


def _at(settings: Any, name: str) -> Any:
    """Value of a setting; of a setting in the items of a list, all its values."""
    if isinstance(settings, list):
        return sorted({value for item in settings for value in _at(item, name) or []})
    key, _, rest = name.partition(".")
    value = settings.get(key) if isinstance(settings, Mapping) else None
    return _at(value, rest) if rest else value
