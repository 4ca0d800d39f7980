"""Arenas: flows on which controllers are compared, all with the same flows and the same noise.

`ShearFlowArena` counts events in long runs (`burstcast.control.long_run`). `Lorenz96Arena` is after
the control simulation experiment of Sun, Miyoshi & Richard (Nonlinear Processes in Geophysics 30
(2023) 117), with the local interventions of Mitsui et al. (ibid. 32 (2025) 457).
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from burstcast.base import random_streams
from burstcast.base.arrays import BoolArray, FloatArray, IntArray
from burstcast.base.poisson import poisson_interval, rate_bound
from burstcast.control.actuation import actuated_system
from burstcast.control.controller import Controller, ControlTask
from burstcast.control.experiment import ControlExperiment
from burstcast.control.long_run import LongRunCounts, run_long
from burstcast.control.policy import Look, Policy
from burstcast.control.strategies.uncontrolled import Uncontrolled
from burstcast.control.timing import Schedule
from burstcast.data.dataset import initial_states
from burstcast.systems.integration import integrate
from burstcast.systems.lorenz96 import Lorenz96
from burstcast.systems.mfe import MoehlisFaisstEckhardt


def checked_action(action: FloatArray, task: ControlTask, flows: int) -> FloatArray:
    """The action of a controller; ValueError if the task does not allow it."""
    action = np.asarray(action, dtype=np.float64)
    if action.shape != (task.actuators, flows):
        raise ValueError(
            f"act returns the shape {action.shape}, not (actuators, flows) "
            f"{(task.actuators, flows)}"
        )
    if not (finite := np.isfinite(action).all(axis=0)).all():
        raise ValueError(f"act returns no number for the flow {int(np.argmin(finite))}")
    if np.abs(action).max(initial=0.0) > task.limit * (1 + 1e-9):
        raise ValueError(f"act returns values beyond the limit of {task.limit:g}")
    if task.switched and not ((action == 0) | (action == task.limit)).all():
        raise ValueError(
            f"act returns values between: actuators are off (0) or on ({task.limit:g})"
        )
    if ((action != 0).sum(axis=0) > task.most).any():
        raise ValueError(f"act uses more than {task.most} of the actuators at once")
    return action


@dataclass(frozen=True)
class ArenaScore:
    """Events that a controller leaves in an arena, and its effort."""

    events: int
    time: float  #: that was observed, of all flows together
    unit: str  #: of the time: LT, Lyapunov times, or years
    effort: float  #: share of the time (shear flow), or sum of absolute actions in a year
    acting: float  #: share of the time, or of the decisions, with an action
    decisions: int  #: whether their time counts or not

    @property
    def rate(self) -> tuple[float, float, float]:
        """Events in a unit of time, with the 95 % interval of a Poisson count.

        Where there was none, the upper end is the bound of `burstcast.base.poisson.rate_bound`.
        """
        if not self.events:
            return 0.0, 0.0, rate_bound(self.time, 0.95)
        return self.events / self.time, *poisson_interval(self.events, self.time, 0.95)

    def __str__(self) -> str:
        """The score in words."""
        rate, low, high = self.rate
        times = f"one in {1 / rate:.3g} ({1 / high:.3g} to {1 / low:.3g})" if rate else ""
        return (
            f"{self.events} events in {self.time:.3g} {self.unit}: "
            f"{times or f'fewer than one in {1 / high:.3g}'} {self.unit}; "
            f"acting for {100 * self.acting:.2g} %, effort {self.effort:.3g}"
        )


# -- the shear flow --------------------------------------------------------------------------------

LAMINAR_STATE = np.array([1, 0, 0.07066, -0.07076, 0, 0, 0, 0, 0])
"""State near which the flow starts, after the paper."""


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
        switched=True,
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


@dataclass(frozen=True)
class ShearFlowArena:
    """The shear flow at Re = 400, whose one actuator (Re = 2000) is on or off.

    Decisions are a quarter of a Lyapunov time apart. Events count after 20 Lyapunov times under
    control; a flow that laminarises starts anew.
    """

    #: states that flows start from; a third of them laminarises at once, and ten are left out
    initial_states: int = 240
    span_lt: float = 250.0  #: time of each flow in which events count, in Lyapunov times
    delay_lt: float = 0.0  #: time from a decision to its effect, in Lyapunov times
    random_seed: int = 2022  #: of the flows and of their noise; training series are always the same

    def run(self, controller: Controller) -> LongRunCounts:
        """Run a controller."""
        return run_shear_flow(
            controller, *self._given, decision_interval_lt=0.25, laminarisation_threshold=0.48
        )

    def score(self, controller: Controller) -> ArenaScore:
        """Run a controller, and count events and effort of all flows.

        Examples
        --------
        >>> from burstcast.control.rules import WhileHigh
        >>> print(ShearFlowArena(initial_states=24, span_lt=10.0).score(WhileHigh(level=0.06)))
        0 events in 84 LT: fewer than one in 28 LT; acting for 36 %, effort 0.363
        """
        counts = self.run(controller)
        steps = counts.steps.sum()
        acting = float(counts.actuated_steps.sum() / steps)
        time = float(steps / self._given[0].schedule.steps_per_lyapunov_time)
        decisions = int(counts.decisions.sum())
        return ArenaScore(int(counts.events.sum()), time, "LT", acting, acting, decisions)

    @cached_property
    def _given(self) -> tuple[ControlExperiment, FloatArray, FloatArray]:
        """Flows, observed training series, standard deviations of the noise."""
        learnt = _turbulent(50, 2022)[:10]
        free = _turbulent(self.initial_states, self.random_seed)[10:]
        if not len(free):
            raise ValueError(f"no flow is left of {self.initial_states} initial_states: take more")
        generator = np.random.default_rng([2022, 1])
        noise = 0.01 * learnt.std(axis=(0, 1))
        schedule = Schedule(
            washout=30,
            quiet_lt=20.0,
            span_lt=self.span_lt,
            delay_lt=self.delay_lt,
            actuation_start_lt=-1.0,
            actuation_duration_lt=1.5,
            steps_per_lyapunov_time=61,
            sampling_stride=4,
            time_step=0.25,
        )
        system = MoehlisFaisstEckhardt(reynolds=400.0)
        experiment = ControlExperiment(
            system=system,
            actuated_system=actuated_system(system, {"reynolds": 2000.0}),
            threshold=0.1,
            series=range(10, 10 + len(free)),
            washouts=np.ascontiguousarray(free[:, -30:]),
            quiet_starts=False,
            schedule=schedule,
            root_seed=self.random_seed,
            case="Re400",
        )
        return experiment, learnt + noise * generator.standard_normal(learnt.shape), noise


def _turbulent(count: int, random_seed: int) -> FloatArray:
    """Series of the free flow that do not laminarise, ``(series, time, components)``."""
    system, generator = MoehlisFaisstEckhardt(reynolds=400.0), np.random.default_rng(random_seed)
    start = initial_states(LAMINAR_STATE, 3, 0.01, count, generator)
    states = integrate(system, start, 0.25, 4 * 4200, stride=4)[200:].transpose(2, 0, 1)
    quiet = system.observable(np.moveaxis(states, -1, 0)).max(axis=1) < 0.48
    turbulent: FloatArray = states[quiet]
    return turbulent


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
        events, interventions = np.zeros((2, self.flows), dtype=np.int64)
        effort = np.zeros(self.flows)
        above = state >= self.threshold
        for number in range(self._steps):
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

    def score(
        self, controller: Controller, watch: Callable[[int], None] | None = None
    ) -> ArenaScore:
        """Run a controller (see `run`), and count events and effort of all flows.

        Examples
        --------
        >>> from burstcast.control.rules import NoAction
        >>> print(Lorenz96Arena(flows=8, years=0.5).score(NoAction()))
        18 events in 4 years: one in 0.222 (0.141 to 0.375) years; acting for 0 %, effort 0
        """
        counts = self.run(controller, watch)
        years = self.flows * counts.years
        acting = float(counts.interventions.sum() / (years * self.steps_per_year))
        effort = float(counts.effort.sum() / years)
        decisions = self.flows * self._steps
        return ArenaScore(int(counts.events.sum()), years, "years", effort, acting, decisions)

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
            switched=False,
            training=self._training(),
            equations=self.system,
        )

    @property
    def _steps(self) -> int:
        """Decisions of each flow, while it settles and afterwards."""
        parts = (self.settling_years, self.years)
        return sum(round(years * self.steps_per_year) for years in parts)

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
