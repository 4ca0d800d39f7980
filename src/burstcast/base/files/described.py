"""Descriptions of arrays in a dataclass, which are stored in files.

A field says it in its type::

    true: Annotated[FloatArray, Described("time", OBSERVABLE, "true observable")]
"""

from dataclasses import dataclass, fields
from typing import Any, get_type_hints


@dataclass(frozen=True)
class Described:
    """Description of an array: axes, unit and meaning."""

    #: names of its axes, as one text; arrays that share a name agree on its length. Empty for a
    #: number.
    axes: str
    unit: str  #: one of `burstcast.base.files.units`
    meaning: str  #: what it holds, in words


def descriptions(kind: type[Any]) -> dict[str, Described]:
    """Descriptions of all fields of a dataclass by their names."""
    hints = get_type_hints(kind, include_extras=True)
    return {field.name: hints[field.name].__metadata__[0] for field in fields(kind)}
