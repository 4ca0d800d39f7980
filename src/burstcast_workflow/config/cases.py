"""The cases of a campaign: dynamical systems with their parameters, thresholds and datasets."""

import re
from collections.abc import Iterable, Mapping
from typing import Any

from burstcast.systems.base import has_own
from burstcast.systems.registry import module_of, system_class
from burstcast_workflow.canonical import canonical
from burstcast_workflow.config.measured_cases import is_measured, measured_record
from burstcast_workflow.config.model import Case
from burstcast_workflow.config.places import Place

Config = dict[str, Any]

_REYNOLDS_NAME = re.compile(r"Re(\d+(?:\.\d+)?)")


_REALISATION = re.compile(r"(.+)-training([1-9]\d*)")


def realisation_of(name: str) -> tuple[str, int]:
    """Case that a case differs from by its training series only, and which choice of them it has.

    ``Re400-training2`` is the second other choice of ``Re400``; choice 0 is a case's own.
    """
    match = _REALISATION.fullmatch(name)
    return (match[1], int(match[2])) if match else (name, 0)


def case_name(reynolds: float) -> str:
    """Name of the shear flow's case at a Reynolds number: Re400, Re412.5."""
    return f"Re{canonical(reynolds)}"


def block_cases(block: Mapping[str, Any]) -> list[str]:
    """Names of the cases of one block of the campaign, each once.

    With ``realisations``, each is followed by those with other training series.
    """
    names = [case_name(reynolds) for reynolds in block.get("reynolds", [])]
    return [
        f"{name}-training{number}" if number else name
        for name in dict.fromkeys([*names, *block.get("cases", [])])
        for number in range(block.get("realisations", 1))
    ]


def campaign_cases(config: Mapping[str, Any]) -> list[str]:
    """Names of the cases that the campaign uses, in the order of their first use."""
    return list(dict.fromkeys(name for block in config["campaign"] for name in block_cases(block)))


def case_records(config: Mapping[str, Any]) -> dict[str, Config]:
    """Complete record of each case that the campaign uses, in the order of their first use.

    A case of the system of ``case_defaults`` (the shear flow) starts from ``case_defaults``. A case
    of another system starts from what its class says (`DynamicalSystem.case_defaults`), and has of
    ``case_defaults`` only what has no unit of an observable, a state or time: `WITHOUT_UNITS`. The
    case's own entry is laid over that: mappings are merged, everything else is replaced.

    Measured series have records of their own (`burstcast_workflow.config.measured_cases`).

    A name ``Re<number>`` sets the parameter ``reynolds``. A case of other training series
    (`realisation_of`) has the record of the case that they are chosen for.
    """
    return {name: case_record(config, name) for name in campaign_cases(config)}


def case_record(config: Mapping[str, Any], name: str) -> Config:
    """Complete record of one case; see `case_records`."""
    name, _ = realisation_of(name)
    defaults, own = config["case_defaults"], config["cases"].get(name) or {}
    system = own.get("system", defaults["system"])
    if is_measured(own):
        # parts of what is simulated, never of what is measured itself
        entries = {key: one for key, one in config["cases"].items() if not is_measured(one or {})}
        simulated = {**config, "cases": entries}
        base = measured_record(defaults, own["data"], lambda other: case_record(simulated, other))
        record = _merged(base, {key: value for key, value in own.items() if key != "data"})
        _derive(record, draws=False)
    elif system == defaults["system"]:
        record = _merged(defaults, own)
    else:
        said = _merged(said_by_class(system), own)
        shared = _part(defaults, WITHOUT_UNITS)
        if not said.get("actuation"):
            shared["actuation"] = None
        record = {"files": None, **_merged(shared, said)}
        _derive(record, draws=_draws_initial_states(system))
    if not is_measured(own) and (match := _REYNOLDS_NAME.fullmatch(name)):
        # what the entry itself says stays, for the checks to compare
        record["parameters"].setdefault("reynolds", canonical(float(match[1])))
    result: Config = canonical(record, f"cases.{name}")
    return result


WITHOUT_UNITS = (
    "ensemble.series",
    "lyapunov.time_unit",
    "lyapunov.series",
    "lyapunov.perturbation",
    "lyapunov.saturation",
    "training.series",
    "training.noise",
    "density.bins",
    "controlled_density.bins",
    "actuation.start_lt",
    "actuation.duration_lt",
    "test_series",
    "recycle_validation.series",
    "recycle_validation.intervals_per_series",
)
"""What cases of all systems have of ``case_defaults``: counts, shares, and Lyapunov times."""

_SETTLED = 0.01
"""Variation of an observable that has settled, in widths of its density's range."""

_ORTHONORMALISATION_STEPS = 5
"""Steps of a forecast between two QR factorisations."""


def own_modules(config: Mapping[str, Any]) -> dict[str, list[str] | None]:
    """Modules of the user's own that the campaign's systems lie in, and the files that they read.

    The files are None where no case of the module has the setting ``files``.
    """
    found: dict[str, list[str] | None] = {}
    for record in case_records(config).values():
        if ":" in record["system"]:
            module = module_of(record["system"])
            said = [files for files in (found.get(module), record["files"]) if files is not None]
            found[module] = sorted({file for files in said for file in files}) if said else None
    return found


def said_by_class(system: str) -> Config:
    """What the class of a system says of its cases; nothing where there is no such class."""
    try:
        said = system_class(system).case_defaults
    except (ValueError, TypeError):  # told with the case
        return {}
    result: Config = canonical(dict(said), f"case_defaults of the system {system}")
    return result


_INITIAL = ("initial_state", "perturbed_component", "perturbation")


def _draws_initial_states(system: str) -> bool:
    try:
        return has_own(system_class(system), "sample_initial_states")
    except (ValueError, TypeError):  # told with the case
        return False


def _derive(record: Config, *, draws: bool) -> None:
    """Fill in what follows from other settings, where neither class nor entry says it."""
    record.setdefault("parameters", {})
    record.setdefault("laminarisation_threshold", None)
    record.setdefault("data", None)
    lyapunov, ensemble = record["lyapunov"], record["ensemble"]
    lyapunov.setdefault("published_exponent", None)
    if draws and "initial_state" not in ensemble:
        ensemble.update(dict.fromkeys(_INITIAL))
    if "time_step" in ensemble and "sampling_stride" in ensemble:
        interval = ensemble["time_step"] * ensemble["sampling_stride"]
        lyapunov.setdefault("orthonormalisation_interval", _ORTHONORMALISATION_STEPS * interval)
    if record["actuation"] is not None:
        record["actuation"].setdefault("parameters", {})
        record["actuation"].setdefault("force", None)
    if "range" in record["density"]:
        low, high = record["density"]["range"]
        if "controlled_density" in record:
            record["controlled_density"].setdefault("range", [low, high])
        record.setdefault("fixed_point", {"variation": _SETTLED * (high - low), "above": low})


def missing_settings(record: Mapping[str, Any]) -> list[str]:
    """Settings that a case must have and nobody has given, by their paths in a case."""
    missing: list[str] = []
    for place in Place(Case).settings():
        *above, last = place.name.split(".")
        section: Any = record
        for part in above:
            section = section.get(part) if isinstance(section, Mapping) else None
        if isinstance(section, Mapping) and last not in section:
            missing.append(place.name)
    return missing


def _part(settings: Mapping[str, Any], paths: Iterable[str]) -> Config:
    """Copy what lies at some paths, where there is anything."""
    part: Config = {}
    for path in paths:
        *above, last = path.split(".")
        section: Any = settings
        for key in above:
            section = section.get(key) if isinstance(section, Mapping) else None
        if isinstance(section, Mapping) and last in section:
            target = part
            for key in above:
                target = target.setdefault(key, {})
            target[last] = section[last]
    return part


def _merged(base: Mapping[str, Any], overlay: Mapping[str, Any]) -> Config:
    """Lay one mapping over another, level by level; neither shares anything with the result."""
    result = {**base, **overlay}
    for key, value in result.items():
        if isinstance(value, Mapping):
            below = base.get(key)
            result[key] = _merged(below if isinstance(below, Mapping) else {}, value)
    return result
