"""Draw a figure, whatever it is: its module of `burstcast.figures` declares what it is made of."""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from burstcast.figures.parts.style import render
from burstcast.figures.registry import figure_module
from burstcast.files.netcdf import read_attributes, read_netcdf
from burstcast.files.tables import read_table
from burstcast.forecasters._names import parsed
from burstcast_workflow.harness.job import JobSettings, atomic, job, read_json


def _content(file: str | list[str], variable: str) -> Any:
    """Content of a file, or of each of several; None if there is none."""
    if not file:
        return None
    if not isinstance(file, str):
        return [_content(one, variable) for one in file]
    if variable:
        return read_netcdf(file, variable)[variable]
    return {".csv": read_table, ".json": read_json, ".nc": _arrays}[Path(file).suffix](file)


def _arrays(file: str) -> Mapping[str, Any]:
    """Variables and attributes of a NetCDF file, and whose it is: its wildcards, its network."""
    attributes = read_attributes(file)
    identity = json.loads(str(attributes["identity"]))
    name = parsed(identity.get("forecaster", "none"))
    network = {"neurons": name.neurons, "seed": name.seed}
    return {**attributes, **identity, **network, **read_netcdf(file)}


@job
def figure(*, pdf: str, png: str, settings: JobSettings, **files: str | list[str]) -> None:
    """Read what the figure declares, draw it, and write it as PDF and PNG."""
    module = figure_module(settings.figure)
    inputs = {
        name: _content(file, module.FIGURE.inputs.get(name, "").partition(":")[2])
        for name, file in files.items()
    }
    values = {name: settings.value_of(path) for name, path in module.FIGURE.paths.items()}
    drawn = module.draw(**inputs, **values)
    # both in memory first: a figure that cannot be drawn leaves no file
    for path, content in ((pdf, render(drawn, "pdf")), (png, render(drawn, "png"))):
        with atomic(path) as partial:
            partial.write_bytes(content)
