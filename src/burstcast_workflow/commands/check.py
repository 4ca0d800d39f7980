"""Checks of classes of one's own: ``burstcast check-system``, ``-forecaster``, ``-controller``."""

import json
import math
import os
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from burstcast.base.discovery import UnsoundError
from burstcast.base.random_streams import stream
from burstcast.control.check import check_controller
from burstcast.control.controller import make_controller
from burstcast.forecasters.check import check_forecaster
from burstcast.forecasters.registry import make_kind
from burstcast.systems.check import check_system
from burstcast.systems.registry import make_system
from burstcast_workflow.tracking.code import make_importable


def main(kind: str, name: str, values: Sequence[str]) -> int:
    """Check a system with parameters (``rho=28``), or another class with options (``lags=3``).

    Prints the report, or what is wrong. Returns 0 if the class keeps to its interface.
    ``kind``: "system", "forecaster" or "controller".
    """
    make_importable([os.fspath(Path.cwd())])
    try:
        if kind == "system":
            parameters = _values(values, "parameter", "rho=28", _number)
            report = check_system(make_system(name, parameters), stream(0, "check system"))
        elif kind == "controller":
            report = check_controller(make_controller(name, _options(values, "level=0.06")))
        else:
            forecaster = make_kind(name, _options(values, "lags=3"))
            report = check_forecaster(forecaster, stream(0, "check forecaster"))
    except UnsoundError as error:
        listed = "\n".join(f"  {problem}" for problem in error.problems)
        message = f"{name} has mistakes:\n{listed}"
    except SystemExit as error:  # of a script that is written to be run, not imported
        message = f"{name} ends the program: SystemExit({error.code!r})"
    except (ValueError, TypeError) as error:
        message = str(error)
    else:
        print(report, end="")
        return 0
    print(message, file=sys.stderr)
    return 1


def _options(texts: Sequence[str], example: str) -> dict[str, Any]:
    """Options by name."""
    return _values(texts, "option", example, _json)


def _values(
    texts: Sequence[str], noun: str, example: str, read: Callable[[str], Any]
) -> dict[str, Any]:
    """Values by name, of texts ``NAME=VALUE``."""
    values: dict[str, Any] = {}
    for text in texts:
        name, equals, value = text.partition("=")
        if name in values:
            raise ValueError(f"{name} is given twice: {' '.join(texts)}")
        try:
            values[name] = read(value)
        except ValueError:
            equals = ""
        if not equals:
            raise ValueError(f"{text} is no {noun}: write NAME=VALUE, such as {example}")
    return values


def _number(text: str) -> float:
    if math.isnan(number := float(text)):
        raise ValueError
    return number


def _json(text: str) -> Any:
    """A number, a list, true, null, or a text."""
    try:
        return json.loads(text)
    except ValueError:
        return text
