"""Mistakes that pydantic finds in a configuration, as messages: ``path: message (got value)``."""

import difflib
import json
from collections.abc import Collection, Iterable, Iterator, Sequence
from typing import Any

from pydantic import ValidationError

from burstcast_workflow.config.kinds import Section
from burstcast_workflow.config.reference import below, schema_of, section_of, settings

_LONGEST = 80
_MOST_PLACES = 5
_MAPPING = ("model_type", "dict_type")
_WITHOUT_VALUE = ("missing", "extra_forbidden", "invalid_key")


def problems_of(error: ValidationError, model: type[Section]) -> list[str]:
    """Mistakes in a section that its model has found, a message for each."""
    return list(
        dict.fromkeys(_message(mistake, model) for mistake in error.errors(include_url=False))
    )


def of_cases(problems: Iterable[tuple[str, Iterable[str]]]) -> list[str]:
    """Mistakes by the case, each once with all the cases that have it."""
    cases: dict[str, list[str]] = {}
    for case, texts in problems:
        for text in texts:
            cases.setdefault(text, []).append(case)
    return [
        f"case{'s' if len(names) > 1 else ''} {', '.join(dict.fromkeys(names))}: {text}"
        for text, names in cases.items()
    ]


def suggestion(name: str, names: Iterable[str]) -> str:
    """Suggest the known name that was probably meant, or list the known names."""
    names = list(names)
    if near := difflib.get_close_matches(name, names, n=1, cutoff=0.6):
        return f"did you mean {near[0]}?"
    return f"known are {', '.join(names)}" if names else "none is known here"


def unknown(names: Iterable[str], existing: Collection[str], text: str) -> Iterator[str]:
    """A message for each unknown name: a text with ``{}`` for the name, and a suggestion."""
    for name in names:
        if name not in existing:
            yield f"{text.format(name)}; {suggestion(name, existing)}"


def name_of(path: Sequence[str | int]) -> str:
    """Name of a place in a configuration: ``campaign[0].neurons``."""
    parts = (f"[{part}]" if isinstance(part, int) else f".{part}" for part in path)
    return "".join(parts).removeprefix(".")


def _message(mistake: Any, model: type[Section]) -> str:
    path, kind, text, value = mistake["loc"], mistake["type"], mistake["msg"], mistake["input"]
    if kind == "invalid_key":
        path, text = path[:-1], f"the key {value!r} must be text"
        if isinstance(value, int | float):
            text += "; in braces a comma ends a value: write a decimal number with a point"
    elif path[-1:] == ("[key]",):
        path, text = path[:-1], f"the name {text}"
    elif kind == "extra_forbidden":
        text = f"unknown setting; {_meant(path, model)}"
    elif kind == "missing":
        text = f"missing: {_node(path, model).get('description', '')}".removesuffix(": ")
    elif kind in _MAPPING:
        text = "must be a mapping of settings"
    elif isinstance(value, bool) and '"string"' in json.dumps(_node(path, model)):
        text += "; YAML reads yes, no, on and off as true and false: quote text"
    shown = json.dumps(value, default=str, ensure_ascii=False)
    shown = f" (got {shown})" if len(shown) <= _LONGEST and kind not in _WITHOUT_VALUE else ""
    return f"{name_of(path)}: {text}{shown}".removeprefix(": ")


def _node(path: Sequence[str | int], model: type[Section]) -> dict[str, Any]:
    whole = node = schema_of(model)
    for part in path:
        node = below(whole, node, part)
    return node


def _meant(path: Sequence[str | int], model: type[Section]) -> str:
    """Settings of the section with nearly that name, or of others with the very name."""
    whole, name = schema_of(model), str(path[-1])
    properties = section_of(whole, _node(path[:-1], model)).get("properties", {})
    if elsewhere := [place for place, _ in settings(whole) if place.split(".")[-1] == name]:
        near = difflib.get_close_matches(name, properties, n=1, cutoff=0.6)
        return f"did you mean {' or '.join([*near, *elsewhere[:_MOST_PLACES]])}?"
    return suggestion(name, properties)
