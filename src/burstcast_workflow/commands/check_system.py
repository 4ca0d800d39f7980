"""Look at a system before a campaign: ``burstcast check-system NAME``.

In seconds: whether it keeps to the interface, its exponents, and a case to paste into a config.
"""

import os
import re
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import yaml

from burstcast.random_streams import stream
from burstcast.systems.check import SystemCheck, UnsoundSystemError, check_system
from burstcast.systems.registry import make_system
from snaketrust.modules import make_importable


def case_text(system: str, parameters: Mapping[str, float], check: SystemCheck) -> str:
    """A case in YAML, to paste into a config: of ``my.flows:Roessler`` its name is roessler."""
    name = re.sub(r"[^A-Za-z0-9_.-]", "_", system.rpartition(":")[2]).lower()
    of_equations = {"parameters": dict(parameters)} if parameters else {}
    case = {"system": system, **of_equations, **check.case}
    proposed = {"cases": {name if name[:1].isalpha() else f"case_{name}": case}}
    return yaml.safe_dump(_plain(proposed), sort_keys=False, default_flow_style=None, width=90)


def report(system: str, parameters: Mapping[str, float], check: SystemCheck) -> str:
    """Findings in words and numbers, with the proposed case at the end."""
    title = "A case to begin with (what the class says, and proposals for the rest):"
    return f"{check.summary()}\n\n{title}\n\n{case_text(system, parameters, check)}"


def main(system: str, parameters: Sequence[str]) -> int:
    """Check a system that a person names, with parameters (``rho=28``); 0 if nothing is wrong."""
    make_importable([os.fspath(Path.cwd())])
    try:
        values = dict(map(_parameter, parameters))
        check = check_system(make_system(system, values), stream(0, "check system"))
    except UnsoundSystemError as error:
        listed = "\n".join(f"  {problem}" for problem in error.problems)
        print(f"{system} has mistakes:\n{listed}", file=sys.stderr)
        return 1
    except (ValueError, TypeError) as error:
        print(error, file=sys.stderr)
        return 1
    print(report(system, values, check), end="")
    return 0


def _parameter(text: str) -> tuple[str, float]:
    name, equals, value = text.partition("=")
    try:
        number = float(value)
    except ValueError:
        number = float("nan")
    if not equals or number != number:
        raise ValueError(f"{text} is no parameter: write NAME=VALUE, such as rho=28")
    return name, number


def _plain(value: Any) -> Any:
    """Numbers that are whole without a point, as a person writes them."""
    if isinstance(value, Mapping):
        return {key: _plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(item) for item in value]
    return int(value) if isinstance(value, float) and value.is_integer() else value
