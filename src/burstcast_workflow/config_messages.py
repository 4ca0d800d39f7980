"""What is wrong with a config by its schema, in words for the person who wrote it."""

import difflib
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any

from jsonschema import Draft202012Validator
from jsonschema.exceptions import ValidationError

Schema = Mapping[str, Any]

_NUMBER_AS_TEXT = re.compile(r"([+-]?)(\d*)(?:\.(\d*))?(?:[eE]([+-]?)(\d+))?")
_TYPES = {
    "integer": "a whole number",
    "number": "a number",
    "string": "text",
    "boolean": "true or false",
    "array": "a list",
    "object": "a mapping of settings",
    "null": "null",
}


def schema_problems(config: Any, schema: dict[str, Any]) -> list[str]:
    """Check a config against the schema; one message for each setting that is wrong."""
    errors = Draft202012Validator(schema).iter_errors(config)
    return list(
        dict.fromkeys(
            message
            for error in sorted(errors, key=lambda error: [str(part) for part in error.path])
            for message in _messages(error, config, schema)
        )
    )


def dotted(path: Iterable[str | int]) -> str:
    """Path of a setting as a person reads it: ``campaign[0].neurons``."""
    text = ""
    for part in path:
        text += f"[{part}]" if isinstance(part, int) else f".{part}"
    return text.removeprefix(".")


def suggestion(name: str, known: Iterable[str]) -> str:
    """Say which known name was probably meant, or else which names there are."""
    candidates = list(known)
    near = difflib.get_close_matches(name, candidates, n=1, cutoff=0.6)
    if near:
        return f"did you mean {near[0]}?"
    return f"known are {', '.join(candidates)}" if candidates else "none is known here"


def _messages(error: ValidationError, config: Any, schema: Schema) -> Iterator[str]:
    path = list(error.absolute_path)
    value: Any = error.instance
    rule = error.schema if isinstance(error.schema, Mapping) else {}
    if error.validator == "additionalProperties":
        known = list(rule["properties"])
        for key in value:
            if key not in known:
                yield _unknown([*path, key], known, schema)
    elif error.validator == "required":
        for key in rule["required"]:
            if key not in value:
                description = _description(schema, [*path, key])
                name = dotted([*path, key])
                yield f"{name} is missing" + (f": {description}" if description else "")
    elif _inside_property_names(error):
        yield f"{dotted([*path, str(value)])}: the name must be {allowed(rule)}"
    elif error.validator == "uniqueItems":
        repeated = [item for index, item in enumerate(value) if item in value[:index]]
        yield f"{dotted(path)} has {_value(repeated[0])} twice"
    else:
        yield _wrong_value(path, value, rule)


def _inside_property_names(error: ValidationError) -> bool:
    return "propertyNames" in error.absolute_schema_path


def _unknown(path: Sequence[str | int], known: list[str], schema: Schema) -> str:
    name = str(path[-1])
    if not difflib.get_close_matches(name, known, n=1, cutoff=0.6):
        elsewhere = [place for place in _settings(schema) if place.split(".")[-1] == name]
        if elsewhere:
            return f"unknown setting {dotted(path)}; did you mean {' or '.join(elsewhere)}?"
    return f"unknown setting {dotted(path)}; {suggestion(name, known)}"


def _wrong_value(path: Sequence[str | int], value: Any, rule: Schema) -> str:
    message = f"{dotted(path) or 'the config'} is {_value(value)}; it must be {allowed(rule)}"
    description = rule.get("description")
    if description:
        message += f" ({description})"
    if isinstance(value, str) and {"number", "integer"} & set(_types(rule)):
        message += _number_hint(value)
    return message


def _number_hint(text: str) -> str:
    """Say how to write a number that was read as text; nothing if it is not like a number."""
    match = _NUMBER_AS_TEXT.fullmatch(text)
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
        return (
            f"a mapping with the keys {', '.join(map(str, value))}" if value else "an empty mapping"
        )
    text = str(value)
    return text if len(text) <= 80 else text[:77] + "..."


def allowed(rule: Schema) -> str:
    """Put into words what a rule of the schema allows."""
    if "allowed" in rule:
        return str(rule["allowed"])
    if "enum" in rule:
        values = [str(value) for value in rule["enum"]]
        return values[0] if len(values) == 1 else f"{', '.join(values[:-1])} or {values[-1]}"
    kinds = [_kind(name, rule) for name in _types(rule)]
    text = " or ".join(kinds)
    return f"{text} {unit}" if (unit := _unit(rule)) else text


def _unit(rule: Schema) -> str:
    return f"[{rule['unit']}]" if "unit" in rule else ""


def _types(rule: Schema) -> list[str]:
    types = rule.get("type", [])
    return [types] if isinstance(types, str) else list(types)


def _kind(name: str, rule: Schema) -> str:
    text = _TYPES[name]
    if name in ("number", "integer"):
        bounds = [
            f"{words} {rule[keyword]}"
            for keyword, words in (
                ("minimum", "not below"),
                ("exclusiveMinimum", "above"),
                ("maximum", "not above"),
                ("exclusiveMaximum", "below"),
            )
            if keyword in rule
        ]
        return f"{text} {' and '.join(bounds)}" if bounds else text
    if name == "array":
        items = rule.get("items", {})
        least = rule.get("minItems", 0)
        count = f" of at least {least}" if least else ""
        if "$ref" in items or not items:
            return f"{text}{count}" + (" entries" if least > 1 else " entry" if least else "")
        return (
            f"{text}{count}, each {allowed(items)}" if count else f"{text}, each {allowed(items)}"
        )
    return text


def _resolve(rule: Schema, schema: Schema) -> Schema:
    """Rule with what it refers to in the schema's $defs."""
    merged = dict(rule)
    while "$ref" in merged:
        name = merged.pop("$ref").rsplit("/", 1)[-1]
        merged = {**schema["$defs"][name], **merged}
    for part in merged.get("allOf", []):
        resolved = _resolve(part, schema)
        for key, value in resolved.items():
            # the parts repeat sections only to say what they require
            merged.setdefault(key, value)
    return merged


def _description(schema: Schema, path: Sequence[str | int]) -> str:
    """Find the description of a setting in the schema; empty if it has none."""
    rule = _resolve(schema, schema)
    for part in path:
        if isinstance(part, int):
            child = rule.get("items")
        else:
            child = rule.get("properties", {}).get(part, rule.get("additionalProperties"))
        if not isinstance(child, Mapping):
            return ""
        rule = _resolve(child, schema)
    return str(rule.get("description", ""))


def _settings(schema: Schema) -> list[str]:
    """Dotted names of all settings that have a fixed place."""

    def walk(rule: Schema, prefix: str) -> Iterator[str]:
        for key, child in _resolve(rule, schema).get("properties", {}).items():
            yield prefix + key
            yield from walk(child, f"{prefix}{key}.")

    return list(walk(schema, ""))
