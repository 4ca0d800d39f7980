"""A linear inverse model: the best linear map from one observed state to the next.

The simplest forecaster that learns: what it misses is what nonlinearity adds. Source: Penland,
"Random forcing and forecasting using principal oscillation pattern analysis", Monthly Weather
Review 117 (1989); here with a constant, and fitted by least squares over single steps.
"""

from dataclasses import dataclass
from typing import Self

import numpy as np

from burstcast.base.arrays import FloatArray
from burstcast.base.series_lengths import series_lengths
from burstcast.forecasters.base import Forecaster, ForecastingCase, fitted


@dataclass(frozen=True)
class LinearInverseModel(Forecaster):
    """Next state = propagator @ state + constant."""

    propagator: FloatArray = fitted()  #: ``(dimension, dimension)``
    constant: FloatArray = fitted()  #: ``(dimension,)``

    def __repr__(self) -> str:
        components = "" if self.constant is None else f"{len(self.constant)} components"
        return f"LinearInverseModel({components})"

    def fit(self, training: FloatArray, case: ForecastingCase) -> Self:
        """Fit the map by least squares over all steps of all series (see `Forecaster.fit`)."""
        dimension = training.shape[2]
        now = training[:, :-1].reshape(-1, dimension)
        following = training[:, 1:].reshape(-1, dimension)
        if series_lengths(training) is not None:
            there = ~np.isnan(following[:, 0])
            now, following = now[there], following[there]
        inputs = np.column_stack([now, np.ones(len(now))])
        weights = np.linalg.lstsq(inputs, following)[0]
        propagator = np.ascontiguousarray(weights[:-1].T)
        return self.with_fitted(propagator=propagator, constant=weights[-1])

    def start(self, washout: FloatArray) -> FloatArray:
        """Last observed state, ``(dimension, batch)``."""
        return np.ascontiguousarray(washout[-1])

    def advance(self, memory: FloatArray, steps: int) -> tuple[FloatArray, FloatArray]:
        """Apply the map again and again (see `Forecaster.advance`)."""
        outputs = np.empty((steps, *memory.shape))
        state = memory
        for step in range(steps):
            outputs[step] = state = self._propagated(state, self.constant)
        return outputs, state

    def advance_tangent(
        self, memory: FloatArray, tangent: FloatArray, steps: int
    ) -> tuple[FloatArray, FloatArray]:
        """Apply the propagator to perturbations, too (see `Forecaster.advance_tangent`)."""
        for _ in range(steps):
            memory = self._propagated(memory, self.constant)
            tangent = self._propagated(tangent, np.zeros_like(self.constant))
        return memory, tangent

    def _propagated(self, state: FloatArray, constant: FloatArray) -> FloatArray:
        """Propagator times states ``(dimension, ...)``, plus a constant."""
        trailing = (1,) * (state.ndim - 1)
        following = np.broadcast_to(constant.reshape(-1, *trailing), state.shape).copy()
        # component by component, and not by a product of matrices, whose order of summation
        # depends on how many forecasts run side by side
        for component, value in enumerate(state):
            following += np.multiply.outer(self.propagator[:, component], value)
        return following
