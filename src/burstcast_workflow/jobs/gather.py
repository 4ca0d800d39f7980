"""Gathering the files of many jobs: each is found by what it says it is, never by its place.

Every NetCDF and JSON file that a job writes carries the job's identity: its rule and the values of
its wildcards.
"""

import json
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from burstcast.netcdf import read_attributes
from burstcast_workflow.canonical import canonical_json
from burstcast_workflow.harness.storage import read_json

Record = Mapping[str, Any]


def identity(path: str | Path) -> dict[str, Any]:
    """Rule and wildcards of the job that wrote a NetCDF or JSON file.

    Raises
    ------
    ValueError
        If the file does not say it.
    """
    if Path(path).suffix == ".json":
        found = read_json(path).get("provenance", {}).get("identity")
    else:
        found = read_attributes(path).get("identity")
    if not isinstance(found, str):
        raise ValueError(f"{path} does not say which job wrote it: remove it, and run again")
    result: dict[str, Any] = json.loads(found)
    return result


def gathered(records: Sequence[Record], paths: Iterable[str | Path]) -> list[tuple[Record, str]]:
    """Pair each record with the one file of its identity.

    Parameters
    ----------
    records
        What is asked for, one for each file: ``identity`` has the values, by name, that a file's
        identity must have. All have the same names.
    paths
        Files, in any order.

    Returns
    -------
    Records, in their order, with their files.

    Raises
    ------
    ValueError
        If something that is asked for has no file, a file is not asked for, or two files or two
        records have the same identity; the message names both sides.
    """
    names = sorted(records[0]["identity"]) if records else []
    wanted = _by_identity(((record["identity"], record) for record in records), names, "asked for")
    found = _by_identity(((identity(path), path) for path in paths), names, "found")
    lacking = [key for key in wanted if key not in found]
    strange = [f"{key} ({path})" for key, path in found.items() if key not in wanted]
    if lacking or strange:
        raise ValueError(
            f"what is asked for and what the files hold differ: asked for and not found: "
            f"{_listed(lacking)}; found and not asked for: {_listed(strange)}"
        )
    return [(record, str(found[key])) for key, record in wanted.items()]


def _by_identity(
    items: Iterable[tuple[Record, Any]], names: Sequence[str], verb: str
) -> dict[str, Any]:
    result: dict[str, Any] = {}
    for record, value in items:
        key = canonical_json({name: record.get(name) for name in names})
        if key in result:
            raise ValueError(f"{key} is {verb} twice: in {result[key]} and in {value}")
        result[key] = value
    return result


def _listed(texts: Sequence[str]) -> str:
    more = f" and {len(texts) - 5} more" if len(texts) > 5 else ""
    return ", ".join(texts[:5]) + more or "nothing"
