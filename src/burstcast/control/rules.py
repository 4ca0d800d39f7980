"""Entries of the benchmark of controllers: rules without a model, and actions by forecasts."""

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from burstcast.base.arrays import FloatArray
from burstcast.control.controller import Controller, ControlTask
from burstcast.control.strategies.reactive import quantity
from burstcast.forecasters._event_classifier import EventClassifier, LabelledPoints
from burstcast.forecasters._square_root_filter import assimilate
from burstcast.forecasters.base import Forecaster, ForecastingCase
from burstcast.forecasters.registry import as_forecaster, make_kind


@dataclass
class NoAction(Controller):
    """Never acts."""

    def observe(self, observations: FloatArray) -> None:
        """Note how many flows there are."""
        self._flows = observations.shape[-1]

    def act(self) -> FloatArray:
        """No action."""
        return np.zeros((self.task.actuators, self._flows))


@dataclass
class WhileHigh(Controller):
    """Acts while a quantity is at or above a level, or one of two quantities.

    Quantities are expressions of components and of the observable, as in the strategy `reactive`.
    """

    level: float
    watch: str = "observable"
    second_watch: str = ""
    second_level: float = np.inf

    def observe(self, observations: FloatArray) -> None:
        """Evaluate the quantities now."""
        now = observations[-1]
        high = quantity(self.watch, self.task.space)(now) >= self.level
        if self.second_watch:
            high |= quantity(self.second_watch, self.task.space)(now) >= self.second_level
        self._high = high

    def act(self) -> FloatArray:
        """Full action where a quantity is high."""
        return np.where(self._high, self.task.limit, 0.0)[np.newaxis]


@dataclass
class WhileRising(Controller):
    """Acts where the observable, extrapolated along its slope, reaches a level.

    The slope is that of a straight line through the observations of the window.
    """

    level: float
    ahead: float  #: time of the extrapolation, in time units

    def begin(self, task: ControlTask, flows: int) -> None:
        """Check that there is a slope."""
        if task.window < 2:
            raise ValueError("a slope needs a window of two observations at least")
        self.task = task

    def observe(self, observations: FloatArray) -> None:
        """Fit the line."""
        observable = self.task.space.observable(observations.transpose(1, 0, 2))
        time = self.task.interval * (np.arange(len(observable)) - (len(observable) - 1))
        centred = time - time.mean()
        slope = (centred[:, np.newaxis] * observable).sum(axis=0) / np.square(centred).sum()
        self._ahead = observable.mean(axis=0) + slope * (self.ahead - time.mean())

    def act(self) -> FloatArray:
        """Full action where the line reaches the level."""
        return np.where(self._ahead >= self.level, self.task.limit, 0.0)[np.newaxis]


@dataclass
class ForecastTriggered(Controller):
    """Acts where a forecast of the free flow reaches the threshold within a horizon."""

    horizon: float  #: in time units
    model: str = "equations_noisy"  #: kind of forecaster, with its default options

    def begin(self, task: ControlTask, flows: int) -> None:
        """Fit the model."""
        self.task = task
        self._model = fitted_model(self.model, task)

    def observe(self, observations: FloatArray) -> None:
        """Forecast from the observed window."""
        steps = round(self.horizon / self.task.interval)
        outputs, _ = self._model.advance(self._model.start(observations), steps)
        ahead = self.task.space.observable(outputs.transpose(1, 0, 2))
        self._reached = (ahead >= self.task.threshold).any(axis=0)

    def act(self) -> FloatArray:
        """Full action where the forecast reaches the threshold."""
        return np.where(self._reached, self.task.limit, 0.0)[np.newaxis]


@dataclass
class ClassifierTriggered(Controller):
    """Acts where a classifier gives an event within a horizon a probability, or a higher one."""

    horizon: float  #: in time units
    probability: float
    kind: str = "precursor"  #: kind of classifier, with its default options

    def begin(self, task: ControlTask, flows: int) -> None:
        """Fit the classifier to whether the series without control reach the threshold."""
        self.task = task
        ahead = round(self.horizon / task.interval)
        series, length, _ = task.training.shape
        points = np.arange(task.window - 1, length - ahead, max(task.between // 2, 1))
        if not points.size:
            raise ValueError(f"series of {length} samples are too short for a horizon of {ahead}")
        observable = task.space.observable(task.training.transpose(2, 0, 1))
        reached = [observable[:, at + 1 : at + 1 + ahead].max(axis=1) for at in points]
        washouts = [task.training[:, at + 1 - task.window : at + 1] for at in points]
        labelled = LabelledPoints(
            np.concatenate(washouts),
            np.concatenate(reached)[:, np.newaxis] >= task.threshold,
            np.tile(np.arange(series), len(points)),
        )
        classifier = make_kind(self.kind, {})
        if not isinstance(classifier, EventClassifier):
            raise ValueError(f"{self.kind} gives no probability of an event: take a classifier")
        self._classifier = classifier.fit(labelled, _forecasting_case(task))

    def observe(self, observations: FloatArray) -> None:
        """Ask the classifier about the observed window."""
        washouts = np.ascontiguousarray(observations.transpose(2, 0, 1))
        self._probable = self._classifier.probabilities(washouts)[:, 0] >= self.probability

    def act(self) -> FloatArray:
        """Full action where the event is probable."""
        return np.where(self._probable, self.task.limit, 0.0)[np.newaxis]


@dataclass
class LocalInterventions(Controller):
    """Tries one intervention after the other in an ensemble of forecasts, and takes the best.

    An ensemble filter estimates the state. Where any of ``scenarios`` members forecasts an event
    within the horizon, each single intervention, up or down at each actuator, is forecast with the
    same members. The best one leaves the fewest members with an event, and of several the lowest
    mean peak. With two sites, a second one is added to the first in the same way (after Mitsui et
    al. 2025).
    """

    horizon: float = 1.0  #: in time units: five days
    #: kind of forecaster, with its default options, that needs one state alone
    model: str = "equations_noisy"
    members: int = 40  #: of the filter
    scenarios: int = 10  #: members that forecast
    inflation: float = 1.03
    seed: int = 0
    _ensemble: Any = field(init=False, repr=False, default=None)

    def begin(self, task: ControlTask, flows: int) -> None:
        """Fit the model and forget the ensemble."""
        self.task, self._ensemble = task, None
        self._generator = np.random.default_rng(self.seed)
        self._model = fitted_model(self.model, task)

    def observe(self, observations: FloatArray) -> None:
        """Advance the ensemble to the present and assimilate the observation."""
        now = observations[-1]
        if self._ensemble is None:
            noise = self._generator.standard_normal((len(now), self.members, now.shape[1]))
            self._ensemble = now[:, np.newaxis] + self.task.noise[:, np.newaxis, np.newaxis] * noise
            return
        before = self._ensemble.reshape(len(now), -1)
        forecast = self._advance(before, self.task.between)[-1].reshape(self._ensemble.shape)
        self._ensemble = assimilate(forecast, now, self.task.noise, self.inflation)

    def act(self) -> FloatArray:
        """The best intervention for each flow."""
        dimension, _, flows = self._ensemble.shape
        action = np.zeros((dimension, flows))
        members = self._ensemble[:, : self.scenarios]
        peaks = self._peaks(members)
        danger = np.flatnonzero((peaks >= self.task.threshold).any(axis=0))
        for start in range(0, len(danger), 8):
            some = danger[start : start + 8]
            for _ in range(self.task.most):
                action[:, some] = self._improved(members[..., some], action[:, some])
        self._ensemble = self._ensemble + action[:, np.newaxis]
        return action

    def _improved(self, members: FloatArray, action: FloatArray) -> FloatArray:
        """Actions with one more intervention, where that is better."""
        dimension, number, flows = members.shape
        single = np.concatenate([np.eye(dimension), -np.eye(dimension)]) * self.task.limit
        candidates = action + np.concatenate([np.zeros((1, dimension)), single])[..., np.newaxis]
        # a variable that is pushed already stays as it is
        taken = (action != 0) & (single != 0)[..., np.newaxis]
        allowed = np.concatenate([np.ones((1, flows), dtype=bool), ~taken.any(axis=1)])
        states = members[np.newaxis] + candidates[:, :, np.newaxis]
        peaks = self._peaks(np.moveaxis(states, 0, 1).reshape(dimension, -1, flows))
        by_member = peaks.reshape(len(candidates), number, flows)
        events = (by_member >= self.task.threshold).sum(axis=1)
        score = np.where(allowed, events + 1e-3 * by_member.mean(axis=1), np.inf)
        best = score.argmin(axis=0)
        return np.asarray(candidates[best, :, np.arange(flows)].T)

    def _peaks(self, states: FloatArray) -> FloatArray:
        """Largest observable of forecasts within the horizon, ``(members, flows)``."""
        steps = round(self.horizon / self.task.interval)
        ahead = self._advance(states.reshape(len(states), -1), steps).transpose(1, 0, 2)
        peaks = self.task.space.observable(ahead).max(axis=0)
        return np.asarray(peaks.reshape(states.shape[1:]))

    def _advance(self, states: FloatArray, steps: int) -> FloatArray:
        memory = self._model.start(np.ascontiguousarray(states)[np.newaxis])
        return self._model.advance(memory, steps)[0]


def fitted_model(model: str | Forecaster, task: ControlTask) -> Forecaster:
    """Model of a controller, fitted to the task's series: of a kind, or as it is given."""
    unfitted = as_forecaster(make_kind(model, {})) if isinstance(model, str) else model
    return unfitted.fit(task.training, _forecasting_case(task))


def _forecasting_case(task: ControlTask) -> ForecastingCase:
    step, number = task.interval / task.stride, task.steps_per_lyapunov_time
    return ForecastingCase(task.equations, step, task.stride, number)
