"""Arenas: flows on which controllers are compared, all with the same flows and the same noise.

`run_shear_flow` counts events in long runs (`burstcast.control.long_run`). `Lorenz96Arena` is after
the control simulation experiment of Sun, Miyoshi & Richard (Nonlinear Processes in Geophysics 30
(2023) 117), with the local interventions of Mitsui et al. (ibid. 32 (2025) 457).
"""

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from burstcast.base import random_streams
from burstcast.base.arrays import BoolArray, FloatArray, IntArray
from burstcast.control.controller import Controller, ControlTask
from burstcast.control.experiment import ControlExperiment
from burstcast.control.long_run import LongRunCounts, run_long
from burstcast.control.policy import Look, Policy
from burstcast.control.strategies.uncontrolled import Uncontrolled
from burstcast.systems.integration import integrate
from burstcast.systems.lorenz96 import Lorenz96


def checked_action(action: FloatArray, task: ControlTask, flows: int) -> FloatArray:
    """The action of a controller; ValueError if the task does not allow it."""
    action = np.asarray(action, dtype=np.float64)
    if action.shape != (task.actuators, flows):
        raise ValueError(
            f"act returns the shape {action.shape}, not (actuators, flows) "
            f"{(task.actuators, flows)}"
        )
    if not np.isfinite(action).all() or np.abs(action).max(initial=0.0) > task.limit * (1 + 1e-9):
        raise ValueError(f"act returns values beyond the limit of {task.limit:g}, or no numbers")
    if ((action != 0).sum(axis=0) > task.most).any():
        raise ValueError(f"act uses more than {task.most} of the actuators at once")
    return action


# -- the shear flow --------------------------------------------------------------------------------


def as_policy(controller: Controller, task: ControlTask) -> Policy:
    """Policy of a controller whose one actuator is on (1) or off (0)."""

    def decide(look: Look) -> BoolArray:
        controller.observe(look.washout)
        acts: BoolArray = checked_action(controller.act(), task, len(look.rows))[0] != 0
        return acts

    return decide


def run_shear_flow(
    controller: Controller,
    experiment: ControlExperiment,
    training: FloatArray,
    noise: FloatArray,
    *,
    decision_interval_lt: float,
    laminarisation_threshold: float | None,
) -> LongRunCounts:
    """Long run of a controller of a flow whose actuator is on or off, for return times.

    ``training``: Observed series without control, ``(series, time, components)``. ``noise``:
    Standard deviation of the observation noise, ``(components,)``. Return times are those of the
    counts (`burstcast.statistics.return_times`), for levels at and above the event threshold.
    """
    schedule = experiment.schedule
    timing = Uncontrolled(decision_interval_lt).timing(schedule)
    task = ControlTask(
        space=experiment.observed_space,
        threshold=experiment.threshold,
        interval=schedule.time_step * schedule.sampling_stride,
        stride=schedule.sampling_stride,
        steps_per_lyapunov_time=schedule.steps_per_lyapunov_time,
        between=timing.pauses[0],
        window=schedule.washout,
        noise=noise,
        actuators=1,
        limit=1.0,
        most=1,
        training=training,
        equations=experiment.system,
    )
    controller.begin(task, len(experiment.washouts))
    return run_long(
        experiment,
        timing,
        as_policy(controller, task),
        levels=[experiment.threshold],
        laminarisation_threshold=laminarisation_threshold,
        noise_scale=noise,
    )


# -- Lorenz 96 -------------------------------------------------------------------------------------


@dataclass(frozen=True)
class LargestVariable(Lorenz96):
    """The model of Lorenz whose observable is the largest of its variables."""

    def observable(self, state: FloatArray) -> FloatArray:
        """Largest variable, of shape ``(...)``."""
        return np.asarray(state.max(axis=0))


@dataclass(frozen=True)
class InterventionCounts:
    """Events and effort of each flow, ``(flows,)``."""

    events: IntArray  #: upward crossings of the threshold by any variable
    effort: FloatArray  #: sum of the absolute interventions
    interventions: IntArray  #: decisions with an intervention
    years: float  #: time of each flow: a year is 73 time units


@dataclass(frozen=True)
class Lorenz96Arena:
    """Forty variables, observed every six hours (0.05 time units), of which some may be pushed.

    After each observation a controller may add up to ``limit`` to, or subtract it from, ``sites``
    of the variables. An event is an upward crossing of ``threshold`` by any variable: without
    control some two in a year of 73 time units.
    """

    sites: int = 1  #: variables that an intervention may change
    limit: float = 0.5  #: largest change of a variable
    threshold: float = 13.5
    noise: float = 1.0  #: standard deviation of the observation noise
    flows: int = 64  #: flows side by side
    years: float = 1.5625  #: time of each: a hundred years in all
    settling_years: float = 0.25  #: time under control before events count
    random_seed: int = 2022
    system: LargestVariable = field(default_factory=LargestVariable)

    steps_per_year = 1460
    steps_per_lyapunov_time = 12
    time_step = 0.01
    stride = 5

    def run(
        self, controller: Controller, watch: Callable[[int], None] | None = None
    ) -> InterventionCounts:
        """Run a controller. ``watch``: Called with the number of each decision."""
        state, noise = self._start(), self._stream("noise")
        task = self.task()
        controller.begin(task, self.flows)
        settling = round(self.settling_years * self.steps_per_year)
        steps = settling + round(self.years * self.steps_per_year)
        events, interventions = np.zeros((2, self.flows), dtype=np.int64)
        effort = np.zeros(self.flows)
        above = state >= self.threshold
        for number in range(steps):
            seen = state + self.noise * noise.standard_normal(state.shape)
            controller.observe(seen[np.newaxis])
            action = checked_action(controller.act(), task, self.flows)
            following = integrate(
                self.system, state + action, self.time_step, self.stride, self.stride
            )[-1]
            now = following >= self.threshold
            if number >= settling:
                events += (now & ~above).sum(axis=0)
                effort += np.abs(action).sum(axis=0)
                interventions += (action != 0).any(axis=0)
            state, above = following, now
            if watch is not None:
                watch(number)
        return InterventionCounts(events, effort, interventions, self.years)

    def task(self) -> ControlTask:
        """Facts that controllers get."""
        return ControlTask(
            space=self.system,
            threshold=self.threshold,
            interval=self.time_step * self.stride,
            stride=self.stride,
            steps_per_lyapunov_time=self.steps_per_lyapunov_time,
            between=1,
            window=1,
            noise=np.full(self.system.variables, self.noise),
            actuators=self.system.variables,
            limit=self.limit,
            most=self.sites,
            training=self._training(),
            equations=self.system,
        )

    def _start(self) -> FloatArray:
        """States on the attractor, ``(variables, flows)``."""
        state = self.system.sample_initial_states(self.flows, self._stream("start"))
        settled: FloatArray = integrate(self.system, state, self.time_step, 5000, 5000)[-1]
        return settled

    def _training(self, series: int = 10, years: float = 1.0) -> FloatArray:
        """Observed series without control, apart from the flows that are controlled."""
        generator = self._stream("training")
        state = self.system.sample_initial_states(series, generator)
        state = integrate(self.system, state, self.time_step, 5000, 5000)[-1]
        steps = round(years * self.steps_per_year) * self.stride
        states = integrate(self.system, state, self.time_step, steps, self.stride)
        seen = states + self.noise * generator.standard_normal(states.shape)
        return np.ascontiguousarray(seen.transpose(2, 0, 1))

    def _stream(self, purpose: str) -> np.random.Generator:
        return random_streams.stream(self.random_seed, "Lorenz 96 arena", purpose)
