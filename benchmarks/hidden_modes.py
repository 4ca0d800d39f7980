"""Learnt equations of the shear flow where two of its nine modes are never observed, as a table.

    python benchmarks/hidden_modes.py > benchmarks/hidden_modes.csv

Forecasters see seven amplitudes and the kinetic energy, at Re = 400, with 1 % noise. Rows:
`quadratic_hidden` with two hidden variables, with and without the prior that quadratic terms
conserve the energy; `quadratic_filtered`, which has none; and the true equations with a filter that
sees all nine amplitudes, or what the others see. Training and test series as in smoothing.py;
columns as in shear_flow_starts.py, and `explained`: shares of the variance of the two hidden
amplitudes that all variables explain at the starting points, as the filter estimates them.
"""

import argparse
import csv
import sys
import time
from dataclasses import replace

import numpy as np
from shear_flow_starts import (
    BOUNDARIES,
    STEPS_PER_LT,
    SYSTEM,
    TIMES,
    WASHOUT,
    Starts,
    true_series,
    with_noise,
)
from smoothing import CASE, IN_SET, SETS

from burstcast.data.encoders.state_maps import StateMaps
from burstcast.forecasters.base import ForecastingCase
from burstcast.forecasters.equations_filtered import FilteredEquations
from burstcast.forecasters.quadratic_filtered import FilteredQuadraticModel
from burstcast.forecasters.quadratic_hidden import HiddenQuadraticModel
from burstcast.forecasts.windows import window_forecasts
from burstcast.systems.measured import MeasuredSeries

HIDDEN = {"a8, a9": (7, 8), "a6, a7": (5, 6)}

KINDS = {
    "conserved": lambda: HiddenQuadraticModel(observable_follows=True, conserved=True),
    "free": lambda: HiddenQuadraticModel(observable_follows=True),
    "none": FilteredQuadraticModel,
    "equations": FilteredEquations,
}
ROWS = [
    *((kind, "a8, a9", number, 10) for number in range(SETS) for kind in ("conserved", "none")),
    *((kind, "a6, a7", 0, 10) for kind in ("conserved", "none")),
    ("equations", "none", 0, 10),
    *(("free", "a8, a9", number, 10) for number in range(SETS)),
    ("equations", "a8, a9", 0, 10),
    ("equations", "a6, a7", 0, 10),
    *(("conserved", hidden, 0, count) for hidden in HIDDEN for count in (20, 40)),
]
"""Kind, hidden amplitudes, set of training series and their number."""


def maps(states, seen):
    """Maps between nine amplitudes ``(series, time, 9)`` and some of them, by linear regression."""
    flat, matrix = states.reshape(-1, states.shape[2]), np.eye(states.shape[2])[seen]
    covariance, centre = np.cov(flat.T), flat.mean(axis=0)
    gain = covariance @ matrix.T @ np.linalg.inv(matrix @ covariance @ matrix.T)
    constant = centre - gain @ matrix @ centre
    return StateMaps(gain, constant, matrix, np.zeros(len(seen)), covariance)


def explained(model, washouts, truth):
    """Explained shares of the variance of ``truth``, ``(hidden, points)``: ``(hidden,)``."""
    states = model.start(washouts.transpose(1, 2, 0))
    known = np.concatenate([np.ones((1, states.shape[1])), states])
    left = truth - truth @ np.linalg.pinv(known) @ known
    return 1 - left.var(axis=1) / truth.var(axis=1)


def main():
    """Print the table as CSV."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--rows", nargs="*", type=int, default=[*range(len(ROWS))])
    parser.add_argument("--series", type=int, default=170, help="that are integrated")
    parser.add_argument("--tests", type=int, default=60, help="test series")
    arguments = parser.parse_args()
    first = SETS * IN_SET
    tests = slice(first, first + arguments.tests)
    states = true_series(arguments.series)
    spare = [*range(first), *range(tests.stop, len(states))]  # of all that does not test
    energy = SYSTEM.observable(states.transpose(2, 0, 1))
    names = [*(f"f_{number}" for number in TIMES), "f_3_low", "f_3_high"]
    names += [f"brier_{number}" for number in TIMES]
    table = csv.writer(sys.stdout, lineterminator="\n")
    table.writerow(
        ["kind", "hidden", "set", "series", *names, "round", "explained", "seconds", "forecast_ms"]
    )
    for kind, hidden, number, count in (ROWS[row] for row in arguments.rows):
        unseen = list(HIDDEN.get(hidden, ()))
        seen = [component for component in range(9) if component not in unseen]
        whole = hidden == "none"
        sees = states if whole else np.dstack([states[..., seen], energy])
        observed = with_noise(sees, slice(first))
        case, seen_energy = CASE, SYSTEM.observable(observed.transpose(2, 0, 1))
        if not whole:
            space = MeasuredSeries([f"a{component + 1}" for component in seen], "k")
            case = ForecastingCase(space, 0.25, 4, STEPS_PER_LT)
            seen_energy = observed[..., -1]
            if kind == "equations":
                case = replace(case, source=SYSTEM, maps=maps(states[:first], seen))
        starts = Starts(energy[tests], seen_energy[tests])
        began = time.process_time()
        training = spare[number * IN_SET :][:count]
        if len(training) < count:
            raise ValueError(f"{len(training)} series are left for training: raise --series")
        model = KINDS[kind]().fit(observed[training], case)
        fitted = time.process_time()
        washouts = starts.washouts(observed[tests], WASHOUT)
        forecasts = window_forecasts(model, case.system.observable, washouts, BOUNDARIES)
        forecast = time.process_time()
        scores, best, shares = starts.scores(forecasts), "", ""
        if isinstance(model, HiddenQuadraticModel):
            best = int(np.argmin(model.round_errors))
        if not whole and kind != "none":
            points = starts.points
            truth = states[tests][points.series, points.step][:, unseen].T
            shares = " ".join(f"{share:.4f}" for share in explained(model, washouts, truth))
        table.writerow(
            [
                *(kind, hidden, number, count),
                *(*(f"{scores[name]:.4f}" for name in names), best, shares),
                *(f"{fitted - began:.0f}", f"{1e3 * (forecast - fitted) / len(washouts):.2f}"),
            ]
        )
        sys.stdout.flush()


if __name__ == "__main__":
    main()
