"""Check of a dynamical system before a campaign: ``burstcast check-system NAME``."""

import os
import sys
from collections.abc import Sequence
from pathlib import Path

from burstcast.random_streams import stream
from burstcast.systems.check import UnsoundSystemError, check_system
from burstcast.systems.registry import make_system
from burstcast_workflow.tracking.code import make_importable


def main(system: str, parameters: Sequence[str]) -> int:
    """Check a system with parameters (``rho=28``); 0 if it keeps to the interface."""
    make_importable([os.fspath(Path.cwd())])
    try:
        pairs = [*map(_parameter, parameters)]
        values = dict(pairs)
        if len(values) < len(pairs):
            raise ValueError(f"a parameter is given twice: {' '.join(parameters)}")
        print(check_system(make_system(system, values), stream(0, "check system")), end="")
    except UnsoundSystemError as error:
        listed = "\n".join(f"  {problem}" for problem in error.problems)
        print(f"{system} has mistakes:\n{listed}", file=sys.stderr)
        return 1
    except SystemExit as error:  # of a script that is written to be run, not imported
        print(f"{system} ends the program: SystemExit({error.code!r})", file=sys.stderr)
        return 1
    except (ValueError, TypeError) as error:
        print(error, file=sys.stderr)
        return 1
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
