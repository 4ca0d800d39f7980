"""Training series under parameters that differ between series or change in time.

Forecasters that know the parameters learn from series of several cases, each under its own values,
or from flows whose actuator switches on and off at random.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from burstcast.base.arrays import BoolArray, FloatArray
from burstcast.base.exogenous import with_inputs
from burstcast.base.files.netcdf import Variable
from burstcast.base.files.units import COMPONENT
from burstcast.data.laminarisation import is_laminar
from burstcast.systems.base import DynamicalSystem
from burstcast.systems.parameters import Parameters, integrate_scheduled


def scheduled_variables(
    states: FloatArray, observed: FloatArray, schedules: FloatArray
) -> dict[str, Variable]:
    """Variables of the file of series: their states, observations, and schedules.

    ``schedules``: Values in force from each sample to the next, ``(series, time - 1, parameters)``.
    """
    axes, steps = ("series", "time", "component"), ("series", "step", "parameter")
    in_force = "value of each parameter in force from each sample to the next"
    return {
        "state": Variable(axes, states, COMPONENT, "state of the system"),
        "observed": Variable(axes, observed, COMPONENT, "observed state"),
        "parameter": Variable(steps, schedules, None, in_force),
    }


@dataclass(frozen=True)
class TrainingSet:
    """Series of several cases that a forecaster learns from, the cases in turn."""

    states: FloatArray  #: true states, ``(series, time, dimension)``
    #: observed states with the parameters in force, ``(series, time, dimension + parameters)``
    observed: FloatArray
    #: rows of a case's own training series among them, in their order; none where the case gives
    #: other series, or none
    own_rows: list[int]

    @classmethod
    def of_parts(
        cls, parts: Sequence[Mapping[str, FloatArray]], part_of_case: int | None
    ) -> "TrainingSet":
        """Training set of the series of several cases, as variables of `scheduled_variables`.

        Series of different cases take turns, so that the first ones, on which networks are
        validated, are of all of them.

        ``part_of_case``: Which part has the case's own training series; None if none has.
        """
        observed = [with_inputs(part["observed"], part["parameter"]) for part in parts]
        shapes = {part.shape[1:] for part in observed}
        if len(shapes) != 1:
            raise ValueError(
                "series that are trained on together must have the same length, components and "
                f"parameters, not {sorted(shapes)}"
            )
        counts = [len(part) for part in observed]
        turn = np.argsort(np.concatenate([np.arange(count) for count in counts]), kind="stable")
        rows: list[int] = []
        if part_of_case is not None:
            first = sum(counts[:part_of_case])
            rows = np.argsort(turn)[first : first + counts[part_of_case]].tolist()
        states = np.concatenate([part["state"] for part in parts])
        return cls(states[turn], np.concatenate(observed)[turn], rows)


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
) -> tuple[FloatArray, FloatArray]:
    """Simulate flows under schedules until enough flows have not laminarised.

    ``starts``: Initial states ``(dimension, candidates)``. ``schedules``: Values in force during
    each step, ``(candidates, steps, parameters)``. ``wanted``: Number of series to keep: the first
    that do not laminarise. ``laminarisation_threshold``: A series whose observable exceeds it at
    any integration step is discarded; None: none is. Returns the states ``(wanted, steps + 1,
    dimension)``, and the schedules that they are under.
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
    return np.array(kept[:wanted]), schedules[rows[:wanted]]
