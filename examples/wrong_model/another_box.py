"""Equations of a box longer than the flow's, as forecasters of a campaign.

From the true state, with a filter, and with a filter that learns the error of the equations.
"""

from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from burstcast.base import random_streams
from burstcast.forecasters.base import Forecaster, fitted
from burstcast.forecasters.equations_filtered import FilteredEquations
from burstcast.forecasters.equations_noisy import EquationsFromObservation


@dataclass(frozen=True)
class EquationsOfAnotherBox(EquationsFromObservation):
    """The equations of the case but for the length of the box."""

    factor: float = 1.0  #: length of the box in units of the flow's

    def restore(self, record, case):
        """Take the equations of the case with another length."""
        length = self.factor * case.system.length_x
        another = replace(case, system=replace(case.system, length_x=length))
        return super().restore(record, another)


@dataclass(frozen=True)
class TrueStateOfAnotherBox(EquationsOfAnotherBox):
    """The same, started from the true state: what no filter of this model exceeds."""

    sees_truth: ClassVar[bool] = True


@dataclass(frozen=True)
class FilteredEquationsOfAnotherBox(FilteredEquations):
    """The same, started from the estimate of a filter that uses them, too."""

    factor: float = 1.0  #: length of the box in units of the flow's

    model_class: ClassVar[type[Forecaster]] = EquationsOfAnotherBox


SHARE = 0.02
"""Share of an innovation by which the variance of the additive error follows it."""
FIRST, LEAST = 0.2, 0.01
"""First and least standard deviation of the additive error, in units of the noise."""
START_UP = 50
"""Steps of the training series after which analysis increments are learnt from."""


@dataclass(frozen=True)
class CorrectedEquationsOfAnotherBox(EquationsOfAnotherBox):
    """The equations, with a quadratic correction of the state after each step of the forecast."""

    #: factors of the `monomials` of the state before the step, ``(dimension, monomials)``
    correction: np.ndarray = fitted()

    def restore(self, record, case):
        """Take the equations, and the correction of the record; none by default."""
        restored, none = super().restore(record, case), np.zeros((case.system.dimension, 0))
        return restored.with_fitted(correction=record.arrays.get("correction", none))

    def record(self):
        """Record of the correction."""
        return replace(super().record(), arrays={"correction": self.correction})

    def advance(self, memory, steps):
        """Integrate the equations, and correct the state after each step."""
        if not self.correction.size:
            return super().advance(memory, steps)
        outputs = []
        for _ in range(steps):
            following = super().advance(memory, 1)[1]
            memory = following + self.correction @ monomials(memory)
            outputs.append(memory)
        return np.stack(outputs), memory


def monomials(states):
    """Monomials of degree 2 at most of states ``(dimension, batch)``, ``(monomials, batch)``."""
    first, second = np.triu_indices(len(states))
    return np.concatenate([np.ones((1, states.shape[1])), states, states[first] * states[second]])


@dataclass(frozen=True)
class EstimateOfAnotherBox(FilteredEquationsOfAnotherBox):
    """The same; only the mean of the members forecasts, which takes less time than all of them."""

    provides_ensemble: ClassVar[bool] = False

    def start(self, washout):
        """Mean of the members after a washout."""
        return super().ensemble(washout).mean(axis=1)

    def ensemble(self, washout):
        """The mean alone."""
        return self.start(washout)[..., np.newaxis, :]

    def combined(self, ensemble):
        """Memory of the mean."""
        return ensemble[..., 0, :]


@dataclass(frozen=True)
class LearntErrorOfAnotherBox(EstimateOfAnotherBox):
    """Without inflation, but with a random error of each member in each step.

    The variance of this additive error follows the innovations in the training series, as for
    `esn_filtered`. ``rounds``: How often a correction of the equations is learnt from the analysis
    increments, states after an observation less states before it, of these series: their
    least-squares quadratic function of the state one step before.
    """

    model_class: ClassVar[type[Forecaster]] = CorrectedEquationsOfAnotherBox

    inflation: float | None = 1.0
    rounds: int = 0

    model_error: np.ndarray = fitted()  #: standard deviation of the error, ``(dimension,)``

    def fit(self, training, case):
        """Filter the training series, correct the equations, and filter again."""
        filtered, series = super().fit(training, case), training.transpose(1, 2, 0)
        for number in range(self.rounds + 1):
            before, increments, error = filtered._followed(series)
            if number < self.rounds:
                learnt = np.linalg.lstsq(monomials(before).T, increments.T, rcond=None)[0].T
                earlier = filtered.model.correction
                model = filtered.model.with_fitted(
                    correction=learnt + earlier if earlier.size else learnt
                )
                filtered = filtered.with_fitted(model=model)
        return filtered.with_fitted(model_error=error)

    def _followed(self, series):
        """States, the increments after one step, ``(dimension, points)``, and the error."""
        numbers, noise = _numbers(len(self.errors), self.members), np.square(self.errors)
        variance, total = FIRST**2 * noise, np.zeros(len(noise))
        members = self.first_members(series[0]).reshape(len(noise), self.members, -1)
        before, increments, counted = [], [], len(series) // 2
        for step, observation in enumerate(series[1:], start=1):
            earlier = members.mean(axis=1)
            members = self._moved(members, variance, numbers)
            forecast = members.mean(axis=1)
            off = np.square(observation - forecast).mean(axis=1)
            expected = members.var(axis=1, ddof=1).mean(axis=1) + noise
            variance = np.maximum(variance + SHARE * (off - expected), LEAST**2 * noise)
            total += variance if step >= len(series) - counted else 0.0
            members = self.corrected(members, observation)
            if step > START_UP:
                before.append(earlier)
                increments.append(members.mean(axis=1) - forecast)
        return (
            np.concatenate(before, axis=1),
            np.concatenate(increments, axis=1),
            np.sqrt(total / counted),
        )

    def _moved(self, members, variance, numbers):
        """Members ``(dimension, members, batch)`` one step later, with their errors."""
        moved = self.model.advance(members.reshape(len(members), -1), 1)[1].reshape(members.shape)
        return moved + np.sqrt(variance)[:, np.newaxis, np.newaxis] * next(numbers)

    def record(self):
        """Record of the filter, and the error."""
        record = super().record()
        return replace(record, arrays={**record.arrays, "model_error": self.model_error})

    def restore(self, record, case):
        """Restore the filter and the error."""
        restored = super().restore(record, case)
        return restored.with_fitted(model_error=record.arrays["model_error"])

    def start(self, washout):
        """Mean of the members after a washout, in each step of which they have their errors."""
        numbers = _numbers(len(self.errors), self.members)
        shape = len(self.errors), self.members, washout.shape[2]
        members = self.first_members(washout[0]).reshape(shape)
        for observation in washout[1:]:
            members = self._moved(members, np.square(self.model_error), numbers)
            members = self.corrected(members, observation)
        return members.mean(axis=1)


def _numbers(dimension, members):
    """Normal numbers of each step in pairs of opposite signs, the same for all washouts."""
    generator = random_streams.stream(2022, "additive error", dimension, members)
    while True:
        half = generator.standard_normal((dimension, members // 2, 1))
        yield np.concatenate([half, -half], axis=1)
