"""Nonlinear vector autoregression, also called next-generation reservoir computing.

The increment to the next state is linear in the last states and in all products of two of their
components, by ridge regression with a fixed penalty. Source: Gauthier, Bollt, Griffith and Barbosa,
"Next generation reservoir computing", Nature Communications 12 (2021) 5564.
"""

from dataclasses import dataclass
from typing import Self

import numpy as np

from burstcast.base.arrays import FloatArray
from burstcast.base.series_lengths import samples_of, series_lengths
from burstcast.forecasters._options import NVAROptions
from burstcast.forecasters.base import Forecaster, ForecastingCase, fitted


@dataclass(frozen=True)
class NVAR(NVAROptions, Forecaster):
    """Next state = last state + weights . [1, last states, their products]."""

    weights: FloatArray = fitted()  #: of standardised states, ``(features, dimension)``
    mean: FloatArray = fitted()  #: mean of each component in training
    scale: FloatArray = fitted()  #: standard deviation of each component

    def __post_init__(self) -> None:
        if self.lags < 1:
            raise ValueError(f"lags must be 1 at least, not {self.lags}")
        if not self.ridge > 0:
            raise ValueError(f"ridge must be above 0, not {self.ridge}")

    def fit(self, training: FloatArray, case: ForecastingCase) -> Self:
        """Ridge regression over all steps of all series (see `Forecaster.fit`)."""
        if training.shape[1] <= self.lags:
            raise ValueError(f"{self.lags} lags take series of more than {self.lags} samples")
        training = np.ascontiguousarray(training)  # sums depend on the layout in their last bits
        samples = samples_of(training)
        mean, scale = samples.mean(axis=0), samples.std(axis=0)
        scale = np.where(scale > 0, scale, 1.0)
        series = ((training - mean) / scale).transpose(1, 2, 0)
        count, dimension, _ = series.shape
        past = [series[self.lags - 1 - lag : count - 1 - lag] for lag in range(self.lags)]
        memory = np.concatenate(past, axis=1).transpose(1, 0, 2).reshape(self.lags * dimension, -1)
        increments = np.diff(series[self.lags - 1 :], axis=0)
        wanted = increments.transpose(1, 0, 2).reshape(dimension, -1)
        if series_lengths(training) is not None:
            there = ~np.isnan(wanted[0])
            memory, wanted = memory[:, there], wanted[:, there]
        features = _features(memory)
        gram = features @ features.T / len(wanted.T) + self.ridge * np.eye(len(features))
        weights = np.linalg.solve(gram, features @ wanted.T / len(wanted.T))
        return self.with_fitted(weights=weights, mean=mean, scale=scale)

    def start(self, washout: FloatArray) -> FloatArray:
        """Last observed states, the latest first, ``(lags * dimension, batch)``."""
        if len(washout) < self.lags:
            raise ValueError(f"{self.lags} lags take a washout of {self.lags} steps at least")
        latest = washout[::-1][: self.lags]
        states = (latest - self.mean[:, np.newaxis]) / self.scale[:, np.newaxis]
        return np.ascontiguousarray(states.reshape(-1, washout.shape[2]))

    def advance(self, memory: FloatArray, steps: int) -> tuple[FloatArray, FloatArray]:
        """Apply the map again and again (see `Forecaster.advance`)."""
        dimension = len(self.mean)
        outputs = np.empty((steps, dimension, memory.shape[1]))
        for step in range(steps):
            following = memory[:dimension].copy()
            # feature by feature: a product of matrices sums in an order that depends on the batch
            for weight, feature in zip(self.weights, _features(memory), strict=True):
                following += np.multiply.outer(weight, feature)
            memory = np.concatenate([following, memory[:-dimension]])
            outputs[step] = following * self.scale[:, np.newaxis] + self.mean[:, np.newaxis]
        return outputs, memory


def _features(memory: FloatArray) -> FloatArray:
    """One, all rows of memories ``(rows, batch)``, and the products of two of them."""
    first, second = np.triu_indices(len(memory))
    return np.concatenate([np.ones((1, memory.shape[1])), memory, memory[first] * memory[second]])
