"""Networks, learnt equations and NVAR that learn from smoothed series and start from a filter.

    python benchmarks/smoothing.py > benchmarks/smoothing.csv
    python benchmarks/smoothing.py --sets 0 --forecasters esn --neurons 500

The shear flow at Re = 400, with disjoint sets of ten noisy training series and the same test series
for all. Each set has a reservoir of its own, so that differences between sets contain that between
reservoirs. Variants: as it is (`plain`), started from a filter (`filter`), trained on smoothed
series (`smoothing`), and both. Alarms are by the majority of the filter's members; forecasters
without a filter have one. Columns as in shear_flow_starts.py.
"""

import argparse
import csv
import sys
import time
from dataclasses import dataclass
from itertools import product
from typing import Any, ClassVar

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

from burstcast.base import random_streams
from burstcast.data.dataset import component_scales
from burstcast.data.observation_noise import observation_noise
from burstcast.forecasters._ensemble_smoother import follow, opposite_pairs
from burstcast.forecasters.base import Forecaster, ForecastingCase
from burstcast.forecasters.equations_filtered import FilteredEquations
from burstcast.forecasters.esn import NetworkForecaster
from burstcast.forecasters.esn_filtered import FilteredNetwork
from burstcast.forecasters.nvar import NVAR, _features
from burstcast.forecasters.quadratic import QuadraticModel
from burstcast.forecasters.quadratic_hidden import HiddenQuadraticModel
from burstcast.forecasts.windows import window_forecasts
from burstcast.networks.dynamics import Dynamics
from burstcast.networks.hyperparameters import HyperparameterPoint
from burstcast.networks.reservoir import ReservoirSeed
from burstcast.networks.training import TrainingSeries
from burstcast.networks.validation import PointValidator
from burstcast.networks.validation_strategies.base import ValidationPlan
from burstcast.networks.validation_strategies.registry import make_strategy

SETS, IN_SET = 3, 10
SPECTRAL_RADII, INPUT_SCALINGS = (0.1, 0.3), (0.05, 0.2)
TIKHONOV = (1e-10, 1e-12, 1e-14)
ROUNDS, JITTER = 4, 0.05
CASE = ForecastingCase(SYSTEM, 0.25, 4, STEPS_PER_LT)


def networks(
    observed,
    neurons,
    seed,
    observable=SYSTEM.observable,
    unit=STEPS_PER_LT,
    washout=WASHOUT,
    intervals=30,
    input_scalings=INPUT_SCALINGS,
):
    """Echo state network with squares, and with filter and smoothing: variant and forecaster."""
    training = TrainingSeries(observed, component_scales(observed).range)
    reservoir_seed = ReservoirSeed(87, neurons, seed, 20.0, 1.0)
    reservoir = reservoir_seed.reservoir(observed.shape[2])
    plan = ValidationPlan(washout=washout, interval=2 * unit, series=4, intervals=intervals)
    validator = PointValidator(
        reservoir, training, observable, plan, TIKHONOV, "compiled", "quadratic"
    )
    tried = [
        (result.objective, point, result.tikhonov)
        for radius, scaling in product(SPECTRAL_RADII, input_scalings)
        for point in [HyperparameterPoint(radius, scaling, 1.0)]
        for result in validator(point, [make_strategy("RV")])
    ]
    _, point, tikhonov = min(tried, key=lambda one: one[0])
    dynamics = Dynamics(
        reservoir,
        spectral_radius=point.spectral_radius,
        input_scaling=point.input_scaling,
        leak_rate=1.0,
        readout="quadratic",
    )

    def trained(model):
        return model.trained(
            dynamics,
            reservoir_seed,
            training,
            washout=washout,
            tikhonov=tikhonov,
            steps_per_lyapunov_time=unit,
        )

    plain = NetworkForecaster(input_offset="none")
    yield "plain", trained(plain)
    yield "filter", trained(FilteredNetwork(input_offset="none", denoising_rounds=0))
    both = trained(FilteredNetwork(input_offset="none", denoising_rounds=ROUNDS))
    yield "smoothing", plain.with_fitted(network=both.network, seed=reservoir_seed)
    yield "both", both


def equations(observed, neurons, seed):
    """Learnt quadratic equations."""
    yield "plain", QuadraticModel().fit(observed, CASE)
    yield "filter", HiddenQuadraticModel(hidden=0, rounds=0).fit(observed, CASE)
    both = HiddenQuadraticModel(hidden=0, rounds=ROUNDS).fit(observed, CASE)
    yield (
        "smoothing",
        QuadraticModel().with_fitted(
            system=both.system,
            coefficients=both.coefficients,
            time_step=CASE.time_step,
            sampling_stride=CASE.sampling_stride,
        ),
    )
    yield "both", both


@dataclass(frozen=True)
class DrivenNVAR:
    """Nonlinear vector autoregression as a model that a filter drives by samples."""

    model: NVAR

    @property
    def hidden(self):
        """Memories are not smoothed."""
        return slice(0)

    def begin(self, samples, number):
        """Memories with a sample as all of the past."""
        scaled = self._scaled(samples)
        return np.concatenate([scaled] * self.model.lags)

    def predict(self, states):
        """Next sample."""
        dimension = len(self.model.mean)
        features = _features(states.reshape(len(states), -1))
        change = (self.model.weights.T @ features).reshape(dimension, *states.shape[1:])
        scale, mean = (
            each[:, np.newaxis, np.newaxis] for each in (self.model.scale, self.model.mean)
        )
        return (states[:dimension] + change) * scale + mean

    def drive(self, states, samples, number):
        """Memories after one more sample."""
        return np.concatenate([self._scaled(samples), states[: -len(samples)]])

    def _scaled(self, samples):
        scale, mean = (
            each[:, np.newaxis, np.newaxis] for each in (self.model.scale, self.model.mean)
        )
        return (samples - mean) / scale


@dataclass(frozen=True)
class FilteredNVAR(Forecaster):
    """Nonlinear vector autoregression that starts from the mean of a filter's members."""

    model: Any
    errors: Any
    model_error: Any

    provides_ensemble: ClassVar[bool] = True

    def ensemble(self, washout):
        """Memories of the members that vote."""
        states = follow(
            DrivenNVAR(self.model),
            washout.transpose(2, 0, 1),
            self.errors,
            opposite_pairs(0, len(self.errors), 30),
            self.model_error,
            start_up=2,
        ).states
        voters = states[..., [*range(5), *range(15, 20)]]
        voters = voters + (states.mean(axis=2) - voters.mean(axis=2))[..., np.newaxis]
        return np.ascontiguousarray(voters.transpose(0, 2, 1))

    def combined(self, ensemble):
        """Mean of the members."""
        return np.ascontiguousarray(ensemble.mean(axis=-2))

    def fit(self, training, case):
        """Refuse: it is made of a fitted model."""
        raise NotImplementedError

    def start(self, washout):
        """Mean of the members after a washout."""
        return self.combined(self.ensemble(washout))

    def advance(self, memory, steps):
        """Forecast of the model."""
        return self.model.advance(memory, steps)


def autoregression(observed, neurons, seed):
    """Nonlinear vector autoregression."""
    errors = observation_noise(observed, None)
    plain = NVAR().fit(observed, CASE)
    yield "plain", plain
    model = plain
    for number in range(ROUNDS + 1):
        followed = follow(
            DrivenNVAR(model),
            observed,
            errors,
            opposite_pairs(0, len(errors), 30),
            None,
            start_up=2,
            lag=12,
        )
        filtered = FilteredNVAR(model, errors, followed.model_error)
        if number in (0, ROUNDS):
            yield ("filter", "both")[number > 0], filtered
        generator = random_streams.stream(0, "jitter of smoothed series", number)
        jitter = JITTER * errors * generator.standard_normal(observed.shape)
        if number < ROUNDS:
            model = NVAR().fit(followed.smoothed + jitter, CASE)
    yield "smoothing", model


def bound(observed, neurons, seed):
    """True equations."""
    yield "filter", FilteredEquations().fit(observed, CASE)


KINDS = {"esn": networks, "quadratic": equations, "nvar": autoregression, "equations": bound}


def main():
    """Print the table as CSV."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--forecasters", nargs="*", default=[*KINDS], choices=KINDS)
    parser.add_argument("--neurons", nargs="*", type=int, default=[500, 1000])
    parser.add_argument("--sets", nargs="*", type=int, default=[*range(SETS)])
    parser.add_argument("--series", type=int, default=130, help="that are integrated")
    parser.add_argument("--tests", type=int, default=60, help="test series")
    arguments = parser.parse_args()
    states = true_series(arguments.series)[: SETS * IN_SET + arguments.tests]
    energy, first = SYSTEM.observable(states.transpose(2, 0, 1)), SETS * IN_SET
    observed = with_noise(states, slice(first))
    starts = Starts(energy[first:], SYSTEM.observable(observed[first:].transpose(2, 0, 1)))
    washouts = starts.washouts(observed[first:], WASHOUT)
    names = [*(f"f_{number}" for number in TIMES), "f_3_low", "f_3_high"]
    names += [f"brier_{number}" for number in TIMES]
    table = csv.writer(sys.stdout, lineterminator="\n")
    table.writerow(["kind", "neurons", "set", "variant", *names, "seconds", "forecast_ms"])
    for chosen, kind in product(arguments.sets, arguments.forecasters):
        training = observed[chosen * IN_SET : (chosen + 1) * IN_SET]
        for neurons in arguments.neurons if kind == "esn" else [""]:
            began = time.process_time()
            for variant, model in KINDS[kind](training, neurons, chosen):
                fitted = time.process_time()
                forecasts = window_forecasts(model, SYSTEM.observable, washouts, BOUNDARIES)
                forecast = time.process_time()
                scores = starts.scores(forecasts)
                table.writerow(
                    [kind, neurons, chosen, variant]
                    + [f"{scores[name]:.4f}" for name in names]
                    + [f"{fitted - began:.0f}", f"{1e3 * (forecast - fitted) / len(washouts):.2f}"]
                )
                sys.stdout.flush()
                began = time.process_time()


if __name__ == "__main__":
    main()
