"""Which washouts are found inconsistent, and what forecasts from them are worth: a table.

::

    python benchmarks/consistency.py > benchmarks/consistency.csv
    python benchmarks/consistency.py --kinds quadratic esn --washouts 0.5

Forecasters learn the shear flow at Re = 400 from ten series with 1 % noise. They are given washouts
of other series of this flow, with the same noise, with coloured noise, and with another gain; and
of flows in other boxes, and at another Reynolds number.
"""

import argparse
import csv
import sys
import warnings
from typing import Any

import numpy as np
from scipy.signal import lfilter

from burstcast import EventForecaster
from burstcast.base.arrays import FloatArray
from burstcast.data.dataset import generate_ensemble, initial_states
from burstcast.systems.mfe import MoehlisFaisstEckhardt

NOISE, TRAINING, TESTS, LYAPUNOV_TIME = 0.01, 10, 16, 61
KINDS: dict[str, dict[str, Any]] = {
    "quadratic_filtered": {},
    "quadratic": {},
    "esn": {"neurons": 300, "members": 1, "searches": 1, "grid": 2, "bayesian_points": 0},
}
PARTS = ("consistent", "inconsistent")
OTHERS = {
    "box longer by 1 %": (1.01, 400.0),
    "box longer by 2 %": (1.02, 400.0),
    "box longer by 5 %": (1.05, 400.0),
    "Re = 800": (1.0, 800.0),
}


def flow(length: float = 1.0, reynolds: float = 400.0) -> MoehlisFaisstEckhardt:
    """The flow in a box that is ``length`` times as long."""
    return MoehlisFaisstEckhardt(reynolds=reynolds, length_x=length * 4 * np.pi)


def series(system: MoehlisFaisstEckhardt, count: int, seed: int, steps: int = 2000) -> FloatArray:
    """Series that do not laminarise, ``(count, steps + 1, 9)``."""
    first = np.array([1, 0, 0.07066, -0.07076, 0, 0, 0, 0, 0])
    start = initial_states(first, 3, 0.01, 2 * count, np.random.default_rng(seed))
    settings = {"time_step": 0.25, "sampling_stride": 4, "transient_steps": 800}
    settings |= {"kept_steps": 4 * steps, "laminarisation_threshold": 0.48}
    (kept,) = generate_ensemble(system, start, **settings)
    return kept.states[:count]


def noisy(states: FloatArray, scale: FloatArray, seed: int, correlation: float = 0.0) -> FloatArray:
    """Series with noise whose correlation falls to 1/e in so many samples; 0: it is white."""
    drawn = np.random.default_rng(seed).standard_normal(states.shape)
    if correlation:
        factor = np.exp(-1 / correlation)
        drawn[:, 1:] *= np.sqrt(1 - factor**2)
        drawn = lfilter([1.0], [1.0, -factor], drawn, axis=1)
    return states + NOISE * scale * drawn


def main() -> None:
    """Print the table as CSV."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--kinds", nargs="+", default=["quadratic_filtered"], choices=KINDS)
    parser.add_argument("--washouts", nargs="+", type=float, default=[0.5, 1, 2], help="in LT")
    given = parser.parse_args()
    own = series(flow(), TRAINING + TESTS, 1)
    scale, test = own[:TRAINING].std(axis=(0, 1)), own[TRAINING:]
    training = noisy(series(flow(), TRAINING, 1, 4000), scale, 2)
    tested = {"the same": noisy(test, scale, 3), "noise over 10 samples": noisy(test, scale, 3, 10)}
    tested["gain 1.1"] = 1.1 * tested["the same"]
    for name, (length, reynolds) in OTHERS.items():
        tested[name] = noisy(series(flow(length, reynolds), TESTS, 4), scale, 5)
    rows = csv.writer(sys.stdout, lineterminator="\n")
    names = ["events", "alarm_f_score", "brier_skill"]
    rows.writerow(
        ["kind", "washout_lt", "washouts", "inconsistent"]
        + [f"{name}_{part}" for part in PARTS for name in names]
    )
    for kind in given.kinds:
        for washout in given.washouts:
            forecaster = EventForecaster(
                flow(),
                0.1,
                kind=kind,
                lyapunov_time=LYAPUNOV_TIME,
                prediction_times=2.0,
                washout=washout,
                calibrate=False,
                **KINDS[kind],
            )
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                forecaster.fit(training)
                for name, states in tested.items():
                    table = forecaster.scores_by_consistency(states)
                    values = [table[part][score] for part in PARTS for score in names]
                    share = table["inconsistent"]["share"]
                    rows.writerow(
                        [kind, f"{washout:g}", name, f"{share:.4f}"]
                        + ["" if np.isnan(value) else f"{value:.4g}" for value in values]
                    )
                    sys.stdout.flush()


if __name__ == "__main__":
    main()
