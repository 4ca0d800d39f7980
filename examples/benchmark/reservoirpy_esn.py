"""An echo state network of ReservoirPy for a case of the benchmark.

::

    python reservoirpy_esn.py CASE.nc FORECASTS.nc [NEURONS]

ReservoirPy makes and trains the network. Its hyperparameters are chosen on two training series that
the readout has not seen. The closed loops of all starting points run side by side in NumPy, with
the network's own matrices, since ReservoirPy runs them one after another.
"""

import itertools
import sys

import netCDF4
import numpy as np
from reservoirpy.nodes import Reservoir, Ridge

HELD_OUT = 2
"""Training series that hyperparameters are chosen on."""
SPECTRAL_RADII, INPUT_SCALINGS, RIDGES = (0.2, 0.5, 0.9), (0.1, 0.3, 1.0), (1e-9, 1e-6, 1e-3)


class Network:
    """A trained network, whose closed loops run side by side."""

    def __init__(self, training, washout, neurons, spectral_radius, input_scaling, ridge):
        self.mean, self.scale = training.mean(axis=(0, 1)), np.ptp(training, axis=(0, 1))
        reservoir = Reservoir(
            neurons,
            sr=spectral_radius,
            input_scaling=input_scaling,
            input_connectivity=0.3,
            rc_connectivity=min(1.0, 20 / neurons),
            bias=np.random.default_rng(0).uniform(-0.2, 0.2, neurons),
            seed=0,
        )
        states, targets = [], []
        for series in (training - self.mean) / self.scale:
            reservoir.initialize(series[:1]) if not reservoir.initialized else reservoir.reset()
            states.append(with_squares(reservoir.run(series[:-1])))
            targets.append(series[1:])
        readout = Ridge(ridge=ridge).fit(states, targets, warmup=washout)
        self.recurrent, self.fed = reservoir.W, reservoir.Win.toarray()
        self.bias = reservoir.bias[:, np.newaxis]
        self.weights, self.offset = readout.Wout, readout.bias

    def step(self, state, inputs):
        """Next states of reservoirs, ``(neurons, batch)``."""
        return np.tanh(self.recurrent @ state + self.fed @ inputs + self.bias)

    def forecast(self, washouts, steps):
        """Forecasts after washouts, both ``(points, steps, component)``."""
        inputs = ((washouts - self.mean) / self.scale).transpose(1, 2, 0)
        state = np.zeros((len(self.bias), len(washouts)))
        for one in inputs:
            state = self.step(state, one)
        found = np.empty((len(washouts), steps, washouts.shape[2]))
        for step in range(steps):
            output = with_squares(state.T) @ self.weights + self.offset
            found[:, step] = output * self.scale + self.mean
            state = self.step(state, output.T)
        return found


def with_squares(states):
    """Reservoir states ``(steps, neurons)``, every other neuron squared.

    The equations of the flow have no symmetry under a change of all signs; tanh has.
    """
    found = states.copy()
    found[:, ::2] **= 2
    return found


def error(network, series, washout, lyapunov_time):
    """Mean error of the forecasts of series, two Lyapunov times long, in units of their scale."""
    reach = 2 * lyapunov_time
    starts = np.arange(washout, series.shape[1] - reach, lyapunov_time)
    washouts = np.concatenate([series[:, at - washout : at] for at in starts])
    truth = np.concatenate([series[:, at : at + reach] for at in starts])
    missed = (network.forecast(washouts, reach) - truth) / network.scale
    return np.sqrt((missed**2).mean(axis=(1, 2))).mean()


def chosen(training, washout, neurons, lyapunov_time):
    """Network with the hyperparameters that forecast the series best that are held out."""
    learnt, held_out = training[:-HELD_OUT], training[-HELD_OUT:]
    errors = {}
    for given in itertools.product(SPECTRAL_RADII, INPUT_SCALINGS, RIDGES):
        with np.errstate(over="ignore", invalid="ignore"):
            network = Network(learnt, washout, neurons, *given)
            errors[given] = error(network, held_out, washout, lyapunov_time)
        print(f"spectral radius, input scaling, ridge {given}: error {errors[given]:.4f}")
    best = min(errors, key=lambda given: (np.isnan(errors[given]), errors[given]))
    return Network(training, washout, neurons, *best)


def main(case_path, path, neurons=500):
    """Write forecasts of a case."""
    with netCDF4.Dataset(case_path) as case:
        facts = {name: case.getncattr(name) for name in ("case", "case_version", "seed")}
        names = ("training", "washout", "horizon_washout")
        training, washouts, before_events = (np.asarray(case[name][:]) for name in names)
        steps, horizon_steps = int(case.forecast_steps), int(case.horizon_steps)
        lyapunov_time = int(case.steps_per_lyapunov_time)
    network = chosen(training, washouts.shape[1], int(neurons), lyapunov_time)
    with netCDF4.Dataset(path, "w") as file:
        file.setncatts(facts)
        file.createDimension("component", training.shape[2])
        for before, given, length in (
            ("", washouts, steps),
            ("horizon_", before_events, horizon_steps),
        ):
            names = (f"{before}point", f"{before}step", "component")
            for name, size in zip(names, (len(given), length), strict=False):
                file.createDimension(name, size)
            file.createVariable(f"{before}state", "f4", names)[:] = network.forecast(given, length)


if __name__ == "__main__":
    main(*sys.argv[1:])
