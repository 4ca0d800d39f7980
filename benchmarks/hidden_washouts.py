"""Networks for the shear flow with two hidden modes, by the length of the washout, as a table.

    python benchmarks/hidden_washouts.py > benchmarks/hidden_washouts.csv

Networks see seven amplitudes and the kinetic energy, at Re = 400. Rows: echo state networks with
squares in the readout; with leaking neurons; with past values 20 and 40 steps back as further
inputs; and `esn_filtered`. Hyperparameters are chosen by recycle validation on the training series,
for each kind of inputs. Columns as in shear_flow_starts.py.
"""

import argparse
import csv
import sys
from itertools import product

import numpy as np
from shear_flow_starts import (
    BOUNDARIES,
    STEPS_PER_LT,
    SYSTEM,
    TIMES,
    Starts,
    true_series,
    with_noise,
)

from burstcast.data.dataset import component_scales
from burstcast.data.delay_coordinates import delay_coordinates
from burstcast.forecasters.esn import NetworkForecaster
from burstcast.forecasters.esn_filtered import FilteredNetwork
from burstcast.forecasts.windows import window_forecasts
from burstcast.networks.dynamics import Dynamics
from burstcast.networks.hyperparameters import HyperparameterPoint
from burstcast.networks.reservoir import ReservoirSeed
from burstcast.networks.training import TrainingSeries
from burstcast.networks.validation import PointValidator
from burstcast.networks.validation_strategies.base import ValidationPlan
from burstcast.networks.validation_strategies.registry import make_strategy

SEEN = [0, 1, 2, 3, 4, 5, 6]
WASHOUTS_LT = (0.5, 1.0, 2.0, 3.0)
DELAYS = [20, 40]
SPECTRAL_RADII, INPUT_SCALINGS = (0.1, 0.3, 0.9), (0.05, 0.2)
TIKHONOV = (1e-6, 1e-9, 1e-12)
KINDS = ("esn", "leak", "delays", "esn_filtered")


def energy(states):
    """Kinetic energy, which is the last of the seen components, of ``(component, ...)``."""
    return states[len(SEEN)]


def searched(training, reservoir, leak_rates, washout):
    """Hyperparameters with the least error in recycle validation."""
    plan = ValidationPlan(washout=washout, interval=2 * STEPS_PER_LT, series=4, intervals=25)
    validator = PointValidator(reservoir, training, energy, plan, TIKHONOV, "compiled", "quadratic")
    tried = [
        (result.objective, point, result.tikhonov)
        for radius, scaling, leak in product(SPECTRAL_RADII, INPUT_SCALINGS, leak_rates)
        for point in [HyperparameterPoint(radius, scaling, leak)]
        for result in validator(point, [make_strategy("RV")])
    ]
    return min(tried, key=lambda one: one[0])[1:]


def network(kind, observed, neurons, seed, washout):
    """Train a network of a kind on series ``(series, time, component)``."""
    ranges = component_scales(observed).range
    training = TrainingSeries(observed, ranges)
    reservoir_seed = ReservoirSeed(87, neurons, seed, 20.0, 1.0)
    reservoir = reservoir_seed.reservoir(observed.shape[2])
    leaks = (1.0, 0.3, 0.1) if kind == "leak" else (1.0,)
    point, tikhonov = searched(training, reservoir, leaks, washout)
    dynamics = Dynamics(
        reservoir,
        spectral_radius=point.spectral_radius,
        input_scaling=point.input_scaling,
        leak_rate=point.leak_rate,
        readout="quadratic",
    )
    make = FilteredNetwork if kind == "esn_filtered" else NetworkForecaster
    return make(input_offset="none").trained(
        dynamics,
        reservoir_seed,
        training,
        washout=washout,
        tikhonov=tikhonov,
        steps_per_lyapunov_time=STEPS_PER_LT,
    )


def main():
    """Print the table as CSV."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--kinds", nargs="*", default=KINDS, choices=KINDS)
    parser.add_argument("--neurons", nargs="*", type=int, default=[500, 1000])
    parser.add_argument("--series", type=int, default=110, help="that are integrated")
    parser.add_argument("--tests", type=int, default=60, help="test series")
    parser.add_argument("--washouts", nargs="*", type=float, default=WASHOUTS_LT)
    arguments = parser.parse_args()
    states = true_series(arguments.series)[: 10 + arguments.tests]
    true_energy = SYSTEM.observable(states.transpose(2, 0, 1))
    seen = np.concatenate([states[..., SEEN], true_energy[..., np.newaxis]], axis=2)
    observed = with_noise(seen, slice(10))
    starts = Starts(true_energy[10:], observed[10:, :, -1])
    names = [*(f"f_{time}" for time in TIMES), "f_3_low", "f_3_high"]
    names += [f"brier_{time}" for time in TIMES]
    table = csv.writer(sys.stdout, lineterminator="\n")
    table.writerow(["kind", "neurons", "washout_lt", *names])
    longest = max(DELAYS)
    padding = np.repeat(observed[:, :1], longest, axis=1)
    delayed = delay_coordinates(np.concatenate([padding, observed], axis=1), DELAYS)
    for kind, neurons, washout_lt in product(
        arguments.kinds, arguments.neurons, arguments.washouts
    ):
        washout = round(washout_lt * STEPS_PER_LT) if washout_lt != 0.5 else 30
        series = delayed if kind == "delays" else observed
        model = network(kind, series[:10, longest:], neurons, 0, washout)
        forecasts = window_forecasts(
            model, energy, starts.washouts(series[10:], washout), BOUNDARIES
        )
        scores = starts.scores(forecasts)
        table.writerow([kind, neurons, washout_lt, *(f"{scores[name]:.3f}" for name in names)])
        sys.stdout.flush()


if __name__ == "__main__":
    main()
