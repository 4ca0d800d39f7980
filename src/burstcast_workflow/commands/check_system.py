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
from burstcast.systems.lyapunov import Estimate
from burstcast.systems.registry import make_system
from snaketrust.modules import make_importable


def proposed_case_name(system: str) -> str:
    """Name that a case may have, from that of its system: ``my.flows:Roessler`` is roessler."""
    name = re.sub(r"[^A-Za-z0-9_.-]", "_", system.rpartition(":")[2]).lower()
    return name if name[:1].isalpha() else f"case_{name}"


def proposed_case(
    system: str, parameters: Mapping[str, float], check: SystemCheck
) -> dict[str, Any]:
    """A case as a config has it: ``{"cases": {name: {...}}}``."""
    entry: dict[str, Any] = {"system": system}
    if parameters:
        entry["parameters"] = dict(parameters)
    return {"cases": {proposed_case_name(system): {**entry, **check.case}}}


def case_text(system: str, parameters: Mapping[str, float], check: SystemCheck) -> str:
    """The case in YAML, to paste into a config."""
    proposed = proposed_case(system, parameters, check)
    return yaml.safe_dump(_plain(proposed), sort_keys=False, default_flow_style=None, width=90)


def report(system: str, parameters: Mapping[str, float], check: SystemCheck) -> str:
    """What was found, in words and numbers, with the case at its end."""
    interval = check.time_step * check.sampling_stride
    quantiles = check.observable_quantiles
    lines = [
        f"{check.name}: keeps to the interface",
        f"  integrator             {check.integrator}",
        f"  derivatives            {check.derivatives}",
        f"  leading exponent       {_estimate(check.by_qr)} by QR, "
        f"{_estimate(check.by_growth)} by growth of perturbations",
        f"  exponents              {', '.join(f'{value:.3g}' for value in check.spectrum)}",
        f"  fastest period         {check.fastest_period:.3g} time units",
        f"  time step, sampling    {check.time_step:g}, every {check.sampling_stride} steps "
        f"({interval:g} time units)",
    ]
    if check.verdict == "chaotic":
        lines += [
            f"  Lyapunov time          {1 / float(check.by_qr.mean):.3g} time units, "
            f"{check.steps_per_lyapunov_time:.3g} steps of a forecast"
        ]
    elif check.verdict == "regular":
        lines += ["  no chaos               the leading exponent is below zero: no Lyapunov time"]
    else:
        bound = max(float(check.by_qr.high), float(check.by_growth.high))
        lines += [
            f"  chaos undecided        after {check.duration:.3g} time units, the interval of the "
            "leading exponent",
            "                         holds zero: a Lyapunov time, if there is one, is longer than "
            f"{1 / bound:.3g}",
            "                         time units",
        ]
    lines += [
        f"  observable             {quantiles[0.0]:.3g} to {quantiles[1.0]:.3g}, median "
        f"{quantiles[0.5]:.3g}; quantiles 0.9, 0.95, 0.99: {quantiles[0.9]:.3g}, "
        f"{quantiles[0.95]:.3g}, {quantiles[0.99]:.3g}",
        f"  beyond quantile 0.95   begins {check.events_per_lyapunov_time:.2g} times in a "
        "Lyapunov time",
        "",
        "A case to begin with (what the class says, and proposals for the rest):",
        "",
    ]
    return "\n".join(lines) + "\n" + case_text(system, parameters, check)


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


def _estimate(estimate: Estimate) -> str:
    margin = float(estimate.high - estimate.mean)
    return f"{float(estimate.mean):.4g} +- {margin:.2g}"


def _plain(value: Any) -> Any:
    """Numbers that are whole without a point, as a person writes them."""
    if isinstance(value, Mapping):
        return {key: _plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(item) for item in value]
    return int(value) if isinstance(value, float) and value.is_integer() else value
