"""Return levels of the free shear flow from thirty short records, against those of a long one.

    python benchmarks/return_levels.py

For each period and choice of the threshold: how many of the intervals hold the level of all records
together. The flow cannot exceed k = 0.5.
"""

import warnings

import numpy as np

from burstcast.base.arrays import FloatArray
from burstcast.statistics.return_levels import declustered_peaks, return_levels
from burstcast.systems.integration import integrate
from burstcast.systems.mfe import MoehlisFaisstEckhardt

LT = 61
"""Samples in a Lyapunov time."""
RECORDS, FLOWS, LENGTH = 30, 75, 320
"""Records, flows of each, and their length in Lyapunov times unless they laminarise before."""
PERIODS = (100.0, 1000.0, 10000.0)


def peaks_of(generator: np.random.Generator) -> tuple[FloatArray, float]:
    """Peaks of separate events of the flows before they laminarise, and the time in LT."""
    system = MoehlisFaisstEckhardt(reynolds=400.0)
    start = np.zeros((9, FLOWS))
    start[[0, 2, 3]] = [[1.0], [0.07066], [-0.07076]]
    start[3] += 0.01 * generator.random(FLOWS)
    states = integrate(system, start, 0.25, 4 * LT * LENGTH, stride=4)[20 * LT :]
    peaks, time = [], 0.0
    for energy in system.observable(states.transpose(1, 0, 2)).T:
        laminar = np.flatnonzero(energy >= 0.48)
        before = energy[: laminar[0]] if laminar.size else energy
        low = np.flatnonzero(before < 0.1)
        if low.size and low[-1] > 10 * LT:
            peaks.append(declustered_peaks(before[: low[-1]], 0.1, run_length=LT))
            time += low[-1] / LT
    return np.concatenate(peaks), time


def main() -> None:
    """Print the table."""
    warnings.simplefilter("ignore")
    records = [peaks_of(np.random.default_rng([88, number])) for number in range(RECORDS)]
    together = np.sort(np.concatenate([peaks for peaks, _ in records]))[::-1]
    total = sum(time for _, time in records)
    truth = [together[round(total / period)] for period in PERIODS]
    print(f"{RECORDS} records, {total:.0f} LT, {len(together)} peaks")
    print("threshold," + ",".join(f"{period:g} LT" for period in PERIODS))
    print("truth," + ",".join(f"{level:.3f}" for level in truth))
    for name, candidates in (("0.1", [0.1]), ("by the rule", None)):
        held, levels, thresholds = np.zeros(len(PERIODS), dtype=int), [], []
        for number, (peaks, time) in enumerate(records):
            found = return_levels(
                peaks,
                time,
                PERIODS,
                np.random.default_rng(number),
                candidates=candidates,
                significance=0.0 if candidates else 0.1,
            )
            held += (found.low <= truth) & (truth <= found.high)
            levels.append(found.level)
            thresholds.append(found.tail.threshold)
        mean, spread = np.mean(levels, axis=0), np.std(levels, axis=0)
        cells = [
            f"{number} of {RECORDS} ({level:.3f} +- {scatter:.3f})"
            for number, level, scatter in zip(held, mean, spread, strict=True)
        ]
        print(",".join([f"{name} ({min(thresholds):.3f} to {max(thresholds):.3f})", *cells]))


if __name__ == "__main__":
    main()
