"""A toy flow, policies without a forecast, and control written as one plain loop per flow."""

from dataclasses import dataclass, fields, replace
from typing import ClassVar

import numpy as np

from burstcast.base.arrays import FloatArray
from burstcast.control.actuation import ActuationValues, actuated_system
from burstcast.control.experiment import ControlExperiment
from burstcast.control.loop import ControlledFlows, Looks
from burstcast.control.policy import Look
from burstcast.control.timing import Schedule
from burstcast.forecasters.equations import EquationsFromTruth
from burstcast.systems.base import DynamicalSystem
from burstcast.systems.integration import integrate
from burstcast.systems.mfe import MoehlisFaisstEckhardt
from burstcast.systems.parameters import SystemParameters
from burstcast.systems.runge_kutta import step
from helpers_library import MadeUpForecaster

FLOW = MoehlisFaisstEckhardt(reynolds=400.0)
RAISED = actuated_system(FLOW, {"reynolds": 2000.0})
STEPS = {"time_step": 0.25, "sampling_stride": 4}
REYNOLDS = SystemParameters.of(FLOW, ["reynolds"])
EQUATIONS = EquationsFromTruth(system=FLOW, in_force=REYNOLDS, **STEPS)
SCHEDULE = Schedule(
    washout=5,
    quiet_lt=2.0,
    span_lt=3.0,
    delay_lt=0.0,
    actuation_start_lt=-1.0,
    actuation_duration_lt=1.5,
    steps_per_lyapunov_time=20,
    sampling_stride=4,
    time_step=0.25,
)
PAPER = replace(SCHEDULE, washout=30, quiet_lt=0.0, span_lt=20.0, steps_per_lyapunov_time=61)
"""Control of the paper at Re = 400."""


@dataclass(frozen=True)
class Rotor(DynamicalSystem):
    """A point on a circle; its first coordinate is the observable, whose events are its crests."""

    frequency: float

    dimension: ClassVar[int] = 2
    observable_name: ClassVar[str] = "height"
    observable_symbol: ClassVar[str] = "x"

    def right_hand_side(self, state):
        return np.stack([-self.frequency * state[1], self.frequency * state[0]])

    def jacobian(self, state):
        raise NotImplementedError

    def observable(self, state):
        return np.asarray(state[0])


class TablePolicy:
    """Alarms as listed, and a record of what it was shown."""

    def __init__(self, table):
        self.table = table
        self.seen = {}
        self.acting = {}

    def __call__(self, look):
        for position, key in enumerate(zip(look.rows, look.number, strict=True)):
            row, number = map(int, key)
            self.seen[row, number] = look.washout[:, :, position].copy()
            self.acting[row, number] = look.acting[:, position].tolist()
        return self.table[look.rows, look.number]


def random_alarms(share, flows, timing, seed=3):
    draws = np.random.default_rng(seed).random((flows, timing.most_looks))
    return TablePolicy(draws < share)


def look_at(washout, acting=None):
    """The first look at flows, with a washout ``(steps, observed, batch)``."""
    steps, _, batch = washout.shape
    rows = np.arange(batch)
    if acting is None:
        acting = np.zeros((steps - 1, batch), dtype=np.uint8)
    return Look(rows, np.zeros_like(rows), washout, np.asarray(acting).astype(np.uint8))


def asked(policy, washout, acting=None):
    return np.asarray(policy(look_at(washout, acting)) != 0).tolist()


def turbulent_washouts(flow, flows, schedule, seed=5, steps=1200):
    """Washouts (flows, washout, 9) in the chaotic phase."""
    state = np.zeros((9, flows))
    state[[0, 2, 3]] = [[1.0], [0.07066], [-0.07076]]
    state[3] += 0.01 * np.random.default_rng(seed).random(flows)
    developed = integrate(flow, state, 0.25, steps, stride=steps)[-1]
    return washouts_of(flow, developed, schedule)


def washouts_of(system, first_states, schedule):
    """Washouts (flows, washout, dimension) that begin with these states (dimension, flows)."""
    samples = [first_states]
    for _ in range(schedule.washout - 1):
        state = samples[-1]
        for _ in range(schedule.sampling_stride):
            state = step(system, state, schedule.time_step)
        samples.append(state)
    return np.stack(samples).transpose(2, 0, 1)


def experiment(flows=6, schedule=SCHEDULE, **changes):
    """Turbulent flows, of which a change of the Reynolds number is the actuation."""
    if "washouts" not in changes:
        changes["washouts"] = turbulent_washouts(FLOW, flows, schedule)
    usual = {"system": FLOW, "actuated_system": RAISED, "threshold": 0.07, "quiet_starts": True}
    usual |= {"series": range(10, 10 + flows), "root_seed": 7, "case": "Re400"}
    values = ActuationValues((FLOW.reynolds,), (RAISED.reynolds,))
    return ControlExperiment(**{**usual, "schedule": schedule, "values": values, **changes})


def rotors(first_states, schedule, actuated, frequency=0.3):
    """Points on circles, which the actuation makes faster or slower."""
    system = Rotor(frequency)
    changes = {"system": system, "actuated_system": Rotor(actuated), "threshold": 0.9}
    washouts = washouts_of(system, first_states, schedule)
    return experiment(first_states.shape[1], schedule, washouts=washouts, **changes)


def run(strategy, given, forecaster=EQUATIONS, **options):
    """Flows under a strategy's own policy."""
    policy = strategy.policy(given, forecaster)
    return strategy.simulate(given, policy, **{"noise": None, **options})


def alarms_of(flows):
    """Alarms of each flow of a strategy that looks at equal intervals."""
    return flows.looks.alarm.reshape(len(flows), -1).tolist()


def simulation_of(timing, controlled, **values):
    """A simulation with these values, and nothing else."""
    controlled = np.array(controlled, dtype=np.float64)
    usual = dict.fromkeys(field.name for field in fields(ControlledFlows))
    usual |= {"threshold": 1.0, "left_out": 0}
    usual |= {"looks": Looks(*np.zeros((4, 0), dtype=np.int64), {})}
    usual |= {"actuated": np.zeros(controlled.shape, dtype=bool)}
    names = ("actuated_integration_steps", "switchings")
    usual |= dict.fromkeys(names, np.zeros(len(controlled), dtype=np.int64))
    usual |= {"escape_step": np.full(len(controlled), -1)}
    return ControlledFlows(**{**usual, "timing": timing, "controlled": controlled, **values})


@dataclass(frozen=True)
class Script(MadeUpForecaster):
    """Forecasts a script, whatever it has seen."""

    script: FloatArray  # (steps, batch)

    def start(self, washout):
        return washout[-1]

    def advance(self, memory, steps):
        return self.script[:steps, np.newaxis], memory


@dataclass(frozen=True)
class PlainLook:
    step: int
    alarm: bool
    otherwise: list[float]  # observable from the look on, had the alarm not been acted on


@dataclass(frozen=True)
class PlainFlow:
    uncontrolled: FloatArray  # states (steps, dimension), up to the last step that counts
    controlled: FloatArray
    heights: list[float]  # observable with control, up to where the flow was followed
    acting: list[int]  # number of the system at each integration step
    looks: list[PlainLook]


def plain_flow(given, row, timing, decide):
    """One flow, one integration step after the other.

    ``decide`` is given the number of a look and the true state, (dimension, 1).
    """
    stride, (begin, stop) = timing.schedule.sampling_stride, timing.effect
    end, (pause, longer) = timing.counted_until, timing.pauses
    acting = [0] * ((end + longer) * stride + stop)
    states = [state[:, np.newaxis] for state in given.washouts[row]]

    def after(state, flags):
        sampled = []
        for number, system in enumerate(flags, start=1):
            state = step(given.systems[system], state, timing.schedule.time_step)
            sampled += [state] * (number % stride == 0)
        return sampled

    def heights(states):
        return [float(given.system.observable(state)[0]) for state in states]

    looks = []
    due = now = len(states) - 1
    while now < end or now < due:
        if now == due and now * stride + begin < end * stride:
            decided, otherwise = decide(len(looks), states[now]), []
            if decided:
                flags = acting[now * stride : (now + longer) * stride]
                otherwise = heights([states[now], *after(states[now], flags)])
                acting[now * stride + begin : now * stride + stop] = [decided] * (stop - begin)
            looks.append(PlainLook(now, bool(decided), otherwise))
            due = now + (longer if decided else pause)
        states += after(states[now], acting[now * stride : (now + 1) * stride])
        now += 1
    first = timing.first_look
    free = states[: first + 1] + after(states[first], [0] * (end - first) * stride)
    controlled = np.stack(states)[: end + 1, :, 0]
    return PlainFlow(np.stack(free)[:, :, 0], controlled, heights(states), acting, looks)
