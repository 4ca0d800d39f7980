"""Settings of strategies as parts of names, as columns of tables and as words."""

import re
from collections.abc import Mapping
from typing import Any


def is_option(value: Any) -> bool:
    """Whether a value of a setting is a truth value, text or a list rather than a number."""
    return isinstance(value, bool | str | list | tuple)


def named(value: Any) -> str:
    """Value as a part of a name; other characters than A-Z, a-z, 0-9, . + - become their codes.

    Examples
    --------
    >>> named("-a2"), named((0, 0.25)), named(0.5), named("a1*a2"), named("θ")
    ('-a2', '0+0.25', '0.5', 'a1_2aa2', '_u0003b8')
    """
    if isinstance(value, tuple | list):
        return "+".join(map(named, value))
    whole = isinstance(value, float) and value.is_integer()
    text = str(int(value) if whole else value)
    return re.sub(r"[^A-Za-z0-9.+-]", lambda match: _code(ord(match[0])), text)


def _code(number: int) -> str:
    return f"_{number:02x}" if number < 256 else f"_u{number:06x}"


def as_columns(settings: Mapping[str, Any]) -> dict[str, Any]:
    """Settings of a strategy as columns: numbers by name, all others in one, ``options``.

    Examples
    --------
    >>> as_columns({"horizon_lt": 3, "aware": True})
    {'horizon_lt': 3, 'options': 'aware=True'}
    """
    numbers = {name: value for name, value in settings.items() if not is_option(value)}
    others = [f"{name}={named(value)}" for name, value in settings.items() if is_option(value)]
    return {**numbers, "options": " ".join(others)} if others else numbers


def options_in(column: str) -> dict[str, str]:
    """Options by name from the column ``options`` of `as_columns`, their characters put back.

    Examples
    --------
    >>> options_in("watch=-modulus_5f1_5f0 aware=True")
    {'watch': '-modulus_1_0', 'aware': 'True'}
    """
    code = r"_(?:u([0-9a-f]{6})|([0-9a-f]{2}))"
    options = {}
    for option in column.split():
        name, _, value = option.partition("=")
        options[name] = re.sub(code, lambda match: chr(int(match[1] or match[2], 16)), value)
    return options


_OPTION_VERBS = {"watch": "on"}


def option_words(column: str) -> str:
    """Words for options of a strategy, from the column ``options`` of `as_columns`.

    Examples
    --------
    >>> option_words("watch=a1 push=a2"), option_words("aware=True reversible=False")
    ('on a1, push a2', 'aware')
    >>> option_words("watch=-modulus_5f1_5f0")
    'on -modulus_1_0'
    """
    words = []
    for name, value in options_in(column).items():
        text = _OPTION_VERBS.get(name, name.replace("_", " "))
        if value != "False":
            words.append(text if value == "True" else f"{text} {value}")
    return ", ".join(words)
