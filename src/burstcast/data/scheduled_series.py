"""Training series under parameters that differ between series or change in time.

Forecasters that know the parameters learn from series of several cases, each under its own values,
or from flows whose actuator switches on and off at random.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from burstcast.base.arrays import BoolArray, FloatArray, IntArray
from burstcast.base.files.netcdf import Variable
from burstcast.base.files.units import COMPONENT
from burstcast.base.laminarisation import is_laminar
from burstcast.systems.base import DynamicalSystem
from burstcast.systems.parameters import Parameters, integrate_scheduled


@dataclass(frozen=True)
class ScheduledSeries:
    """Series with the values of the parameters that were in force."""

    states: FloatArray  #: ``(series, time, component)``
    #: values in force from each sample to the next, ``(series, time - 1, parameters)``
    schedules: FloatArray

    def __post_init__(self) -> None:
        series, time, _ = self.states.shape
        if self.schedules.ndim != 3 or self.schedules.shape[:2] != (series, time - 1):
            raise ValueError(
                f"{series} series of {time} samples need schedules of the shape ({series}, "
                f"{time - 1}, parameters), not {self.schedules.shape}"
            )

    @classmethod
    def constant(cls, states: FloatArray, values: Sequence[float]) -> "ScheduledSeries":
        """Series under constant values, one for each parameter."""
        series, time, _ = states.shape
        return cls(states, np.tile(np.array(values, dtype=np.float64), (series, time - 1, 1)))


def joined(parts: Sequence[ScheduledSeries]) -> ScheduledSeries:
    """Series of several parts, of one length, in their order."""
    shapes = {(part.states.shape[1:], part.schedules.shape[2]) for part in parts}
    if len(shapes) != 1:
        raise ValueError(
            "series that are trained on together must have the same length, components and "
            f"parameters, not {sorted(shapes)}"
        )
    return ScheduledSeries(
        np.concatenate([part.states for part in parts]),
        np.concatenate([part.schedules for part in parts]),
    )


def scheduled_variables(true: ScheduledSeries, observed: FloatArray) -> dict[str, Variable]:
    """Variables of the file of series: their states, observations, and schedules."""
    states, steps = ("series", "time", "component"), ("series", "step", "parameter")
    schedule = "value of each parameter in force from each sample to the next"
    return {
        "state": Variable(states, true.states, COMPONENT, "state of the system"),
        "observed": Variable(states, observed, COMPONENT, "observed state"),
        "parameter": Variable(steps, true.schedules, None, schedule),
    }


@dataclass(frozen=True)
class TrainingSet:
    """Series of several cases that a forecaster learns from, the cases in turn."""

    #: true, observed: the series as they truly are, and as they are observed
    true: ScheduledSeries
    observed: ScheduledSeries
    #: rows of a case's own training series among them, in their order; none where the case gives
    #: other series, or none
    own_rows: list[int]

    @classmethod
    def of_parts(
        cls, parts: Sequence[Mapping[str, Any]], part_of_case: int | None
    ) -> "TrainingSet":
        """Training set of the series of several cases.

        Series of different cases take turns, so that the first ones, on which networks are
        validated, are of all of them.

        ``part_of_case``: Which part has the case's own training series; None if none has.
        """
        counts = [len(part["state"]) for part in parts]
        turn = np.argsort(np.concatenate([np.arange(count) for count in counts]), kind="stable")
        true, observed = (
            joined([ScheduledSeries(part[name], part["parameter"]) for part in parts])
            for name in ("state", "observed")
        )
        rows: list[int] = []
        if part_of_case is not None:
            first = sum(counts[:part_of_case])
            rows = np.argsort(turn)[first : first + counts[part_of_case]].tolist()
        return cls(
            ScheduledSeries(true.states[turn], true.schedules[turn]),
            ScheduledSeries(observed.states[turn], observed.schedules[turn]),
            rows,
        )

    @property
    def schedules(self) -> FloatArray:
        """Values in force from each sample to the next, ``(series, time - 1, parameters)``."""
        return self.observed.schedules


@dataclass(frozen=True)
class RandomActuation:
    """An actuator that switches on and off at random, at whole decision intervals.

    Stretches on and off have geometrically distributed lengths. The actuator begins on with the
    probability that it has later on.

    Examples
    --------
    >>> random_actuation = RandomActuation(interval=15, mean_on=3, mean_off=9)
    >>> random_actuation.share
    0.25
    >>> random_actuation.draw(2, 60, np.random.default_rng(1)).shape
    (2, 60)
    """

    interval: int  #: steps in an interval
    #: mean_on, mean_off: mean length of the stretches on and off, in intervals; at least 1
    mean_on: float
    mean_off: float

    def __post_init__(self) -> None:
        for name in ("interval", "mean_on", "mean_off"):
            if not getattr(self, name) >= 1:
                raise ValueError(f"{name} must be 1 at least, not {getattr(self, name)}")

    @property
    def share(self) -> float:
        """Mean share of the time under actuation."""
        return self.mean_on / (self.mean_on + self.mean_off)

    def draw(self, series: int, steps: int, generator: np.random.Generator) -> BoolArray:
        """Draw whether the actuator is on at each step, ``(series, steps)``.

        More series begin with the same ones.
        """
        intervals = -(-steps // self.interval)
        draws = generator.random((series, intervals))
        acting = np.empty((series, intervals), dtype=bool)
        acting[:, 0] = draws[:, 0] < self.share
        for number in range(1, intervals):
            before = acting[:, number - 1]
            probability = np.where(before, 1.0 - 1.0 / self.mean_on, 1.0 / self.mean_off)
            acting[:, number] = draws[:, number] < probability
        return np.repeat(acting, self.interval, axis=1)[:, :steps]


def simulated_series(
    parameters: Parameters,
    system: DynamicalSystem,
    starts: FloatArray,
    schedules: FloatArray,
    wanted: int,
    *,
    time_step: float,
    sampling_stride: int,
    laminarisation_threshold: float | None,
) -> tuple[ScheduledSeries, IntArray]:
    """Simulate flows under schedules until enough flows have not laminarised.

    ``starts``: Initial states ``(dimension, candidates)``. ``schedules``: Values in force during
    each step, ``(candidates, steps, parameters)``. ``wanted``: Number of series to keep: the first
    that do not laminarise. ``laminarisation_threshold``: A series whose observable exceeds it at
    any integration step is discarded; None: none is. Returns the series, of one sample more than
    the schedules have steps, and the rows of the candidates that they are.
    """
    kept: list[FloatArray] = []
    rows: list[int] = []
    candidates = starts.shape[1]
    for first in range(0, candidates, max(1, wanted)):
        batch = slice(first, first + max(1, wanted))
        in_force = np.repeat(schedules[batch].transpose(1, 2, 0), sampling_stride, axis=0)
        # every integration step is looked at: a burst between two samples counts
        states = integrate_scheduled(
            parameters, in_force, np.ascontiguousarray(starts[:, batch]), time_step
        )
        largest = system.observable(states.transpose(1, 0, 2)).max(axis=0)
        for column in np.flatnonzero(~is_laminar(largest, laminarisation_threshold)):
            rows.append(first + int(column))
            kept.append(states[::sampling_stride, :, column])
        if len(rows) >= wanted:
            break
    if len(rows) < wanted:
        raise ValueError(
            f"{len(rows)} of {candidates} flows under schedules do not laminarise, but {wanted} "
            f"are wanted: give more initial states"
        )
    chosen = np.array(rows[:wanted], dtype=np.int64)
    return ScheduledSeries(np.array(kept[:wanted]), schedules[chosen]), chosen
