"""Percentiles of the tables that a job has written."""

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from burstcast.percentiles import percentiles
from burstcast_workflow.harness.tables import read_table, write_table


def write_percentiles(paths: Iterable[str], settings: Mapping[str, Any]) -> None:
    """Write the percentiles over networks of the tables of which they are declared.

    Parameters
    ----------
    paths
        Files of the tables and of the percentiles.
    settings
        Settings of the job.
    """
    files = {Path(path).stem: path for path in paths}
    for name, declared in settings["tables"].items():
        if "percentiles" in declared:
            table = read_table(files[name])
            keys, metrics = (
                [column for column in declared[names] if column in table]
                for names in ("by", "percentiles")
            )
            write_table(files[f"{name}_percentiles"], percentiles(table, keys, metrics))
