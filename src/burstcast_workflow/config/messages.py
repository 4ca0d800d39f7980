"""Messages for errors that the model of the config finds, in words for its author."""

import difflib
import math
import re
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from pydantic import ValidationError

from burstcast_workflow.config.kinds import Section
from burstcast_workflow.config.places import Place

_NUMBER_AS_TEXT = re.compile(r"([+-]?)(\d*)(?:\.(\d*))?(?:[eE]([+-]?)(\d+))?")


def model_problems(error: ValidationError, model: type[Section]) -> list[str]:
    """Mistakes in settings found by the model, one message each."""
    messages = [
        _message(Place(model), problem["type"], problem["loc"], problem["input"], problem["msg"])
        for problem in error.errors(include_url=False)
    ]
    return list(dict.fromkeys(messages))


def suggestion(name: str, known: Iterable[str]) -> str:
    """Suggest the known name that was probably meant, or list the known names."""
    candidates = list(known)
    near = difflib.get_close_matches(name, candidates, n=1, cutoff=0.6)
    if near:
        return f"did you mean {near[0]}?"
    return f"known are {', '.join(candidates)}" if candidates else "none is known here"


def _message(root: Place, error: str, path: Sequence[str | int], value: Any, text: str) -> str:
    of_key = path[-1:] == ("[key]",) and error.startswith("string_")
    above = place = root
    for part in path[:-1] if of_key else path:
        above, place = place, place.below(part)
    if error == "invalid_key" or (of_key and error == "string_type"):
        comma = "; in braces a comma ends a value: write a decimal number with a point"
        number = comma if isinstance(value, int | float) else ""
        return f"{place.name}: the key {value!r} must be text{number}"
    if of_key:
        return f"{place.name}: the name must be {above.key.allowed()}"
    if error == "missing":
        return f"{place.name} is missing" + (f": {place.meaning}" if place.meaning else "")
    if error == "extra_forbidden":
        return f"unknown setting {place.name}; {_known_elsewhere(str(path[-1]), above, root)}"
    if isinstance(value, float) and not math.isfinite(value):
        return f"{place.name} is {value}; it must be a finite number"
    if error == "between":
        return f"{place.name} {text}"
    allowed = place.allowed() + (f" [{place.unit}]" if place.unit else "")
    meaning = f" ({place.meaning})" if place.meaning else ""
    hint = _number_hint(value) if {int, float} & set(place.kinds) else ""
    if isinstance(value, bool) and str in place.kinds:
        hint = "; YAML reads yes, no, on and off as true and false: quote text"
    return f"{place.name} is {_value(value)}; it must be {allowed}{meaning}{hint}"


def _known_elsewhere(name: str, section: Place, root: Place) -> str:
    places = [place.name for place in root.settings()]
    if elsewhere := [place for place in places if place.split(".")[-1] == name]:
        near = difflib.get_close_matches(name, section.fields, n=1, cutoff=0.6)
        return f"did you mean {' or '.join([*near, *elsewhere])}?"
    return suggestion(name, section.fields)


def _number_hint(text: Any) -> str:
    """Explain how to write a number that was read as text; empty if the text is no number."""
    match = _NUMBER_AS_TEXT.fullmatch(text) if isinstance(text, str) else None
    if not match or not (match[2] or match[3]):
        return ""
    sign, whole, fraction, power_sign, power = match.groups()
    if power is None:
        return f"; write {text} without quotes"
    number = f"{sign}{whole or 0}.{fraction or 0}e{power_sign or '+'}{power}"
    return f"; YAML reads {text} as text: write {number}"


def _value(value: Any) -> str:
    if value is None:
        return "empty (null)"
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, str):
        return f"the text {value!r}"
    if isinstance(value, Mapping):
        keys = ", ".join(map(str, value))
        return f"a mapping with the keys {keys}" if keys else "an empty mapping"
    text = str(value)
    return text if len(text) <= 80 else text[:77] + "..."
