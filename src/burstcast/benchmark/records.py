"""Measured records of the benchmark, read from packages that hold them.

A package is found, not imported: what it needs itself is not needed.
"""

import csv
import gzip
from importlib.metadata import PackageNotFoundError, distribution
from pathlib import Path

import numpy as np

from burstcast.arrays import FloatArray
from burstcast.data.measured_data import Blocks, Quantity, Run, series_of_runs
from burstcast.data.records import Record, Timing, long_runs, runs_without_gaps
from burstcast.data.time_stamps import TimeStamps
from burstcast.systems.measured import MeasuredSeries

GLUCOSE_BLOCK = 144
"""Samples of a series of glucose: twelve hours."""
GLUCOSE = MeasuredSeries(("glucose", "current"), "-glucose")
"""What a state is: glucose in mg/dl and the current of the sensor in nA."""
_TIMING = Timing(5.0, "time", "minute")
_TWICE = 3.0
"""Samples that follow another one sooner, in minutes, were written twice."""


class MissingRecordError(ValueError):
    """The package that holds a record is not installed."""


def glucose() -> FloatArray:
    """Glucose of one person, in mg/dl, and the current of the sensor, in nA, every five minutes.

    The record of 2010 comes with the package ``bokeh-sampledata``. Samples that were written twice
    are left out, gaps cut the record, and what is between them is cut into series of twelve hours.

    Shape ``(series, 144, 2)``, in the order of time.
    """
    path = _inside("bokeh-sampledata", "bokeh_sampledata/_data/CGM.csv.gz")
    stamp = TimeStamps("minute")
    rows: list[tuple[float, float, float]] = []
    with gzip.open(path, "rt", encoding="utf-8") as file:
        for row in csv.DictReader(file):
            time = stamp(row["datetime"])
            if not rows or time - rows[-1][0] >= _TWICE:
                current = float("nan") if row["isig"] == "nil" else float(row["isig"])
                rows.append((time, float(row["glucose"]), current))
    columns = dict(zip(("time", "glucose", "current"), np.array(rows).T, strict=True))
    runs = runs_without_gaps(Record([Run(path.name, columns)]), _TIMING)
    kept, _ = long_runs(runs, GLUCOSE_BLOCK)
    return series_of_runs(
        kept, GLUCOSE, [Quantity("glucose"), Quantity("current")], Blocks(GLUCOSE_BLOCK, 1)
    )


def _inside(package: str, path: str) -> Path:
    """Path of a file of an installed package."""
    try:
        found = Path(str(distribution(package).locate_file(path)))
    except PackageNotFoundError:
        raise MissingRecordError(
            f"its record comes with the package {package}, which is not installed: "
            f"pip install {package}"
        ) from None
    if not found.is_file():
        raise MissingRecordError(f"its record, {path}, is not in this version of {package}")
    return found
