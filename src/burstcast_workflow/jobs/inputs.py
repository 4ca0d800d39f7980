"""Contents of the files that figures and tables declare."""

import json
from typing import Any

from burstcast.base.declared import File
from burstcast.base.files.netcdf import read_attributes, read_netcdf, variable_names
from burstcast.base.files.tables import read_table
from burstcast.base.names import parsed
from burstcast_workflow.harness.storage import read_json


def content_of(path: str | list[str], file: File) -> Any:
    """Content of a declared file, or of each of several; None if there is none."""
    if not path:
        return None
    if not isinstance(path, str):
        return [content_of(each, file) for each in path]
    if file.part == "path":
        return path
    if file.part and path.endswith(".json"):
        return read_json(path)[file.part]
    if file.part:
        return read_netcdf(path, file.part)[file.part]
    return content(path, file.variables)


def content(path: str, variables: str = "") -> Any:
    """Content of a file: a table, or a mapping of what a JSON file or a NetCDF file has.

    Of a NetCDF file, attributes, the wildcards of its job, the size and seed of its network, and
    variables: all, or the named ones; those whose name ends in an asterisk if the file has them.
    """
    if path.endswith(".csv"):
        return read_table(path)
    if path.endswith(".json"):
        return {name: value for name, value in read_json(path).items() if name != "provenance"}
    names = variables.split()
    if "*" in variables:
        there = variable_names(path)
        names = [name.rstrip("*") for name in names if name[-1] != "*" or name[:-1] in there]
    attributes = read_attributes(path)
    identity = json.loads(str(attributes.get("identity", "{}")))
    name = parsed(identity.get("forecaster", "none"))
    network = {"neurons": name.neurons, "seed": name.seed}
    return {**attributes, **identity, **network, **read_netcdf(path, *names)}
