"""Check of a forecaster before a campaign: ``burstcast check-forecaster NAME``."""

import json
import os
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from burstcast.forecasters.check import UnsoundForecasterError, check_forecaster
from burstcast.forecasters.registry import make_kind
from burstcast.random_streams import stream
from burstcast_workflow.tracking.code import make_importable


def main(forecaster: str, options: Sequence[str]) -> int:
    """Check a forecaster with options (``lags=3``); 0 if it keeps to the interface."""
    make_importable([os.fspath(Path.cwd())])
    try:
        unfitted = make_kind(forecaster, dict(map(_option, options)))
        print(check_forecaster(unfitted, stream(0, "check forecaster")), end="")
    except UnsoundForecasterError as error:
        listed = "\n".join(f"  {problem}" for problem in error.problems)
        print(f"{forecaster} has mistakes:\n{listed}", file=sys.stderr)
        return 1
    except (ValueError, TypeError) as error:
        print(error, file=sys.stderr)
        return 1
    return 0


def _option(text: str) -> tuple[str, Any]:
    """Name and value of an option: a number, a list, true, null, or a text."""
    name, equals, value = text.partition("=")
    if not equals:
        raise ValueError(f"{text} is no option: write NAME=VALUE, such as lags=3")
    try:
        return name, json.loads(value)
    except ValueError:
        return name, value
