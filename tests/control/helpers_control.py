"""A toy flow, monitors without a forecast, and control written as one plain loop per flow."""

from dataclasses import dataclass, fields
from typing import Any, ClassVar, NamedTuple

import numpy as np

from burstcast.arrays import BoolArray, FloatArray, IntArray
from burstcast.control.actuation import actuation_interval
from burstcast.control.monitors.base import Monitor
from burstcast.control.sampled.simulation import SampledSimulation, SampledStepper
from burstcast.control.simulation import ControlSimulation, simulate
from burstcast.control.timing import Clock, DecisionTiming, Timing
from burstcast.control.windowed.simulation import WindowedSimulation, WindowedStepper
from burstcast.systems.base import DynamicalSystem
from burstcast.systems.integration import integrate
from burstcast.systems.mfe import MoehlisFaisstEckhardt
from burstcast.systems.runge_kutta import step

PAPER = Timing(
    prediction_time_lt=1.0,
    window_lt=1.0,
    span_lt=20.0,
    washout=30,
    steps_per_lyapunov_time=61,
    sampling_stride=4,
    time_step=0.25,
)
"""Control of the paper at Re = 400 and a prediction time of one Lyapunov time."""


@dataclass(frozen=True)
class Rotor(DynamicalSystem):
    """A point on a circle; its first coordinate is the observable, whose events are its crests."""

    frequency: float

    dimension: ClassVar[int] = 2
    observable_name: ClassVar[str] = "height"
    observable_symbol: ClassVar[str] = "x"

    def right_hand_side(self, state: FloatArray) -> FloatArray:
        return np.stack([-self.frequency * state[1], self.frequency * state[0]])

    def jacobian(self, state: FloatArray) -> FloatArray:
        raise NotImplementedError

    def observable(self, state: FloatArray) -> FloatArray:
        return np.asarray(state[0])


@dataclass(frozen=True)
class TableMonitor(Monitor):
    """Alarms as listed, and a record of what it was shown."""

    table: BoolArray
    seen: dict[tuple[int, int], FloatArray]

    def alarms(
        self,
        rows: IntArray,
        forecast_number: IntArray,
        washout: FloatArray,
        acting: BoolArray | None = None,
    ) -> BoolArray:
        for position, (row, number) in enumerate(zip(rows, forecast_number, strict=True)):
            self.seen[int(row), int(number)] = washout[:, :, position].copy()
        return self.table[rows, forecast_number]


class Actuation(NamedTuple):
    """What an alarm sets off: other equations, from so long after its window's first step."""

    system: DynamicalSystem
    start_lt: float
    duration_lt: float


def run_windowed(
    system: DynamicalSystem,
    washouts: FloatArray,
    monitor: Monitor,
    actuation: Actuation,
    timing: Timing,
    threshold: float,
    **options: Any,
) -> WindowedSimulation:
    interval = actuation_interval(timing, actuation.start_lt, actuation.duration_lt)
    stepper = WindowedStepper(system, actuation.system, monitor, timing, threshold, interval)
    return simulate(stepper, washouts, **options)


def run_sampled(
    system: DynamicalSystem,
    washouts: FloatArray,
    monitor: Monitor,
    actuated: DynamicalSystem,
    timing: DecisionTiming,
    threshold: float,
    horizon: int = 0,
    **options: Any,
) -> SampledSimulation:
    stepper = SampledStepper(system, actuated, monitor, timing, threshold, horizon)
    return simulate(stepper, washouts, **options)


def simulation_of(timing: Clock, controlled: FloatArray, **values: Any) -> ControlSimulation:
    """A simulation with these values, and nothing else."""
    usual = {
        **dict.fromkeys(field.name for field in fields(ControlSimulation)),
        **{"threshold": 1.0, "left_out": 0},
        "actuated": np.zeros(controlled.shape, dtype=bool),
        "switchings": np.zeros(len(controlled), dtype=np.int64),
    }
    return ControlSimulation(**{**usual, "timing": timing, "controlled": controlled, **values})


def table_monitor(table: BoolArray) -> TableMonitor:
    return TableMonitor(table, {})


def turbulent_washouts(
    flow: MoehlisFaisstEckhardt, flows: int, timing: Clock, seed: int = 5, steps: int = 1200
) -> FloatArray:
    """Washouts (flows, washout, 9) in the chaotic phase."""
    state = np.zeros((9, flows))
    state[[0, 2, 3]] = [[1.0], [0.07066], [-0.07076]]
    state[3] += 0.01 * np.random.default_rng(seed).random(flows)
    developed = integrate(flow, state, 0.25, steps, stride=steps)[-1]
    return washouts_of(flow, developed, timing)


def washouts_of(system: DynamicalSystem, first_states: FloatArray, timing: Clock) -> FloatArray:
    """Washouts (flows, washout, dimension) that begin with these states (dimension, flows)."""
    samples = [first_states]
    for _ in range(timing.washout - 1):
        state = samples[-1]
        for _ in range(timing.sampling_stride):
            state = step(system, state, timing.time_step)
        samples.append(state)
    return np.stack(samples).transpose(2, 0, 1)


@dataclass(frozen=True)
class PlainForecast:
    step: int
    alarm: bool
    would_cross: bool
    would_be_under_way: bool
    reached: bool


@dataclass(frozen=True)
class PlainFlow:
    uncontrolled: FloatArray  # states (steps, dimension)
    controlled: FloatArray
    acting: BoolArray  # (integration steps,)
    forecasts: list[PlainForecast]


def _run(
    system: DynamicalSystem,
    actuated: DynamicalSystem,
    state: FloatArray,
    acting: list[bool],
    timing: Timing,
) -> list[FloatArray]:
    """Samples after the state, one integration step after the other."""
    samples = []
    for number, active in enumerate(acting, start=1):
        state = step(actuated if active else system, state, timing.time_step)
        if number % timing.sampling_stride == 0:
            samples.append(state)
    return samples


def plain_flow(
    system: DynamicalSystem,
    washout: FloatArray,
    alarms: list[bool],
    actuation: Actuation,
    timing: Timing,
    threshold: float,
    actuation_start: int,
    actuation_steps: int,
) -> PlainFlow:
    """One flow; states are shaped (dimension, 1) as integration wants them."""
    stride = timing.sampling_stride
    window_start, window_end = timing.window_start, timing.window_end
    end = timing.washout - 1 + window_end + timing.span_steps
    acting = [False] * ((end + 4 * window_end + actuation_steps) * stride)
    controlled = [state[:, np.newaxis] for state in washout]

    def height(state: FloatArray) -> float:
        return float(system.observable(state)[0])

    def go_on(until: int) -> None:
        now = len(controlled) - 1
        flags = acting[now * stride : until * stride]
        controlled.extend(_run(system, actuation.system, controlled[-1], flags, timing))

    forecasts = []
    while (len(controlled) - 1) * stride + actuation_start < end * stride:
        now = len(controlled) - 1
        if not alarms[len(forecasts)]:
            forecasts.append(PlainForecast(now, False, False, False, False))
            go_on(now + window_end - window_start)
            continue
        flags = acting[now * stride : (now + window_end) * stride]
        otherwise = [
            height(state) for state in _run(system, actuation.system, controlled[-1], flags, timing)
        ]
        window = otherwise[window_start - 1 :]
        for number in range(actuation_start, actuation_start + actuation_steps):
            acting[now * stride + number] = True
        go_on(now + window_end)
        heights = [height(state) for state in controlled[now:]]
        first = actuation_start // stride
        forecasts.append(
            PlainForecast(
                step=now,
                alarm=True,
                would_cross=window[0] < threshold <= max(window),
                would_be_under_way=window[0] >= threshold,
                reached=max(heights[window_start:]) >= threshold
                or any(
                    heights[i] < threshold <= heights[i + 1] for i in range(first, window_start)
                ),
            )
        )
    go_on(max(end, len(controlled) - 1))
    start = washout[-1][:, np.newaxis]
    free = [False] * ((end - timing.washout + 1) * stride)
    uncontrolled = [state[:, np.newaxis] for state in washout]
    uncontrolled.extend(_run(system, system, start, free, timing))
    return PlainFlow(
        uncontrolled=np.stack(uncontrolled)[:, :, 0],
        controlled=np.stack(controlled)[: end + 1, :, 0],
        acting=np.array(acting),
        forecasts=forecasts,
    )
