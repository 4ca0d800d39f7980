"""Networks that learn from smoothed series: prediction horizons at Re = 400, scores at Re = 1000.

    python benchmarks/smoothing_reach.py > benchmarks/smoothing_reach.csv

Sets of training series and reservoirs of smoothing.py, 1000 neurons with squares.
`horizon_lt`: mean prediction horizon of extreme events, PH_ee, of the first events of the test
series, with its 95 % interval over resampled events. F-scores and Brier skill as in smoothing.py.
"""

import argparse
import csv
import sys

import numpy as np
from shear_flow_starts import THRESHOLD, TIMES, WASHOUT, Starts, true_series, with_noise
from smoothing import IN_SET, SETS, networks

from burstcast.base import random_streams
from burstcast.data.starting_points import crossing_points, horizon_events, segments
from burstcast.forecasts.horizon import HorizonSearch, prediction_horizons
from burstcast.forecasts.windows import window_forecasts
from burstcast.systems.mfe import MoehlisFaisstEckhardt

LYAPUNOV_EXPONENTS = {400: 0.0163, 1000: 0.0121}
"""Published leading exponents, by Reynolds number."""


def horizons(model, observable, energy, observed, unit, events):
    """PH_ee of the first events, in Lyapunov times."""
    tolerance = 0.2 * (THRESHOLD - energy.mean())
    search = HorizonSearch(10.0, 0.5, tolerance, WASHOUT, unit)
    before = search.steps_before_event
    points = horizon_events(crossing_points(energy, THRESHOLD), 0, before, events)
    series, truth = (
        segments(each, points, before, 0) for each in (observed, energy[..., np.newaxis])
    )
    return prediction_horizons(model, observable, series, truth[..., 0], search)


def main():
    """Print the table as CSV."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--reynolds", nargs="*", type=int, default=[400, 1000])
    parser.add_argument("--neurons", type=int, default=1000)
    parser.add_argument("--sets", nargs="*", type=int, default=[*range(SETS)])
    parser.add_argument("--series", type=int, default=130, help="that are integrated")
    parser.add_argument("--tests", type=int, default=60, help="test series")
    parser.add_argument("--events", type=int, default=100, help="of the horizons at Re = 400")
    arguments = parser.parse_args()
    names = [*(f"f_{number}" for number in TIMES), "f_3_low", "f_3_high"]
    names += [f"brier_{number}" for number in TIMES]
    table = csv.writer(sys.stdout, lineterminator="\n")
    columns = ["horizon_lt", "horizon_low", "horizon_high"]
    table.writerow(["reynolds", "neurons", "set", "variant", *columns, *names])
    for reynolds in arguments.reynolds:
        system = MoehlisFaisstEckhardt(float(reynolds))
        unit = round(1 / LYAPUNOV_EXPONENTS[reynolds])
        states = true_series(arguments.series, system)[: SETS * IN_SET + arguments.tests]
        energy, first = system.observable(states.transpose(2, 0, 1)), SETS * IN_SET
        observed = with_noise(states, slice(first))
        seen = system.observable(observed[first:].transpose(2, 0, 1))
        washout = WASHOUT if reynolds == 400 else unit // 2
        starts = Starts(energy[first:], seen, unit, THRESHOLD, washout)
        intervals = 30 if reynolds == 400 else None
        flow = (system.observable, unit, washout, intervals)
        made = (
            (number, *one)
            for number in arguments.sets
            for one in networks(
                observed[number * IN_SET : (number + 1) * IN_SET], arguments.neurons, number, *flow
            )
        )
        for number, variant, model in made:
            cells = [""] * (len(columns) + len(names))
            if reynolds == 400:
                values = horizons(
                    model,
                    system.observable,
                    energy[first:],
                    observed[first:],
                    unit,
                    arguments.events,
                )
                drawn = random_streams.stream(87, "resampled events").choice(
                    values, (1000, len(values))
                )
                ends = np.percentile(drawn.mean(axis=1), [2.5, 97.5])
                cells[:3] = [f"{value:.2f}" for value in (values.mean(), *ends)]
            elif variant in ("plain", "both"):
                washouts = starts.washouts(observed[first:], washout)
                forecasts = window_forecasts(model, system.observable, washouts, starts.boundaries)
                scores = starts.scores(forecasts)
                cells[3:] = [f"{scores[name]:.4f}" for name in names]
            table.writerow([reynolds, arguments.neurons, number, variant, *cells])
            sys.stdout.flush()


if __name__ == "__main__":
    main()
