"""Check of a forecaster before a campaign: ``burstcast check-forecaster NAME``."""

import json
from collections.abc import Sequence
from typing import Any

from burstcast.base.random_streams import stream
from burstcast.forecasters.check import check_forecaster
from burstcast.forecasters.registry import make_kind
from burstcast_workflow.commands.checking import checked


def main(forecaster: str, options: Sequence[str]) -> int:
    """Check a forecaster with options (``lags=3``); 0 if it keeps to the interface."""

    def check(values: dict[str, Any]) -> str:
        return check_forecaster(make_kind(forecaster, values), stream(0, "check forecaster"))

    return checked(forecaster, "an option", options, _option, check)


def _option(text: str) -> tuple[str, Any]:
    """Name and value of an option: a number, a list, true, null, or a text."""
    name, equals, value = text.partition("=")
    if not equals:
        raise ValueError(f"{text} is no option: write NAME=VALUE, such as lags=3")
    try:
        return name, json.loads(value)
    except ValueError:
        return name, value
