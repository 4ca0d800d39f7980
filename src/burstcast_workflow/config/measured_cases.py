"""Cases whose series were measured: in files, or as a part of what another case's state has."""

import glob
import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from typing import Any

from burstcast.delay_coordinates import delayed_name
from burstcast.forecasters.registry import forecaster_class
from burstcast.measured_data import Quantity
from burstcast.systems.registry import make_system
from burstcast.systems.state_space import MEASURED, StateSpace, component_names, make_measured
from burstcast_workflow.canonical import natural_order

Config = dict[str, Any]
Settings = Mapping[str, Any]

OBSERVABLE = "observable"
"""What another case's observable is called among its columns."""

OFF = "Lyapunov exponents of equations, forecasts by equations, control, velocity profiles"
"""What needs equations."""

_NOTHING_SAID: Config = {
    "files": [],
    "case": None,
    "columns": [],
    "header": None,
    "components": [],
    "delays": [],
    "observable_name": "",
    "observable_symbol": "",
    "time_step": None,
    "time": None,
    "series": None,
    "array": None,
    "axes": [],
    "blocks": None,
}
SUBSTEPS = 4
"""Steps of the Runge-Kutta scheme from one row to the next, for equations that are learnt."""

_MEANINGLESS = ("system", "files", "parameters", "ensemble", "actuation", "controlled_density")


def is_measured(record: Settings) -> bool:
    """Whether a case, or its entry in ``cases``, has measured series instead of equations."""
    return record.get("data") is not None


def measured_record(
    defaults: Settings, said: Settings, record_of: Callable[[str], Settings]
) -> Config:
    """What a case of measured series starts from.

    It has of ``case_defaults`` only what has no unit of an observable or of time, and no noise is
    added to it. Parts of another case's state have that case's thresholds, bins, noise and unit of
    time, and the same series, as long as they are about the same observable.

    Parameters
    ----------
    defaults
        The section ``case_defaults``.
    said
        The section ``data`` of the case.
    record_of
        Makes the record of another case.
    """
    data = {**_NOTHING_SAID, **said}
    data["blocks"] = data["blocks"] and {"gap": 0, **data["blocks"]}
    record: Config = {
        "lyapunov": {"time_unit": defaults["lyapunov"]["time_unit"]},
        "training": {"series": defaults["training"]["series"], "noise": 0},
        "density": {"bins": defaults["density"]["bins"]},
        "test_series": defaults["test_series"],
        "recycle_validation": defaults["recycle_validation"],
    }
    duration = data["blocks"] and data["blocks"].get("duration")
    steps: Config = {"duration": duration}
    if data["time_step"] is not None:
        # a power of two: their product is what was said, to the last bit
        steps |= {"time_step": data["time_step"] / SUBSTEPS, "sampling_stride": SUBSTEPS}
    if data["case"] is not None:
        source = record_of(data["case"])
        whole = source["ensemble"]
        steps = {key: whole.get(key) for key in ("time_step", "sampling_stride", "duration")}
        record |= _of_source(source, data)
    data["components"] = data["components"] or data["columns"]
    names = [Quantity(text).name for text in data["components"]]
    past = [delayed_name(name, delay) for delay in data["delays"] for name in names]
    if steps["duration"] is not None and "time_step" in steps:
        lost = max(data["delays"], default=0) * steps["time_step"] * steps["sampling_stride"]
        steps["duration"] -= lost
    return {
        **record,
        "data": data,
        "system": MEASURED,
        "parameters": {
            "components": [*names, *past],
            "observable_of": data.get("observable"),
            "observable_name": data["observable_name"],
            "observable_symbol": data["observable_symbol"],
        },
        "ensemble": steps,
        "actuation": None,
    }


def _of_source(source: Settings, data: Config) -> Config:
    """What a part of another case's state has of that case; completes the section ``data``."""
    keys = ["training", "test_series", "recycle_validation"]
    data.setdefault("observable", OBSERVABLE)
    space = space_of(source)
    if space is not None:
        data["columns"] = [*component_names(space)]
    if data["observable"] == OBSERVABLE:
        keys += ["event_threshold", "laminarisation_threshold", "density", "fixed_point"]
        if space is not None:
            data["observable_name"] = data["observable_name"] or space.observable_name
            data["observable_symbol"] = data["observable_symbol"] or space.observable_symbol
    of_time = ("time_unit", "published_exponent", "orthonormalisation_interval")
    return {
        **{key: source[key] for key in keys if key in source},
        "lyapunov": {key: source["lyapunov"][key] for key in of_time if key in source["lyapunov"]},
    }


def space_of(record: Settings) -> StateSpace | None:
    """What the states of a case are; None if its record has a mistake."""
    try:
        measured = is_measured(record)
        make = make_measured if measured else partial(make_system, record["system"])
        space = make(record["parameters"])
        return space if space.dimension else None  # it is known once the observable is understood
    except (ValueError, TypeError):  # told with the case
        return None


def data_files(data: Settings) -> list[str]:
    """Files of measured series, in their order: those of a pattern as people sort names.

    Raises
    ------
    ValueError
        If no file is called as a pattern says.
    """
    found: dict[str, None] = {}
    for name in data["files"]:
        paths = [name]
        if glob.has_magic(name):
            paths = sorted(glob.glob(name, recursive=True), key=natural_order)
            if not paths:
                raise ValueError(f"data.files: no file is called {name}, seen from {os.getcwd()}")
        found.update(dict.fromkeys(map(os.path.relpath, paths)))
    return list(found)


def own_problems(own: Settings) -> Iterator[str]:
    """What an entry in ``cases`` must not say of measured series, and what it must."""
    for key in _MEANINGLESS:
        if own.get(key) is not None:
            yield f"{key} means nothing for measured series (data): leave it out"
    data = own["data"]
    if bool(data.get("files")) == (data.get("case") is not None):
        yield "data needs files: [...], or else the name of another case of the campaign (case)"
        return
    if data.get("case") is None:
        for key, meaning in (
            ("observable", "a component, or an expression of columns"),
            ("time_step", "the time between two rows"),
        ):
            if data.get(key) is None:
                yield f"data.{key} is missing: {meaning}"
        if not (data.get("components") or data.get("columns")):
            yield "data.components is missing: the columns that forecasters see"
    else:
        if not data.get("components"):
            yield "data.components is missing: what forecasters see of the other case"
        for key in ("time_step", "time", "series", "array", "axes", "columns", "header", "blocks"):
            if data.get(key) not in (None, []):
                yield f"data.{key} means nothing where the series are those of another case"


def problems_of_delays(record: Settings) -> Iterator[str]:
    """What is wrong with the delays of a case, before what follows from them is looked at."""
    duration = record["ensemble"].get("duration")
    if record["data"]["delays"] and duration is not None and duration <= 0:
        yield (
            f"data.delays reach back by {max(record['data']['delays'])} steps, which is more than "
            f"a series is long"
        )


def problems_of_data(record: Settings) -> Iterator[str]:
    """What is wrong with the data of a case, as far as its record tells."""
    data, parameters = record["data"], record["parameters"]
    source = data["case"]
    names = [Quantity(text).name for text in data["components"]]
    if twice := [one for one in dict.fromkeys(names) if names.count(one) > 1]:
        yield f"data.components has {twice[0]} twice"
    try:
        # the observable is of the present
        appended = make_measured({**parameters, "components": names}).dimension > len(names)
        if source is None:
            data_files(data)
        else:
            for text in [*data["components"], *([data["observable"]] if appended else [])]:
                Quantity(text).columns([*data["columns"], OBSERVABLE])
    except ValueError as error:
        text = str(error)
        yield text if text.startswith("data.") else f"data.components, data.observable: {text}"


def kinds_with_equations(kinds: Sequence[str]) -> list[str]:
    """Kinds of forecasters that need equations, of those that are given."""
    return [kind for kind in kinds if forecaster_class(kind).needs_equations]
