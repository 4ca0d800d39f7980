"""Write the two records of docs/real_records.md, glucose.csv and fulda.csv, out of their packages.

Usage: python extract.py [DIRECTORY]. The packages are found, not imported: what they need is not.
"""

import sys
from importlib.metadata import PackageNotFoundError, distribution
from pathlib import Path

import numpy as np
import pandas as pd

DAY, YEAR = 1440.0, 365.2425
"""Periods of the two cycles, in minutes and in days."""
TRAINING = 20 * 91
"""Days of the training series of the Fulda, which its yearly cycle is fitted to."""


def inside(package: str, path: str) -> Path:
    """Path of a file of an installed package."""
    try:
        file = Path(str(distribution(package).locate_file(path)))
    except PackageNotFoundError:
        sys.exit(f"{package} is not installed: pip install {package}")
    if not file.is_file():
        sys.exit(f"{package} has no {path} any more: install the version that docs/ names")
    return file


def with_cycle(table: pd.DataFrame, unit: str, period: float) -> pd.DataFrame:
    """The table with the cosine and the sine of a cycle, by its dates."""
    time = (table["time"] - pd.Timestamp("1970-01-01")) / pd.Timedelta(1, unit)
    angle = 2 * np.pi * np.mod(time, period) / period
    return table.assign(cycle_cos=np.cos(angle), cycle_sin=np.sin(angle))


def glucose() -> pd.DataFrame:
    """Glucose (mg/dl) and current of the sensor (nA), without samples that are there twice."""
    raw = pd.read_csv(
        inside("bokeh-sampledata", "bokeh_sampledata/_data/CGM.csv.gz"), na_values=["nil"]
    )
    raw["time"] = pd.to_datetime(raw["datetime"])
    # the receiver wrote some samples twice, less than three minutes apart
    kept = [0]
    for row, time in enumerate(raw["time"]):
        if time - raw["time"][kept[-1]] >= pd.Timedelta("3min"):
            kept.append(row)
    table = raw.loc[kept, ["time", "isig", "glucose"]].rename(columns={"isig": "current"})
    print(f"{len(table)} rows, {len(raw) - len(table)} that were there twice left out")
    return with_cycle(table, "min", DAY)


def fulda() -> pd.DataFrame:
    """Temperature without its yearly cycle, rain (mm per day), and discharge (m^3/s) of the Fulda.

    The cycle is fitted to the training series alone, and its mean is removed with it.
    """
    source = inside("spotpy", "spotpy/examples/cmf_data/fulda_climate.csv")
    raw = pd.read_csv(source, skiprows=[1])  # the second row has units
    names = {"tmean": "temperature", "Prec": "rain", "Q": "discharge"}
    table = raw[list(names)].rename(columns=names)
    table.insert(0, "time", pd.to_datetime(raw["date"], format="%d.%m.%Y"))
    table = with_cycle(table, "D", YEAR)
    terms = np.column_stack([np.ones(len(table)), table["cycle_cos"], table["cycle_sin"]])
    usual, *_ = np.linalg.lstsq(terms[:TRAINING], table["temperature"][:TRAINING], rcond=None)
    return table.assign(temperature=table["temperature"] - terms @ usual)


if __name__ == "__main__":
    directory = Path(sys.argv[1] if len(sys.argv) > 1 else ".")
    glucose().to_csv(directory / "glucose.csv", index=False, date_format="%Y-%m-%dT%H:%M:%S")
    fulda().to_csv(directory / "fulda.csv", index=False)
