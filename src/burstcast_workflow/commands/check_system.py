"""Check of a dynamical system before a campaign: ``burstcast check-system NAME``."""

from collections.abc import Sequence

from burstcast.base.random_streams import stream
from burstcast.systems.check import check_system
from burstcast.systems.registry import make_system
from burstcast_workflow.commands.checking import checked


def main(system: str, parameters: Sequence[str]) -> int:
    """Check a system with parameters (``rho=28``); 0 if it keeps to the interface."""

    def check(values: dict[str, float]) -> str:
        return check_system(make_system(system, values), stream(0, "check system"))

    return checked(system, "a parameter", parameters, _parameter, check)


def _parameter(text: str) -> tuple[str, float]:
    name, equals, value = text.partition("=")
    try:
        number = float(value)
    except ValueError:
        number = float("nan")
    if not equals or number != number:
        raise ValueError(f"{text} is no parameter: write NAME=VALUE, such as rho=28")
    return name, number
