"""The cases of a campaign: dynamical systems with their parameters, thresholds and datasets."""

import re
from collections.abc import Mapping
from typing import Any

from burstcast_workflow.canonical import canonical

Config = dict[str, Any]

_REYNOLDS_NAME = re.compile(r"Re(\d+(?:\.\d+)?)")


def case_name(reynolds: float) -> str:
    """Name of the shear flow's case at a Reynolds number: Re400, Re412.5."""
    return f"Re{canonical(reynolds)}"


def block_cases(block: Mapping[str, Any]) -> list[str]:
    """Names of the cases of one block of the campaign, each once."""
    names = [case_name(reynolds) for reynolds in block.get("reynolds", [])]
    return list(dict.fromkeys([*names, *block.get("cases", [])]))


def campaign_cases(config: Mapping[str, Any]) -> list[str]:
    """Names of the cases that the campaign uses, in the order of their first use."""
    return list(dict.fromkeys(name for block in config["campaign"] for name in block_cases(block)))


def case_records(config: Mapping[str, Any]) -> dict[str, Config]:
    """Complete record of each case that the campaign uses, in the order of their first use.

    A record is ``case_defaults`` with the case's own entry laid over it: mappings are merged,
    everything else is replaced. If the entry names another system, the parameters are replaced as a
    whole, those of the actuation, too; without an actuation of its own the case is not controlled.
    A name ``Re<number>`` sets the parameter ``reynolds``.
    """
    return {name: case_record(config, name) for name in campaign_cases(config)}


def case_record(config: Mapping[str, Any], name: str) -> Config:
    """Complete record of one case; see `case_records`."""
    defaults, own = config["case_defaults"], config["cases"].get(name) or {}
    if own.get("system", defaults["system"]) != defaults["system"]:
        # what one system's parameters are changed to means nothing to another system
        actuation = {**defaults["actuation"], "parameters": {}} if defaults["actuation"] else None
        actuation = actuation if own.get("actuation") else None
        defaults = {**defaults, "parameters": {}, "actuation": actuation}
    record = _merged(defaults, own)
    if match := _REYNOLDS_NAME.fullmatch(name):
        # what the entry itself says stays, for the checks to compare
        record["parameters"].setdefault("reynolds", canonical(float(match[1])))
    result: Config = canonical(record, f"cases.{name}")
    return result


def _merged(base: Mapping[str, Any], overlay: Mapping[str, Any]) -> Config:
    """Lay one mapping over another, level by level; neither shares anything with the result."""
    result = {**base, **overlay}
    for key, value in result.items():
        if isinstance(value, Mapping):
            below = base.get(key)
            result[key] = _merged(below if isinstance(below, Mapping) else {}, value)
    return result
