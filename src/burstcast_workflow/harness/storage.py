"""Files of the workflow: NetCDF, tables, JSON and text, written completely or not at all.

A job whose results directory a newer run has claimed writes nothing. NetCDF files are read with
`burstcast.base.files.netcdf`, tables with `burstcast.base.files.tables`.
"""

import json
from collections.abc import Mapping
from contextlib import AbstractContextManager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from burstcast.base.files import atomic_files
from burstcast_workflow.tracking.run import check_ownership

if TYPE_CHECKING:
    import pandas as pd

    from burstcast.base.files.netcdf import Variable


def atomic(path: str | Path) -> AbstractContextManager[Path]:
    """Temporary path that becomes ``path`` at the end (`burstcast.base.files.atomic_files`)."""
    return atomic_files.atomic(path, check_ownership)


def write_netcdf(
    path: str | Path,
    variables: Mapping[str, "Variable"],
    attributes: Mapping[str, str | int | float],
) -> None:
    """Write a NetCDF file (`burstcast.base.files.netcdf.write_netcdf`)."""
    from burstcast.base.files import (
        netcdf,  # planning and jobs of tables write none: it is slow to load
    )

    netcdf.write_netcdf(path, variables, attributes, check_ownership)


def write_table(path: str | Path, table: "pd.DataFrame") -> "pd.DataFrame":
    """Write a table; return it as it is read (`burstcast.base.files.tables.write_table`)."""
    from burstcast.base.files import tables  # pandas is slow to load, too

    return tables.write_table(path, table, check_ownership)


def write_text(path: str | Path, text: str) -> None:
    """Write text in UTF-8, with line ends as they are."""
    with atomic(path) as partial:
        partial.write_bytes(text.encode())


def write_json(path: str | Path, record: Any, provenance: Mapping[str, str] | None = None) -> None:
    """Write plain data as JSON with sorted keys; what is undefined must be given as None.

    The record is a mapping if there is a provenance, which goes beside its entries.
    """
    if provenance is not None:
        record = {**record, "provenance": provenance}
    try:
        text = json.dumps(record, sort_keys=True, indent=2, ensure_ascii=False, allow_nan=False)
    except (TypeError, ValueError) as error:
        raise type(error)(f"{path}: {error}") from error
    write_text(path, text + "\n")


def read_json(path: str | Path) -> Any:
    """Read a JSON file."""
    try:
        return json.loads(Path(path).read_bytes())
    except ValueError as error:
        raise ValueError(f"{path} is no JSON: {error}") from error
