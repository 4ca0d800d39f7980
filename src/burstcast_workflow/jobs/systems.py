"""The system of a job's case."""

from collections.abc import Mapping
from typing import Any

from burstcast.systems.base import DynamicalSystem
from burstcast.systems.registry import make_system

Settings = Mapping[str, Any]


def system_of(settings: Settings) -> DynamicalSystem:
    """The dynamical system of a case."""
    return make_system(settings["case.system"], settings["case.parameters"])
