"""Measured records of the benchmark, read from packages that hold them.

A package is found, not imported: what it needs itself is not needed.
"""

from importlib.metadata import PackageNotFoundError, distribution
from pathlib import Path

import numpy as np
import pandas as pd

from burstcast.arrays import FloatArray
from burstcast.data.measured_data import Blocks, Quantity, Run, series_of_runs
from burstcast.data.records import long_runs, runs_without_gaps
from burstcast.data.times import TIME, moments_in
from burstcast.systems.measured import MeasuredSeries

GLUCOSE_BLOCK = 144
"""Samples of a series of glucose: twelve hours."""
GLUCOSE = MeasuredSeries(("glucose", "current"), "-glucose")
"""What a state is: glucose in mg/dl and the current of the sensor in nA."""
_STEP = 5.0
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
    raw = pd.read_csv(path, na_values=["nil"])
    time = moments_in(pd.DatetimeIndex(raw["datetime"]), "minute")
    rows = [0]
    for row in range(1, len(time)):
        if time[row] - time[rows[-1]] >= _TWICE:
            rows.append(row)
    columns = {TIME: time[rows]}
    for name, source in (("glucose", "glucose"), ("current", "isig")):
        columns[name] = raw[source].to_numpy(dtype=np.float64)[rows]
    kept, _ = long_runs(runs_without_gaps(Run(path.name, columns), _STEP), GLUCOSE_BLOCK)
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
