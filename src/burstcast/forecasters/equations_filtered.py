"""The equations, started from the estimate of a filter over the washout.

The limit for forecasts from noisy observations: a perfect model and a nearly perfect estimate.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import numpy as np

from burstcast.base.arrays import FloatArray
from burstcast.data.encoders._moments import kalman_gain
from burstcast.data.encoders.state_maps import StateMaps
from burstcast.forecasters._filtered import FilteredForecaster
from burstcast.forecasters._square_root_filter import mean, symmetric_members
from burstcast.forecasters.base import Forecaster
from burstcast.forecasters.equations_noisy import EquationsFromObservation

STATIC_SHARE = 1e-3
"""Share of the covariance of the states that the static gain takes for the covariance of the error.

Estimates of a turbulent flow from sensors (docs/sensors.md) are equally good for 3e-4 to 3e-3."""


@dataclass(frozen=True)
class FilteredEquations(FilteredForecaster):
    """Integrates the equations from the estimate of an ensemble filter.

    If the case has encoded states of a flow, or observes it by sensors, the ensemble starts in the
    leading directions of the error of the first estimate. Where members are fewer than twice the
    components of a state, they cannot correct all directions of error: a static gain, made of the
    covariance of the states over a long time, corrects their mean for the remaining innovation (the
    hybrid gain of Penny, "The hybrid local ensemble transform Kalman filter", Monthly Weather
    Review 142, 2014).
    """

    needs_equations: ClassVar[bool] = True
    aware: ClassVar[bool] = True
    model_class: ClassVar[type[Forecaster]] = EquationsFromObservation

    @property
    def _maps(self) -> StateMaps | None:
        assert isinstance(self.model, EquationsFromObservation)
        return self.model.maps

    @cached_property
    def _static_gain(self) -> FloatArray:
        assert self._maps is not None
        covariance = STATIC_SHARE * self._maps.covariance
        return kalman_gain(covariance, self._maps.matrix, self.errors[:-1])

    def first_members(self, observation: FloatArray) -> FloatArray:
        """Members around an estimate of the state (see `FilteredForecaster.first_members`)."""
        if self._maps is None:
            return super().first_members(observation)
        pairs, errors = self.members // 2, self._maps.error_covariance(self.errors[:-1])
        directions = leading_directions(errors, pairs)
        count = directions.shape[1]
        apart = symmetric_members(np.zeros((count, 1)), np.ones(count), self.members)[..., 0]
        estimate = self._maps.estimates(observation[:-1])
        members = estimate[:, np.newaxis] + (directions @ apart)[:, :, np.newaxis]
        return np.ascontiguousarray(members.reshape(len(estimate), -1))

    def corrected(self, ensemble: FloatArray, observation: FloatArray) -> FloatArray:
        """Members after an observation; the static gain corrects the mean of few of them."""
        updated = super().corrected(ensemble, observation)
        if self._maps is not None and self.members < 2 * len(self._maps.gain):
            channels = len(observation) - 1
            left = observation[:-1] - mean(updated[:channels])
            updated[channels + 1 :] += (self._static_gain @ left)[:, np.newaxis]
        return updated


def leading_directions(covariance: FloatArray, count: int) -> FloatArray:
    """Directions in which errors are largest, each as long as its standard deviation.

    ``covariance``: Covariance of the errors, ``(dimension, dimension)``. Shape ``(dimension,
    count)``; the largest entry of each is positive.
    """
    variances, eigenvectors = np.linalg.eigh(covariance)
    leading = eigenvectors[:, ::-1][:, :count]
    largest = np.argmax(np.abs(leading), axis=0)
    signs = np.sign(leading[largest, np.arange(leading.shape[1])])
    scale = np.sqrt(np.maximum(variances[::-1][:count], 0.0))
    directions: FloatArray = leading * signs * scale
    return directions
