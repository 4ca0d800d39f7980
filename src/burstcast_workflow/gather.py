"""Gathering the files of many jobs: each is found by what it says it is, never by its place.

Every file that a job writes carries the job's identity, its rule and the values of its wildcards: a
NetCDF file as an attribute, a JSON file in its provenance, a table of one job in its key columns.
"""

import json
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from burstcast_workflow.storage import read_attributes, read_json

CASE = ("case",)
"""What tells cases apart."""

NETWORK = ("case", "neurons", "validation", "seed")
"""What tells networks apart."""

Identity = Mapping[str, Any]
Record = Mapping[str, Any]


def identity(path: str | Path) -> Identity:
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
    result: Identity = json.loads(found)
    return result


def gathered(
    records: Iterable[Record], paths: Iterable[str | Path], keys: Sequence[str]
) -> list[tuple[Record, str]]:
    """Pair each record with the one file whose identity has the same keys.

    Parameters
    ----------
    records
        What is asked for, one for each file.
    paths
        Files, in any order.
    keys
        Names that records and identities have in common, and that tell them apart.

    Returns
    -------
    Records, in their order, with their files.

    Raises
    ------
    ValueError
        If something that is asked for has no file, a file is not asked for, or two files or two
        records have the same keys; the message names both sides.
    """
    wanted = _by_key(((record, record) for record in records), keys, "asked for")
    found = _by_key(((identity(path), path) for path in paths), keys, "found")
    lacking = [key for key in wanted if key not in found]
    strange = [key for key in found if key not in wanted]
    if lacking or strange:
        raise ValueError(
            f"what is asked for and what the files hold differ: asked for and not found: "
            f"{_listed(lacking, keys)}; found and not asked for: "
            f"{_listed(strange, keys, found)}"
        )
    return [(record, str(found[key])) for key, record in wanted.items()]


def by_key(
    records: Iterable[Record], paths: Iterable[str | Path], keys: Sequence[str]
) -> dict[Any, str]:
    """Files of `gathered`, by the values of their keys; by the value itself where there is one."""
    return {
        _key(record, keys) if len(keys) > 1 else record[keys[0]]: path
        for record, path in gathered(records, paths, keys)
    }


def _by_key(
    items: Iterable[tuple[Record, Any]], keys: Sequence[str], verb: str
) -> dict[tuple[Any, ...], Any]:
    result: dict[tuple[Any, ...], Any] = {}
    for record, value in items:
        key = _key(record, keys)
        if key in result:
            raise ValueError(
                f"{_listed([key], keys)} is {verb} twice: in {result[key]} and in {value}"
            )
        result[key] = value
    return result


def _key(record: Record, keys: Sequence[str]) -> tuple[Any, ...]:
    # what does not apply, a size to the equations, is absent in an identity
    return tuple(record.get(name) for name in keys)


def _listed(
    found: Sequence[tuple[Any, ...]],
    keys: Sequence[str],
    paths: Mapping[tuple[Any, ...], str | Path] | None = None,
) -> str:
    """What keys stand for, in words; nothing for no key."""
    texts = []
    for values in found[:5]:
        named = dict(zip(keys, values, strict=True))  # one tuple and the names of its values
        text = ", ".join(f"{name} {value}" for name, value in named.items() if value is not None)
        texts.append(f"{text} ({paths[values]})" if paths else text)
    more = f" and {len(found) - 5} more" if len(found) > 5 else ""
    return "; ".join(texts) + more or "nothing"
