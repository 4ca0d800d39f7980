"""The cases of a campaign: dynamical systems with their parameters, thresholds and datasets."""

import re
from collections.abc import Mapping
from typing import Any

from burstcast.data.training_realisations import realisation_of
from burstcast.forecasters.registry import kind_module
from burstcast.statistics.densities import SETTLED
from burstcast.systems.base import has_own
from burstcast.systems.registry import system_class
from burstcast_workflow.config.case import Case, Measured, Simulated
from burstcast_workflow.config.measured_cases import measured_record
from burstcast_workflow.config.model import Configuration
from burstcast_workflow.harness.canonical import canonical

Config = dict[str, Any]

_REYNOLDS_NAME = re.compile(r"Re(\d+(?:\.\d+)?)")


def reynolds_in(name: str) -> float | None:
    """Reynolds number in a name such as Re400; None in other names."""
    match = _REYNOLDS_NAME.fullmatch(name)
    return float(match[1]) if match else None


def cases_of(config: Configuration, *, skip_invalid: bool = False) -> dict[str, Case]:
    """Each case that the campaign uses, in the order of their first use (see `case_of`)."""
    make = valid_case if skip_invalid else case_of
    cases = {name: case for name in config.case_names if (case := make(config, name))}
    for name, case in cases.items():
        case.in_campaign(name, cases.get(case.data.case or "") if case.data else None)
    return cases


def case_of(config: Configuration, name: str) -> Case:
    """A case with all of its settings.

    A case of the system of ``case_defaults`` (the shear flow) starts from ``case_defaults``. A case
    of another system starts from what its class says (`DynamicalSystem.case_defaults`), and has of
    ``case_defaults`` only what has no unit of an observable, a state or time: `WITHOUT_UNITS`. The
    case's own entry is laid over that: mappings are merged, everything else is replaced.
    Measured series start from less (`burstcast_workflow.config.measured_cases`).

    A name ``Re<number>`` sets the parameter ``reynolds``. A case of other training series
    (`realisation_of`) has the settings of the case that they are chosen for.
    """
    return kind_of(config, name).model_validate(case_record(config, name))


def kind_of(config: Configuration, name: str) -> type[Case]:
    """Class of a case, which follows from its entry in ``cases``."""
    return Simulated if config.data_of(name) is None else Measured


def valid_case(config: Configuration, name: str) -> Case | None:
    """A case (`case_of`); None if it is invalid, which is reported with the case."""
    try:
        return case_of(config, name)
    except (ValueError, TypeError):
        return None


def case_record(config: Configuration, name: str) -> Config:
    """Settings of a case from all places (`case_of`); some may be missing."""
    name, _ = realisation_of(name)
    defaults, entry, data = config.case_defaults, config.entry_of(name), config.data_of(name)
    system = entry.get("system", defaults.system)
    if data is not None:
        # parts of what is simulated, never of what is measured itself
        simulated = {key: case for key, case in config.cases.items() if case.get("data") is None}
        others = config.model_copy(update={"cases": simulated})
        source = case_record(others, data.case) if data.case else None
        base = measured_record(defaults, entry, source)
        return _derived(_merged(base, {**entry, "data": base["data"]}))
    if system == defaults.system:
        record = _merged(defaults.dump(), entry)
    else:
        settings = _merged(class_defaults(system), entry)
        shared = defaults.model_dump(include=WITHOUT_UNITS)
        if not settings.get("actuation"):
            del shared["actuation"]
        record = _derived(_merged(shared, settings))
    if (reynolds := reynolds_in(name)) is not None:
        # what the entry itself says stays, for the checks to compare
        record.setdefault("parameters", {}).setdefault("reynolds", reynolds)
    return record


WITHOUT_UNITS: Any = {
    "ensemble": {"series"},
    "lyapunov": {"time_unit", "series", "exponents", "perturbation", "saturation"},
    "training": True,
    "density": {"bins"},
    "controlled_density": {"bins"},
    "actuation": {"start_lt", "duration_lt"},
    "test_series": True,
    "recycle_validation": True,
}
"""What cases of all systems have of ``case_defaults``: counts, shares, and Lyapunov times."""

_ORTHONORMALISATION_STEPS = 5
"""Steps of a forecast between two QR factorisations."""


def own_modules(config: Mapping[str, Any]) -> dict[str, list[str] | None]:
    """Modules of the user's own, and the files that they read: None without a setting of them."""
    sound = Configuration.model_validate(config)
    modules: dict[str, list[str] | None] = {
        kind_module(kind): None for block in sound.campaign for kind in block.forecasters.own
    }
    for case in cases_of(sound).values():
        if module := case.own_module:
            files = modules.setdefault(module, None)
            if case.files is not None:
                modules[module] = sorted({*(files or []), *case.files})
    return modules


def class_defaults(system: str) -> Config:
    """Defaults of cases from the class of a system, if there is one; it may draw initial states."""
    try:
        owner = system_class(system)
    except (ValueError, TypeError):  # reported for the case
        return {}
    given = canonical(dict(owner.case_defaults), f"case_defaults of the system {system}")
    drawn = dict.fromkeys(("initial_state", "perturbed_component", "perturbation"))
    return _merged({"ensemble": drawn} if has_own(owner, "sample_initial_states") else {}, given)


def _derived(record: Config) -> Config:
    """A record with what follows from its settings, where neither class nor entry says it."""
    lyapunov, ensemble = record["lyapunov"], record["ensemble"]
    if "time_step" in ensemble and "sampling_stride" in ensemble:
        interval = ensemble["time_step"] * ensemble["sampling_stride"]
        lyapunov.setdefault("orthonormalisation_interval", _ORTHONORMALISATION_STEPS * interval)
    if record["density"].get("range"):
        low, high = record["density"]["range"]
        if "controlled_density" in record:
            record["controlled_density"].setdefault("range", [low, high])
        record.setdefault("fixed_point", {"variation": SETTLED * (high - low), "above": low})
    return record


def _merged(base: Mapping[str, Any], overlay: Mapping[str, Any]) -> Config:
    """Lay one mapping over another, level by level; neither shares anything with the result."""
    result = {**base, **overlay}
    for key, value in result.items():
        if isinstance(value, Mapping):
            below = base.get(key)
            result[key] = _merged(below if isinstance(below, Mapping) else {}, value)
    return result
