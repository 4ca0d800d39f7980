"""Measured records of the benchmark, read from packages that hold them.

A package is found, not imported: what it needs itself is not needed.
"""

from importlib.metadata import PackageNotFoundError, distribution
from pathlib import Path

import pandas as pd

from burstcast.arrays import FloatArray
from burstcast.data.frames import from_dataframe
from burstcast.systems.measured import MeasuredSeries

GLUCOSE = MeasuredSeries(("glucose", "current"), "-glucose")
"""What a state is: glucose in mg/dl and the current of the sensor in nA."""
_BLOCK = 715.0
"""Length of a series of glucose, in minutes: twelve hours."""
_TWICE = pd.Timedelta("3min")
"""Samples that follow another one sooner were written twice."""


class MissingRecordError(ValueError):
    """The package that holds a record is not installed."""


def glucose() -> FloatArray:
    """Glucose of one person, in mg/dl, and the current of the sensor, in nA, every five minutes.

    The record of 2010 comes with the package ``bokeh-sampledata``. Samples that were written twice
    are left out, gaps cut the record, and what is between them is cut into series of twelve hours.

    Shape ``(series, 144, 2)``, in the order of time.
    """
    raw = pd.read_csv(
        _inside("bokeh-sampledata", "bokeh_sampledata/_data/CGM.csv.gz"), na_values=["nil"]
    )
    raw["time"] = pd.to_datetime(raw["datetime"])
    kept = [0]
    for row, time in enumerate(raw["time"]):
        if time - raw["time"][kept[-1]] >= _TWICE:
            kept.append(row)
    table = raw.loc[kept, ["time", "glucose", "isig"]].rename(columns={"isig": "current"})
    return from_dataframe(table, "5 minutes", block=_BLOCK, cut_gaps=True)


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
