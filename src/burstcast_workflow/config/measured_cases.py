"""Cases whose series were measured: in files, or as a part of what another case's state has."""

import os
from collections.abc import Callable, Iterator, Mapping
from functools import cache
from typing import Any

from burstcast.data.delay_coordinates import delayed_name
from burstcast.data.encoders.base import EncodingCase
from burstcast.data.encoders.channels import IDENTITY, channel_names, check_encoding, encoding_case
from burstcast.data.measured_data import Quantity
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

_MEANINGLESS = ("system", "files", "parameters", "ensemble", "actuation", "controlled_density")
_OF_CASES = ("case", "components", "delays", "observable")
_WITHOUT_UNITS: Any = {
    "lyapunov": {"time_unit"},
    "training": {"series"},
    "density": {"bins"},
    "recycle_validation": {"series"},
}


def measured_record(
    defaults: Simulated, own: Config, record_of: Callable[[str], Mapping[str, Any]]
) -> Config:
    """Defaults of a case of measured series.

    It has of ``case_defaults`` only what has no unit of an observable or of time, and no noise is
    added to it. Parts of another case's state have that case's thresholds, bins, noise and unit of
    time, and the same series, as long as they are about the same observable.

    ``own``: The entry in ``cases``, with a section ``data``.
    """
    said = Data.model_validate(own["data"])
    data = canonical(own["data"])
    record: Config = defaults.model_dump(include=_WITHOUT_UNITS)
    record["training"]["noise"] = 0.0
    record["recycle_validation"]["intervals_per_series"] = None  # as many as fit
    steps: Config = {"duration": said.blocks and said.blocks.duration}
    written = said.observable or ""
    names_of_observable = Quantity(written).name if "=" in written else "", ""
    if said.time_step is not None:
        # a power of two: their product is what was said, to the last bit
        step, _ = time_step_of(said.time_step)
        steps |= {"time_step": step / SUBSTEPS, "sampling_stride": SUBSTEPS}
    if said.case is not None:
        source = record_of(said.case)
        whole = source["ensemble"]
        steps = {key: whole.get(key) for key in ("time_step", "sampling_stride", "duration")}
        record |= _of_source(source, data)
        if data["observable"] == OBSERVABLE and (space := space_named(source)) is not None:
            names_of_observable = space.observable_name, space.observable_symbol
    data["components"] = said.components or _seen_of_files(said)
    names = [Quantity(text).name for text in data["components"]]
    if is_encoded(own) and said.case is not None:
        names = _channels(*encoding_parts(own), source)
    observable = data.get("observable")
    past = [delayed_name(name, delay) for delay in said.delays for name in names]
    if steps["duration"] is not None and "time_step" in steps:
        lost = max(said.delays, default=0) * steps["time_step"] * steps["sampling_stride"]
        steps["duration"] -= lost
    return {
        **record,
        "data": data,
        "system": MEASURED,
        "parameters": {
            "components": [*names, *past],
            "observable_of": observable and Quantity(observable).source,
            "observable_name": names_of_observable[0],
            "observable_symbol": names_of_observable[1],
        },
        "ensemble": steps,
    }


def is_encoded(own: Config) -> bool:
    """Whether an entry of ``cases`` has sensors or an encoder (`Case.is_encoded`)."""
    return own.get("sensors") is not None or own.get("encoder") is not None


def encoding_parts(own: Config) -> tuple[Sensors | None, CaseEncoder | None]:
    """Sensors and encoder of an entry of ``cases``."""
    sensors, encoder = own.get("sensors"), own.get("encoder")
    return (
        None if sensors is None else Sensors.model_validate(sensors),
        None if encoder is None else CaseEncoder.model_validate(encoder),
    )


def encoding_of(
    sensors: Sensors | None, encoder: CaseEncoder | None, source: Mapping[str, Any]
) -> tuple[str, EncodingCase]:
    """Kind of the encoder of a case, and its inputs.

    ``source``: System and parameters of the case that it is encoded from.
    """
    space = make_space(source["system"], source.get("parameters", {}))
    probes = sensors.model_dump() if sensors else None
    options = encoder.model_dump(exclude_none=True) if encoder else {}
    return options.pop("kind", IDENTITY), encoding_case(space, probes, options)


def _channels(*encoding: Any) -> list[str]:
    """Names of the channels of an encoded case (`encoding_of`); none where there is a mistake."""
    try:
        return [*channel_names(*encoding_of(*encoding))]
    except (ValueError, TypeError):  # reported by `problems_of_encoding`
        return []


def _seen_of_files(data: Data) -> list[str]:
    """Columns of the first file but what is known in advance; none where it cannot be read."""
    known = {Quantity(text).source for text in data.known}
    return [name for name in _columns(data) if name not in known]


def _columns(data: Data) -> list[str]:
    try:
        return columns_of(data.paths[0]) if data.files else []
    except ValueError:  # told by `_problems_of_files`
        return []


def columns_of(path: str) -> list[str]:
    """Columns of a file but its times, read again when it has changed."""
    changed = os.stat(path).st_mtime_ns if os.path.exists(path) else None
    return _columns_at(path, changed)


@cache
def _columns_at(path: str, changed: int | None) -> list[str]:
    return content_of(path).names


def _of_source(source: Mapping[str, Any], data: Config) -> Config:
    """Settings that a part of another case's state takes from that case; completes ``data``."""
    keys = ["training", "test_series", "recycle_validation"]
    data.setdefault("observable", OBSERVABLE)
    space = space_named(source)
    if space is not None:
        data["columns"] = [*component_names(space)]
    if data["observable"] == OBSERVABLE:
        keys += ["event_threshold", "laminarisation_threshold", "density", "fixed_point"]
    of_time = ("time_unit", "published_exponent", "orthonormalisation_interval")
    return {
        **{key: source[key] for key in keys if key in source},
        "lyapunov": {key: source["lyapunov"][key] for key in of_time if key in source["lyapunov"]},
    }


def space_of(case: Case) -> StateSpace | None:
    """State space of a case; None if the case is invalid."""
    return space_named({"system": case.system, "parameters": case.parameters})


def space_named(record: Mapping[str, Any]) -> StateSpace | None:
    """State space of the settings of a case; None if they are invalid."""
    try:
        space = make_space(record["system"], record.get("parameters", {}))
        return space if space.dimension else None  # it is known once the observable is understood
    except (ValueError, TypeError):  # reported for the case
        return None


def own_problems(own: Config) -> Iterator[str]:
    """Forbidden and required settings of measured series in ``cases``."""
    data = Data.model_validate(own["data"])
    if bool(data.files) == (data.case is not None):
        yield "data needs files: [...], or else the name of another case of the campaign (case)"
        return
    for key in _MEANINGLESS:
        # an encoder of one's own may read files
        if own.get(key) is not None and not (key == "files" and is_encoded(own)):
            yield f"{key} means nothing for measured series (data): leave it out"
    if data.case is None:
        if is_encoded(own):
            yield ONLY_ENCODED
        for key, meaning in (
            ("observable", "a component, or an expression of columns"),
            ("time_step", "the time between two rows"),
        ):
            if getattr(data, key) is None:
                yield f"data.{key} is missing: {meaning}"
        if data.gaps and not data.blocks:
            yield (
                "data.gaps needs data.blocks beside it: the duration of series, or the length of "
                "the shortest part between gaps that is one (shortest)"
            )
        if (blocks := data.blocks) and not (blocks.duration or blocks.shortest):
            yield "data.blocks needs a duration, or the length of the shortest series (shortest)"
        if blocks and blocks.duration and (blocks.shortest or 0) > blocks.duration:
            yield "data.blocks.shortest is longer than data.blocks.duration"
    else:
        if is_encoded(own):
            for key in ("components", "delays", "observable"):
                if getattr(data, key) not in (None, []):
                    yield (
                        f"data.{key} means nothing beside sensors or an encoder, which see the "
                        "whole state, and its observable beside them: leave it out"
                    )
        elif not data.components:
            yield "data.components is missing: what forecasters see of the other case"
        for key, value in data:
            if key not in _OF_CASES and value not in (None, []):
                yield f"data.{key} means nothing where the series come from another case"


def problems_of_encoding(case: Measured, source: Case | None) -> Iterator[str]:
    """Mistakes in the sensors and the encoder of a case; none if its source is invalid."""
    if source is None or space_of(source) is None:
        return
    steps, training = case.ensemble, case.training
    snapshots = training.series * (round((steps.duration or 0.0) / steps.sampling_interval) + 1)
    try:
        encoding = encoding_of(case.sensors, case.encoder, source.dump())
        check_encoding(*encoding, training.noise, snapshots)
    except (ValueError, TypeError) as error:
        yield f"sensors, encoder: {error}"


def problems_of_data(case: Measured) -> Iterator[str]:
    """Mistakes in the data of a case that its settings and the headers of its files show."""
    if case.is_encoded:
        return
    data = case.data
    names = [Quantity(text).name for text in data.components]
    if twice := [one for one in dict.fromkeys(names) if names.count(one) > 1]:
        yield f"data.components has {twice[0]} twice"
    try:
        # the observable is of the present
        appended = make_measured({**case.parameters, "components": names}).dimension > len(names)
    except ValueError as error:
        yield f"data.components, data.observable: {error}"
        return
    quantities = [Quantity(text) for text in (*data.components, *[data.observable] * appended)]
    if data.case is not None:
        try:
            for one in quantities:
                one.columns([*data.columns, OBSERVABLE])
        except ValueError as error:
            yield f"data.components, data.observable: {error}"
        return
    yield from (f"data.{one}" for one in problems_of_columns(data.dump(), _columns(data)))
    try:
        for path in data.paths:
            content_of(path).columns_of(quantities)
    except ValueError as error:
        text = str(error)
        yield text if text.startswith("data.") else f"data.files: {text}"
