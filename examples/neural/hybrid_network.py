"""A reservoir that also receives a wrong model's forecast, as forecasters of a campaign.

Source: Pathak et al., "Hybrid forecasting of chaotic processes", Chaos 28 (2018) 041101. The
network receives each sample and the model's forecast of the next one, and learns what the model
misses. The model has the equations of the case with one parameter changed.
"""

from dataclasses import dataclass, replace
from itertools import product
from typing import ClassVar

import numpy as np

from burstcast.forecasters._filtered import FilteredForecaster
from burstcast.forecasters._square_root_filter import symmetric_members
from burstcast.forecasters.base import Forecaster, ForecasterRecord, fitted
from burstcast.forecasters.equations_noisy import EquationsFromObservation
from burstcast.networks.dynamics import Dynamics
from burstcast.networks.readout import MomentsAccumulator, solve_ridge
from burstcast.networks.reservoir import ReservoirSeed

CHOSEN = ("spectral_radius", "input_scaling", "tikhonov")
"""Hyperparameters that closed loops of the training series choose."""
_SAVED = ("scale", "weights", "chosen")
_VALIDATED, _REACH_LT, _SPACING_LT = 4, 3, 2
"""Training series that choose, length of their closed loops, and distance of the starts, in LT."""
_SYNCHRONISATION = 12
"""Steps that the first observation drives the members of a filter."""
_DIVERGED = 2.0
"""Distance from zero, in ranges of a component, beyond which forecasts are held."""


@dataclass(frozen=True, kw_only=True)
class HybridOptions:
    """Options of hybrid networks. Several values: chosen in training."""

    parameter: str = "length_x"  #: of the equations, which the model has wrong
    factor: float = 1.05  #: the model's value of it over the true one
    neurons: int = 500
    input_bias: float = 1.0
    connectivity: float = 20.0  #: inputs of a neuron from others, on average
    washout_lt: float = 0.5  #: beginning of each series that training leaves out
    spectral_radius: tuple[float, ...] = (0.1, 0.3)
    input_scaling: tuple[float, ...] = (0.05, 0.15, 0.5)
    tikhonov: tuple[float, ...] = (1e-6, 1e-9, 1e-12)
    seed: int = 0


@dataclass(frozen=True)
class HybridNetwork(HybridOptions, Forecaster):
    """Next sample = the model's forecast + weights . [neurons, the model's forecast, 1]."""

    needs_equations: ClassVar[bool] = True

    model: Forecaster = fitted()
    dynamics: Dynamics = fitted()
    scale: np.ndarray = fitted()  #: range of each component in training, ``(dimension,)``
    weights: np.ndarray = fitted()  #: of neurons, model and bias, ``(neurons + dim + 1, dim)``
    chosen: np.ndarray = fitted()  #: values of `CHOSEN`

    def fit(self, training, case):
        """Choose hyperparameters, and train the readout on all series."""
        unit = case.steps_per_lyapunov_time
        washout = int(self.washout_lt * unit)
        scale = np.ptp(training, axis=(0, 1))
        untrained = self.with_fitted(model=self._model(case), scale=scale)
        series = np.ascontiguousarray(training.transpose(1, 2, 0))
        forecasts = np.stack([untrained.modelled(states) for states in series[:-1]])
        best, lowest = None, np.inf
        choice = len([*product(*(getattr(self, name) for name in CHOSEN))]) > 1
        for radius, scaling in product(self.spectral_radius, self.input_scaling):
            dynamics = self._dynamics(len(scale), radius, scaling)
            moments = untrained._moments(dynamics, series, forecasts, washout)
            for tikhonov in self.tikhonov:
                network = untrained.with_fitted(
                    dynamics=dynamics,
                    weights=solve_ridge(moments, tikhonov).weights,
                    chosen=np.array([radius, scaling, tikhonov]),
                )
                error = network._error(training[:_VALIDATED], case, washout) if choice else 0.0
                if error < lowest:
                    best, lowest = network, error
        if best is None:
            raise ValueError("no closed loop of the training series is finite")
        return best

    def tuned(self):
        """Network that is trained with the hyperparameters that were chosen."""
        values = ((value,) for value in self.chosen.tolist())
        return replace(self, **dict(zip(CHOSEN, values, strict=True)))

    def record(self):
        """Weights and hyperparameters; reservoir and model follow from the options."""
        return ForecasterRecord({name: getattr(self, name) for name in _SAVED})

    def restore(self, record, case):
        """Make the reservoir and the model again."""
        arrays = {name: record.arrays[name] for name in _SAVED}
        radius, scaling, _ = arrays["chosen"].tolist()
        dynamics = self._dynamics(len(arrays["scale"]), radius, scaling)
        return self.with_fitted(model=self._model(case), dynamics=dynamics, **arrays)

    def modelled(self, states):
        """The model's forecast one sample ahead, ``(dimension, batch)``."""
        return self.model.advance(np.ascontiguousarray(states), 1)[0][0]

    def start(self, washout):
        """Neurons after the washout, and the model's forecast of the next sample."""
        neurons = np.zeros((self.neurons, washout.shape[2]))
        for observed in washout:
            forecast = self.modelled(observed)
            neurons = self._driven(neurons, observed, forecast)
        return np.concatenate([neurons, forecast])

    def advance(self, memory, steps):
        """Closed loop."""
        neurons, forecast = memory[: self.neurons], memory[self.neurons :]
        bound = _DIVERGED * self.scale[:, np.newaxis]
        outputs = np.empty((steps, *forecast.shape))
        for step in range(steps):
            features = self._features(self.dynamics, neurons, forecast)
            missed = self.weights[:-1].T @ features + self.weights[-1][:, np.newaxis]
            # the equations of a flow that is far from any state of it end in infinities
            outputs[step] = np.clip(forecast + missed, -bound, bound)
            forecast = self.modelled(outputs[step])
            neurons = self._driven(neurons, outputs[step], forecast)
        return outputs, np.concatenate([neurons, forecast])

    def _model(self, case):
        """The equations with the wrong parameter."""
        if not hasattr(case.system, self.parameter):
            raise ValueError(
                f"{type(case.system).__name__} has no parameter {self.parameter!r}: parameter must "
                "be one of the equations of the case"
            )
        wrong = {self.parameter: self.factor * getattr(case.system, self.parameter)}
        another = replace(case, system=replace(case.system, **wrong))
        return EquationsFromObservation().restore(ForecasterRecord({}), another)

    def _dynamics(self, dimension, radius, scaling):
        drawn = 0, self.neurons, self.seed, self.connectivity, self.input_bias
        reservoir = ReservoirSeed(*drawn).reservoir(2 * dimension)
        return Dynamics(reservoir, radius, scaling, readout="quadratic")

    def _driven(self, neurons, observed, forecast):
        """Neurons after one more sample and the model's forecast of the next."""
        inputs = np.concatenate([observed, forecast]) / np.tile(self.scale, 2)[:, np.newaxis]
        return self.dynamics.open_loop(inputs[np.newaxis], neurons)

    def _features(self, dynamics, neurons, forecast):
        return np.concatenate([dynamics.features(neurons), forecast / self.scale[:, np.newaxis]])

    def _moments(self, dynamics, series, forecasts, washout):
        """Moments of the features and of what the model has missed."""
        dimension = len(self.scale)
        sums = MomentsAccumulator(self.neurons + dimension, dimension)
        inputs = np.concatenate([series[:-1], forecasts], axis=1)
        inputs /= np.tile(self.scale, 2)[:, np.newaxis]
        for panel in dynamics.state_panels(inputs, breakpoints=[washout]):
            if panel.start < washout:
                continue
            rows = slice(panel.start, panel.stop)
            modelled, following = (
                part.transpose(1, 0, 2).reshape(dimension, -1)
                for part in (forecasts[rows], series[1:][rows])
            )
            sums.add(self._features(dynamics, panel.columns, modelled), following - modelled)
        return sums.moments()

    def _error(self, series, case, washout):
        """Mean log10 square error of the observable in closed loops of the training series."""
        unit = case.steps_per_lyapunov_time
        reach = min(_REACH_LT * unit, series.shape[1] - washout - 1)
        starts = np.arange(washout, series.shape[1] - reach, _SPACING_LT * unit)
        seen = np.concatenate([series[:, at - washout : at] for at in starts])
        true = np.concatenate([series[:, at : at + reach] for at in starts])
        states, _ = self.advance(self.start(seen.transpose(1, 2, 0)), reach)
        observable = case.system.observable
        error = observable(states.transpose(1, 0, 2)) - observable(true.transpose(2, 1, 0))
        return np.log10(np.clip(np.square(error).mean(axis=0), 1e-12, 1e12)).mean()


@dataclass(frozen=True)
class FilteredHybridNetwork(HybridOptions, FilteredForecaster):
    """The same, started from the estimate of a filter that uses it.

    The filter's inflation is chosen by the innovations in the training series. It corrects neurons
    by their covariance with the forecast.
    """

    model_class: ClassVar[type[Forecaster]] = HybridNetwork
    needs_equations: ClassVar[bool] = True

    def first_members(self, observation):
        """Members around an observation, which their neurons have seen often enough."""
        states = symmetric_members(observation, self.errors, self.members)
        repeated = np.tile(states.reshape(1, len(states), -1), (_SYNCHRONISATION, 1, 1))
        return self.model.start(repeated)

    def tuned(self):
        """Forecaster with the inflation and the hyperparameters that were chosen."""
        tuned = self.model.tuned()
        chosen = {name: getattr(tuned, name) for name in CHOSEN}
        return replace(super().tuned(), **chosen)
