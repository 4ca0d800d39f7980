"""Experiment with control: its flows, and the noise of the observations.

Source: section "Control of extreme events" of the paper.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from burstcast.arrays import FloatArray
from burstcast.control.actuation import ActuationValues
from burstcast.data.dataset import Scales, observe
from burstcast.encoders.channels import EncodedFlow
from burstcast.observation.part import ObservedPart
from burstcast.systems.base import DynamicalSystem
from burstcast.systems.state_space import StateSpace


@dataclass(frozen=True)
class Schedule:
    """Durations that all strategies are given.

    Attributes
    ----------
    washout
        Inputs of the washout, in steps.
    quiet_lt
        The least that flows go on, in Lyapunov times after the first forecast, before their steps
        count.
    span_lt
        How long each flow counts, in Lyapunov times.
    delay_lt
        Time from a decision to its effect, in Lyapunov times.
    actuation_start_lt, actuation_duration_lt
        What an alarm sets off where it has a window: start, from the window's first step, and
        length, in Lyapunov times.
    steps_per_lyapunov_time, sampling_stride, time_step
        Steps of a forecast in a Lyapunov time, integration steps in one, and their length in time
        units.
    """

    washout: int
    quiet_lt: float
    span_lt: float
    delay_lt: float
    actuation_start_lt: float
    actuation_duration_lt: float
    steps_per_lyapunov_time: int
    sampling_stride: int
    time_step: float

    @property
    def clock(self) -> Mapping[str, Any]:
        """Fields of `burstcast.control.timing.Clock`."""
        names = ("washout", "quiet_lt", "span_lt", "steps_per_lyapunov_time")
        return {name: getattr(self, name) for name in (*names, "sampling_stride", "time_step")}


@dataclass(frozen=True)
class ControlExperiment:
    """Flows, actuation and counted steps on which strategies are compared.

    Attributes
    ----------
    system
        The equations without actuation.
    actuated_system
        The equations under actuation (`burstcast.control.actuation.actuated_system`).
    threshold
        The event threshold, k_e.
    series
        Rows of the flows' series in the ensemble, from which their random numbers are named.
    washouts
        True states that the flows begin with, ``(flows, washout, dimension)``.
    quiet_starts
        Whether flows with an event before the steps that count are left out.
    schedule
        Durations.
    root_seed, case
        Names of random streams.
    values
        Values given to forecasters that know the parameters; None: no forecaster needs them.
    reversed_system
        The equations under the reversed actuation, that is with the opposite force; None: there is
        none.
    sensor
        Components of the states, or channels of an encoded flow, that monitors observe; None: all.
    """

    system: DynamicalSystem
    actuated_system: DynamicalSystem
    threshold: float
    series: range
    washouts: FloatArray
    quiet_starts: bool
    schedule: Schedule
    root_seed: int
    case: str
    values: ActuationValues | None = None
    reversed_system: DynamicalSystem | None = None
    sensor: ObservedPart | EncodedFlow | None = None

    @property
    def observed_space(self) -> StateSpace:
        """Space that monitors and forecasters observe: the system's, or the sensor's."""
        return self.system if self.sensor is None else self.sensor.space


def controlled_series(kept: int, training: int, wanted: int) -> range:
    """Choose the series whose first steps the flows begin with: the ones after the training series.

    Parameters
    ----------
    kept
        Series of the ensemble.
    training
        How many of them, from the first, are trained on.
    wanted
        How many flows to control.

    Returns
    -------
    Rows of the series; fewer than wanted where there are no more.
    """
    return range(training, training + min(wanted, kept - training))


def noise_of_flows(
    series: range, steps: int, noise: float, scales: Scales, root_seed: int, case: str
) -> FloatArray:
    """Observation noise of each flow at each step, with and without control.

    It is as large as the noise of the training series, but drawn separately: observations under
    control differ from observations of the same series without control.

    Parameters
    ----------
    series
        Rows of the flows' series in the ensemble: each has its own noise.
    steps
        Steps of each flow.
    noise, scales, root_seed
        As in `burstcast.data.dataset.observe`.
    case
        Name of the case; the random stream is called after it.

    Returns
    -------
    ``(flows, steps, dimension)``.
    """
    silence = np.zeros((len(series), steps, len(scales.standard_deviation)))
    return observe(silence, series.start, noise, scales, root_seed, "control noise", case)
