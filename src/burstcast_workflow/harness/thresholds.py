"""Event thresholds that the config gives as quantiles: known when the training series are.

In the settings of a job such a threshold is ``{"case": ..., "quantile": ...}``, and the job has the
file of its value as an input. Scripts are given the value.
"""

from collections.abc import Iterator, Mapping
from typing import Any

INPUT = "event_thresholds"
"""Name of the input: files of thresholds."""

_KEYS = {"case", "quantile"}


def cases_of_thresholds(settings: Any) -> Iterator[str]:
    """Cases whose thresholds some settings want, as often as they do."""
    if isinstance(settings, Mapping):
        if set(settings) == _KEYS:
            yield settings["case"]
        for value in settings.values():
            yield from cases_of_thresholds(value)
    elif isinstance(settings, list):
        for value in settings:
            yield from cases_of_thresholds(value)


def with_thresholds(settings: Any, thresholds: Mapping[str, float]) -> Any:
    """Copy settings with the values of thresholds in their places.

    Parameters
    ----------
    settings
        Nested mappings and lists.
    thresholds
        By case.
    """
    if isinstance(settings, Mapping):
        if set(settings) == _KEYS:
            return thresholds[settings["case"]]
        return {key: with_thresholds(value, thresholds) for key, value in settings.items()}
    if isinstance(settings, list):
        return [with_thresholds(value, thresholds) for value in settings]
    return settings
