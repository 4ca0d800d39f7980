"""Return levels of the Fulda's discharge and rain, as a table for docs/real_records.md.

Usage: python return_levels.py [FILE], where the file is fulda.csv, which extract.py writes.
"""

import sys
import warnings

import numpy as np
import pandas as pd

from burstcast.statistics.return_levels import declustered_peaks, return_levels

APART = 7
"""Days without an exceedance that separate two events."""
LOWEST = 0.9
"""Quantile of the record that is the lowest threshold."""
PERIODS = (2.0, 10.0, 100.0)
"""Return periods in years."""


def main(path: str) -> None:
    """Print a row for each quantity."""
    table = pd.read_csv(path)
    years = len(table) / 365.2425
    head = ["quantity", "threshold", "peaks", "shape", *(f"{period:g} years" for period in PERIODS)]
    print(f"| {' | '.join(head)} |", "|---" * len(head) + "|", sep="\n")
    for name, unit in (("discharge", "m^3/s"), ("rain", "mm per day")):
        record = table[name].to_numpy()
        peaks = declustered_peaks(record, float(np.quantile(record, LOWEST)), APART)
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            found = return_levels(peaks, years, PERIODS, np.random.default_rng(0))
        for warning in caught:
            print(f"{name}: {warning.message}", file=sys.stderr)
        shape, number = found.tail.shape, found.choice.chosen
        ends = found.choice.shape_low[number], found.choice.shape_high[number]
        levels = zip(found.level, found.low, found.high, strict=True)
        cells = [
            f"{name} [{unit}]",
            f"{found.tail.threshold:.3g}",
            str(found.tail.peaks),
            f"{shape:.2f} ({ends[0]:.2f} to {ends[1]:.2f})",
            *(f"{level:.0f} ({low:.0f} to {high:.0f})" for level, low, high in levels),
        ]
        print(f"| {' | '.join(cells)} |")


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "fulda.csv")
