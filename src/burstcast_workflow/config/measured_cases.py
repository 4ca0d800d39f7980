"""Cases whose series were measured: in files, or as a part of what another case's state has."""

import os
from collections.abc import Iterator, Mapping
from contextlib import suppress
from functools import cache
from typing import Any

import numpy as np

from burstcast.data.delay_coordinates import delayed_name
from burstcast.data.encoders.base import EncodingCase
from burstcast.data.encoders.channels import IDENTITY, channel_names, check_encoding, encoding_case
from burstcast.data.measured_data import Quantity
from burstcast.data.no_state import columns_of_no_state
from burstcast.data.records import problems_of_columns
from burstcast.data.series_files import content_of
from burstcast.data.times import time_step_of
from burstcast.systems.registry import make_space
from burstcast.systems.state_space import MEASURED, StateSpace, component_names, make_measured
from burstcast_workflow.config.case import Case, CaseEncoder, Data, Measured, Sensors, Simulated
from burstcast_workflow.harness.canonical import canonical

Config = dict[str, Any]
OBSERVABLE = "observable"
"""What another case's observable is called among its columns."""

OFF = """Lyapunov exponents of equations, forecasts by equations, control, velocity profiles, \
long runs of forecasters that learn from data.known"""
"""What needs equations, or columns that are known in advance beyond the end of a record."""

SUBSTEPS = 4
"""Steps of the Runge-Kutta scheme from one row to the next, for equations that are learnt."""

ONLY_ENCODED = "sensors and encoder are for cases of another case's series: data: {case: ...}"

_READ_IN_PLANNING = 20_000_000
"""Bytes of files up to which planning reads their columns."""

_MEANINGLESS = ("system", "files", "parameters", "ensemble", "actuation", "controlled_density")
_OF_CASES = ("components", "delays", "observable")
_STEPS = ("time_step", "sampling_stride", "duration")
_OF_SOURCE = ("training", "test_series", "recycle_validation")
_OF_OBSERVABLE = ("event_threshold", "laminarisation_threshold", "density", "fixed_point")
_OF_TIME = ("time_unit", "given_exponent", "orthonormalisation_interval")
_WITHOUT_UNITS: Any = {
    "lyapunov": {"time_unit"},
    "training": {"series"},
    "density": {"bins"},
    "recycle_validation": {"series"},
}


def measured_record(defaults: Simulated, entry: Config, source: Mapping[str, Any] | None) -> Config:
    """Defaults of a case of measured series.

    It has of ``case_defaults`` only what has no unit of an observable or of time, and no noise is
    added to it. Parts of another case's state have that case's thresholds, bins, noise and unit of
    time, and the same series, as long as they are about the same observable.

    ``entry``: The entry in ``cases``, with a section ``data``. ``source``: Settings of the case
    whose state the series are seen of; None for series in files.
    """
    section, data = Data.model_validate(entry["data"]), canonical(entry["data"])
    data["components"] = section.components or _components(section)
    names = [Quantity(text).name for text in data["components"]]
    record: Config = defaults.model_dump(include=_WITHOUT_UNITS)
    record["training"]["noise"] = 0.0
    record["recycle_validation"]["intervals_per_series"] = None  # as many as fit
    if source is None:
        steps, observable = _own_steps(section), _own_observable(section)
    else:
        data.setdefault("observable", OBSERVABLE)
        space = space_of(source)
        if space is not None:
            data["columns"] = [*component_names(space)]
        is_same = data["observable"] == OBSERVABLE
        steps = {key: source["ensemble"].get(key) for key in _STEPS}
        observable = _named(space) if is_same and space is not None else _own_observable(section)
        record |= _of_source(source, is_same)
        if is_encoded(entry):
            with suppress(ValueError, TypeError):  # reported by `problems_of_encoding`
                names = [*channel_names(*_encoding_of(entry, source))]
    if steps["duration"] is not None and "time_step" in steps:
        lost = max(section.delays, default=0) * steps["time_step"] * steps["sampling_stride"]
        steps["duration"] -= lost
    past = [delayed_name(name, delay) for delay in section.delays for name in names]
    of = data.get("observable")
    return {
        **record,
        "data": data,
        "system": MEASURED,
        "parameters": {
            "components": [*names, *past],
            "observable_of": of and Quantity(of).source,
            **observable,
        },
        "ensemble": steps,
    }


def _components(section: Data) -> list[str]:
    """All columns of the first file but the times, and what is known in advance."""
    in_advance = {Quantity(text).source for text in section.known}
    return [name for name in _columns(section) if name not in in_advance]


def _own_steps(section: Data) -> Config:
    """Steps of series in files, as far as the config knows them."""
    steps: Config = {"duration": section.blocks and section.blocks.duration}
    if section.time_step is not None:
        # a power of two: their product is the given step, to the last bit
        step, _ = time_step_of(section.time_step)
        steps |= {"time_step": step / SUBSTEPS, "sampling_stride": SUBSTEPS}
    return steps


def _own_observable(section: Data) -> Config:
    """Name of an observable that the config gives one."""
    is_named = section.observable and "=" in section.observable
    name = Quantity(section.observable).name if section.observable and is_named else ""
    return {"observable_name": name, "observable_symbol": ""}


def _named(space: StateSpace) -> Config:
    """Names of the observable of a state."""
    return {
        "observable_name": space.observable_name,
        "observable_symbol": space.observable_symbol,
    }


def _of_source(source: Mapping[str, Any], same_observable: bool) -> Config:
    """Settings of another case that series of its state have, too."""
    keys = (*_OF_SOURCE, *(_OF_OBSERVABLE if same_observable else ()))
    lyapunov = source["lyapunov"]
    return {
        **{key: source[key] for key in keys if key in source},
        "lyapunov": {key: lyapunov[key] for key in _OF_TIME if key in lyapunov},
    }


def is_encoded(entry: Config) -> bool:
    """Whether an entry of ``cases`` has sensors or an encoder (`Case.is_encoded`)."""
    return entry.get("sensors") is not None or entry.get("encoder") is not None


def _encoding_of(entry: Config, source: Mapping[str, Any]) -> tuple[str, EncodingCase]:
    """Kind of the encoder of an entry of ``cases``, and its inputs from the source's state."""
    space = make_space(source["system"], source.get("parameters", {}))
    probes, encoder = entry.get("sensors"), entry.get("encoder")
    if probes is not None:
        probes = Sensors.model_validate(probes).model_dump()
    kind = CaseEncoder.model_validate({"kind": IDENTITY} if encoder is None else encoder)
    options = kind.model_dump(exclude={"kind"}, exclude_none=True)
    return kind.kind, encoding_case(space, probes, options)


def _columns(data: Data) -> list[str]:
    """Columns of the first file but its times; none where it cannot be read."""
    with suppress(ValueError):  # reported by `problems_of_data`
        if data.files and os.path.exists(path := data.paths[0]):
            return _columns_at(path, os.stat(path).st_mtime_ns)
    return []


@cache
def _columns_at(path: str, changed: int) -> list[str]:
    return content_of(path).names


def space_of(record: Mapping[str, Any]) -> StateSpace | None:
    """State space of the settings of a case; None if they are invalid."""
    with suppress(ValueError, TypeError):  # reported for the case
        space = make_space(record["system"], record.get("parameters", {}))
        if space.dimension:  # it is known once the observable is understood
            return space
    return None


def problems_of_entry(entry: Config, data: Data) -> Iterator[str]:
    """Forbidden and required settings of measured series in ``cases``."""
    if bool(data.files) == (data.case is not None):
        yield "data needs files: [...], or else the name of another case of the campaign (case)"
        return
    for key in _MEANINGLESS:
        # an encoder of one's own may read files
        if entry.get(key) is not None and not (key == "files" and is_encoded(entry)):
            yield f"{key} means nothing for measured series (data): leave it out"
    if data.case is None:
        if is_encoded(entry):
            yield ONLY_ENCODED
        if data.observable is None:
            yield "data.observable is missing: a component, or an expression of columns"
        if data.time_step is None:
            yield "data.time_step is missing: the time between two rows"
        if data.gaps and not data.blocks:
            yield (
                "data.gaps needs data.blocks beside it: the duration of series, or the length of "
                "the shortest part between gaps that is one (shortest)"
            )
        if (blocks := data.blocks) and not (blocks.duration or blocks.shortest):
            yield "data.blocks needs a duration, or the length of the shortest series (shortest)"
        if blocks and blocks.duration and (blocks.shortest or 0) > blocks.duration:
            yield "data.blocks.shortest is longer than data.blocks.duration"
        return
    if not (is_encoded(entry) or data.components):
        yield "data.components is missing: what forecasters see of the other case"
    for key, value in data:
        if value in (None, []) or key == "case":
            continue
        if key not in _OF_CASES:
            yield f"data.{key} means nothing where the series come from another case"
        elif is_encoded(entry):
            yield (
                f"data.{key} means nothing beside sensors or an encoder, which see the whole "
                "state, and its observable beside them: leave it out"
            )


def problems_of_encoding(case: Measured, source: Case | None) -> Iterator[str]:
    """Mistakes in the sensors and the encoder of a case; none if its source is invalid."""
    if source is None or space_of(vars(source)) is None:
        return
    steps, training = case.ensemble, case.training
    snapshots = training.series * (round((steps.duration or 0.0) / steps.sampling_interval) + 1)
    try:
        check_encoding(*_encoding_of(case.dump(), source.dump()), training.noise, snapshots)
    except (ValueError, TypeError) as error:
        yield f"sensors, encoder: {error}"


def problems_of_data(case: Measured) -> Iterator[str]:
    """Mistakes in the data of a case that its settings and the headers of its files show."""
    if case.is_encoded:
        return
    data = case.data
    names = [Quantity(text).name for text in data.components]
    if twice := [name for name in dict.fromkeys(names) if names.count(name) > 1]:
        yield f"data.components has {twice[0]} twice"
    try:
        # the observable is of the present
        appended = make_measured({**case.parameters, "components": names}).dimension > len(names)
        quantities = [Quantity(text) for text in (*data.components, *[data.observable] * appended)]
        for quantity in quantities if data.case else ():
            quantity.columns([*data.columns, OBSERVABLE])
    except ValueError as error:
        yield f"data.components, data.observable: {error}"
        return
    if data.case is not None:
        return
    yield from (f"data.{text}" for text in problems_of_columns(data.dump(), _columns(data)))
    try:
        columns = [content_of(path).columns_of(quantities) for path in data.paths]
    except ValueError as error:
        text = str(error)
        yield text if text.startswith("data.") else f"data.files: {text}"
        return
    stated = tuple(dict.fromkeys(name for names in columns for name in names))
    with suppress(ValueError, TypeError, OSError):  # reported by the job that imports the data
        changed = tuple(os.stat(path).st_mtime_ns for path in data.paths)
        for name, what in _no_state(tuple(data.paths), changed, stated, data.time_step):
            yield (
                f"data.components: {name} is {what}, which is no component of a state: leave it "
                f"out of data.components"
            )


@cache
def _no_state(
    paths: tuple[str, ...],
    changed: tuple[int, ...],
    columns: tuple[str, ...],
    time_step: float | str,
) -> list[tuple[str, str]]:
    """Columns of files that are no components of a state, and what they are; of small files."""
    if sum(os.path.getsize(path) for path in paths) > _READ_IN_PLANNING:
        return []
    _, unit = time_step_of(time_step)
    runs = [run for path in paths for run in content_of(path).read(columns, unit)]
    series = [np.stack([run.columns[name] for name in columns], axis=1) for run in runs]
    found = columns_of_no_state(columns, series)
    return [
        *((name, "constant in each run, as the number of a run is") for name in found.constant),
        *(
            (name, "rising or falling in equal steps, as a time or a row number is")
            for name in found.counting
        ),
    ]
