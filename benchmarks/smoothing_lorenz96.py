"""Networks that learn from smoothed series and start from a filter, for Lorenz 96, as a table.

    python benchmarks/smoothing_lorenz96.py > benchmarks/smoothing_lorenz96.csv

Ten variables, F = 8, 1 % noise: 20 training and 40 test series of default_forecasters.py, whose
events are rises of the energy to its 0.95 quantile. Networks of 300 neurons with squares, three
seeds; variants and columns as in smoothing.py.
"""

import argparse
import csv
import sys

import numpy as np
from default_forecasters import lorenz96
from shear_flow_starts import TIMES, Starts
from smoothing import networks

from burstcast.forecasts.windows import window_forecasts

UNIT, WASHOUT = 21, 20
"""Steps of a Lyapunov time (1 / 1.2 time units, 0.04 apart), and of the washout."""


def energy(states):
    """Mean square of the variables, of ``(variable, ...)``."""
    return np.square(states).mean(axis=0)


def main():
    """Print the table as CSV."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--neurons", type=int, default=300)
    parser.add_argument("--seeds", nargs="*", type=int, default=[0, 1, 2])
    parser.add_argument("--tests", type=int, default=40, help="test series")
    arguments = parser.parse_args()
    record = lorenz96()
    observed = np.asarray(record.series)[: record.training + arguments.tests]
    training, tested = observed[: record.training], observed[record.training :]
    seen = energy(tested.transpose(2, 0, 1))
    threshold = float(np.quantile(energy(training.transpose(2, 0, 1)), 0.95))
    starts = Starts(seen, seen, UNIT, threshold, WASHOUT)
    washouts = starts.washouts(tested, WASHOUT)
    names = [*(f"f_{number}" for number in TIMES), "f_3_low", "f_3_high"]
    names += [f"brier_{number}" for number in TIMES]
    table = csv.writer(sys.stdout, lineterminator="\n")
    table.writerow(["kind", "neurons", "set", "variant", *names])
    flow = (energy, UNIT, WASHOUT, None, (0.05, 0.2, 0.5, 1.0))
    for seed in arguments.seeds:
        for variant, model in networks(training, arguments.neurons, seed, *flow):
            forecasts = window_forecasts(model, energy, washouts, starts.boundaries)
            scores = starts.scores(forecasts)
            cells = [f"{scores[name]:.4f}" for name in names]
            table.writerow(["esn", arguments.neurons, seed, variant, *cells])
            sys.stdout.flush()


if __name__ == "__main__":
    main()
