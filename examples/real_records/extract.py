"""Write the two records of docs/real_records.md, glucose.csv and fulda.csv, out of their packages.

Usage: python extract.py [DIRECTORY]. The packages are found, not imported: what they need is not.
"""

import csv
import gzip
import sys
from datetime import datetime
from importlib.metadata import distribution
from pathlib import Path

LEAST = 3
"""Minutes. The receiver of the glucose record wrote some samples twice, a minute apart or less."""


def inside(package: str, path: str) -> Path:
    """Path of a file of an installed package."""
    found = Path(str(distribution(package).locate_file(path)))
    if not found.is_file():
        sys.exit(f"{package} has no {path} any more: install the version that docs/ names")
    return found


def glucose(target: Path) -> None:
    """Glucose (mg/dl) and current of the sensor (nA), without samples that are there twice."""
    with gzip.open(inside("bokeh-sampledata", "bokeh_sampledata/_data/CGM.csv.gz"), "rt") as file:
        rows = list(csv.DictReader(file))
    last, dropped = datetime.min, 0
    with target.open("w", encoding="utf-8", newline="") as file:
        table = csv.writer(file)
        table.writerow(["time", "current", "glucose"])
        for row in rows:
            time = datetime.fromisoformat(row["datetime"])
            if (time - last).total_seconds() < 60 * LEAST:
                dropped += 1
                continue
            last = time
            current = "nan" if row["isig"] == "nil" else row["isig"]
            table.writerow([time.isoformat(), current, row["glucose"]])
    print(f"{target}: {len(rows) - dropped} rows, {dropped} that were there twice left out")


def fulda(target: Path) -> None:
    """Temperature (degrees Celsius), rain (mm per day) and discharge (m^3/s) of the Fulda."""
    source = inside("spotpy", "spotpy/examples/cmf_data/fulda_climate.csv")
    with source.open(encoding="utf-8", newline="") as file:
        _units, *rows = csv.DictReader(file)
    with target.open("w", encoding="utf-8", newline="") as file:
        table = csv.writer(file)
        table.writerow(["date", "temperature", "rain", "discharge"])
        for row in rows:
            date = datetime.strptime(row["date"], "%d.%m.%Y").date()
            table.writerow([date.isoformat(), row["tmean"], row["Prec"], row["Q"]])
    print(f"{target}: {len(rows)} rows")


if __name__ == "__main__":
    directory = Path(sys.argv[1] if len(sys.argv) > 1 else ".")
    glucose(directory / "glucose.csv")
    fulda(directory / "fulda.csv")
