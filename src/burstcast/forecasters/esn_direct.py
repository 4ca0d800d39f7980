"""A reservoir with a logistic readout that is trained on event labels.

The reservoir of an echo state network is driven by the observed washout. Its state at the starting
point gives the probability of an event in each window; there is no closed loop.
"""

import warnings
from dataclasses import dataclass, replace
from itertools import product
from typing import Literal, Self

import numpy as np

from burstcast.base.arrays import BoolArray, FloatArray
from burstcast.data.dataset import network_input_offset
from burstcast.forecasters._event_classifier import (
    EventClassifier,
    LabelledPoints,
    with_exogenous,
)
from burstcast.forecasters._logistic_readout import event_probability, fit_logistic
from burstcast.forecasters._options import DirectReadoutOptions, NetworkOptions
from burstcast.forecasters._reservoirs import (
    recorded_dynamics,
    recorded_scales,
    restored_dynamics,
)
from burstcast.forecasters.base import ForecasterRecord, ForecastingCase, fitted
from burstcast.networks.dynamics import Dynamics
from burstcast.networks.reservoir import ReservoirSeed

_SEARCHED = ("spectral_radius", "input_scaling", "leak_rate", "penalty")
_HELD_OUT = 3
"""Every third training series validates the choice of hyperparameters."""
_POINTS_PER_BATCH = 1024


@dataclass(frozen=True)
class DirectReadout(NetworkOptions, DirectReadoutOptions, EventClassifier):
    """Probabilities from the state of a reservoir after the washout."""

    # squares of neurons improve closed loops, but not classifiers of measured records
    readout: Literal["linear", "quadratic"] = "linear"

    dynamics: Dynamics = fitted()  #: reservoir with its hyperparameters
    seed: ReservoirSeed = fitted()  #: seed and settings that determine the reservoir
    #: range of each observed component in training, by which inputs are divided
    input_scale: FloatArray = fitted()
    #: mean of each observed component in training, subtracted from inputs; None: no mean is
    input_mean: FloatArray | None = fitted()
    #: weights of the neurons, of features known in advance, and of the bias (last), for each
    #: window, ``(neurons + known features + 1, windows)``
    weights: FloatArray = fitted()
    chosen_penalty: float = fitted()  #: chosen entry of ``penalty``

    def fit(self, points: LabelledPoints, case: ForecastingCase) -> Self:
        """Choose hyperparameters where several are given, and fit the readout to all points.

        The choice maximises the average precision on every third training series, averaged over
        windows, of readouts fitted to the other series.
        """
        drawn = case.random_seed, self.neurons, 0, self.connectivity, self.input_bias
        seed = ReservoirSeed(*drawn)
        observed = points.washouts
        first = points.series == points.series.min()
        ranged = observed[first] if self.input_range == "first" else observed
        input_scale = np.ptp(ranged.reshape(-1, observed.shape[2]), axis=0)
        input_mean = network_input_offset(observed, self.input_offset)
        inputs = _normalised(observed, input_scale, input_mean)
        reservoir = seed.reservoir(observed.shape[2])
        choices = [getattr(self, name) for name in _SEARCHED]
        *applied, penalties = choices
        best, highest = [some[0] for some in choices], -np.inf

        def driven(radius: float, scaling: float, leak_rate: float) -> Dynamics:
            return Dynamics(reservoir, radius, scaling, self.backend, leak_rate, self.readout)

        several = np.prod([len(some) for some in choices]) > 1
        for point in product(*applied) if several else ():
            dynamics = driven(*point)
            states = with_exogenous(_states(dynamics, inputs), points.exogenous)
            for penalty in penalties:
                score = _validation_score(states, points, penalty)
                if score > highest:
                    best, highest = [*point, penalty], score
        if several and highest <= 0:
            warnings.warn(
                "esn_direct cannot choose among hyperparameters and takes the first of each: no "
                "prediction window has events in every third training series and in the others",
                stacklevel=2,
            )
        *chosen, penalty = best
        dynamics = driven(*chosen)
        states = with_exogenous(_states(dynamics, inputs), points.exogenous)
        weights = fit_logistic(states, points.happened, penalty)
        return self.with_fitted(
            dynamics=dynamics,
            seed=seed,
            input_scale=input_scale,
            input_mean=input_mean,
            weights=weights,
            chosen_penalty=float(penalty),
        )

    def tuned(self) -> Self:
        """Classifier with the chosen hyperparameters alone (see `EventClassifier.tuned`)."""
        return replace(
            self,
            spectral_radius=(self.dynamics.spectral_radius,),
            input_scaling=(self.dynamics.input_scaling,),
            leak_rate=(self.dynamics.leak_rate,),
            penalty=(self.chosen_penalty,),
        )

    def probabilities(
        self, washouts: FloatArray, exogenous: FloatArray | None = None
    ) -> FloatArray:
        """Probability of an event in each window (see `EventClassifier.probabilities`)."""
        inputs = _normalised(washouts, self.input_scale, self.input_mean)
        states = _states(self.dynamics, inputs)
        return event_probability(self.weights, with_exogenous(states, exogenous))

    def record(self) -> ForecasterRecord:
        """Readout, normalisation and seed of the reservoir, without large matrices."""
        return ForecasterRecord(
            {"weights": self.weights, **recorded_scales(self.input_scale, self.input_mean)},
            {
                **recorded_dynamics(self.seed, self.dynamics),
                "penalty": self.chosen_penalty,
            },
        )

    def restore(self, record: ForecasterRecord, case: ForecastingCase) -> Self:
        """Regenerate the reservoir from its seed, and attach the recorded readout."""
        attributes, input_scale = record.attributes, record.arrays["input_range"]
        seed, dynamics = restored_dynamics(attributes, len(input_scale), self.backend)
        return self.with_fitted(
            dynamics=dynamics,
            seed=seed,
            input_scale=input_scale,
            input_mean=record.arrays.get("input_offset"),
            weights=np.ascontiguousarray(record.arrays["weights"]),
            chosen_penalty=float(attributes["penalty"]),
        )


def _normalised(
    washouts: FloatArray, input_scale: FloatArray, input_mean: FloatArray | None
) -> FloatArray:
    """Washouts ``(points, steps, dimension)`` as inputs of the reservoir."""
    centred = washouts if input_mean is None else washouts - input_mean
    return np.asarray(centred / input_scale)


def _states(dynamics: Dynamics, washouts: FloatArray) -> FloatArray:
    """States after washouts ``(points, steps, dimension)``, ``(points, neurons)``."""
    features = []
    for first in range(0, len(washouts), _POINTS_PER_BATCH):
        batch = washouts[first : first + _POINTS_PER_BATCH].transpose(1, 2, 0)
        features.append(dynamics.features(dynamics.open_loop(np.ascontiguousarray(batch), None)).T)
    return np.concatenate(features)


def _validation_score(states: FloatArray, points: LabelledPoints, penalty: float) -> float:
    """Average precision on every third series, fitted to the others; mean over windows.

    It depends only on the order of the probabilities, which calibration preserves. Windows without
    an event in either part are left out.
    """
    held_out = np.isin(points.series, np.unique(points.series)[::_HELD_OUT])
    learnt, happened = points.happened[~held_out], points.happened[held_out]
    both = learnt.any(axis=0) & happened.any(axis=0)
    if not both.any():
        return 0.0
    weights = fit_logistic(states[~held_out], learnt[:, both], penalty)
    chance = event_probability(weights, states[held_out])
    scores = [
        _average_precision(given, events)
        for given, events in zip(chance.T, happened[:, both].T, strict=True)
    ]
    return float(np.mean(scores))


def _average_precision(probabilities: FloatArray, happened: BoolArray) -> float:
    """Area below the precision-recall curve of points, both ``(points,)``, with an event."""
    _, level = np.unique(-probabilities, return_inverse=True)
    alarms = np.cumsum(np.bincount(level))
    events = np.bincount(level, weights=happened)
    return float((events * (np.cumsum(events) / alarms)).sum() / events.sum())
