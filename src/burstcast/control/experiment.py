"""Experiment with control: its flows, and the noise of the observations.

Source: section "Control of extreme events" of the paper.
"""

from dataclasses import dataclass

import numpy as np

from burstcast.base import random_streams
from burstcast.base.arrays import FloatArray
from burstcast.control.actuation import ActuationValues
from burstcast.control.timing import Schedule
from burstcast.data.dataset import Scales, add_observation_noise
from burstcast.data.encoders.channels import EncodedFlow
from burstcast.data.observation.part import ObservedPart
from burstcast.systems.base import DynamicalSystem
from burstcast.systems.state_space import StateSpace


@dataclass(frozen=True)
class ControlExperiment:
    """Flows, actuation and counted steps on which strategies are compared."""

    system: DynamicalSystem  #: the equations without actuation
    actuated_system: DynamicalSystem  #: the equations under actuation
    threshold: float  #: the event threshold, k_e
    #: rows of the flows' series in the ensemble, from which their random numbers are named
    series: range
    #: true states of the first washout, ``(flows, washout, dimension)``: the last one is the state
    #: from which both the controlled and the uncontrolled flow are integrated
    washouts: FloatArray
    #: whether flows with an event before their steps count are left out, while nothing could be
    #: done about it
    quiet_starts: bool
    schedule: Schedule
    root_seed: int  #: root of all random streams
    case: str  #: name of the case; random streams are called after it
    #: values given to forecasters that know the parameters; None: no forecaster needs them
    values: ActuationValues | None = None
    #: the equations under the opposite force; None: the actuation cannot be reversed
    reversed_system: DynamicalSystem | None = None
    #: components of the states, or channels of an encoded flow, that are observed; None: all
    sensor: ObservedPart | EncodedFlow | None = None

    @property
    def systems(self) -> tuple[DynamicalSystem, ...]:
        """The equations by the number of the actuation: 0 none, 1 the actuation, 2 reversed."""
        further = () if self.reversed_system is None else (self.reversed_system,)
        return self.system, self.actuated_system, *further

    def draws(self, purpose: str, looks: int, *names: str | int) -> FloatArray:
        """Uniform random numbers of each flow, from a stream of its own, ``(flows, looks)``."""
        streams = [
            random_streams.stream(self.root_seed, purpose, self.case, *names, row)
            for row in self.series
        ]
        draws = [stream.random(looks) for stream in streams]
        return np.array(draws).reshape(len(self.series), looks)

    @property
    def observed_space(self) -> StateSpace:
        """Space that policies and forecasters observe: the system's, or the sensor's."""
        return self.system if self.sensor is None else self.sensor.space


def controlled_series(kept: int, training: int, wanted: int) -> range:
    """Rows of the series whose first steps the flows begin with: those after the training series.

    Fewer than wanted where there are no more.
    """
    return range(training, training + min(wanted, kept - training))


def noise_of_flows(
    series: range, steps: int, noise: float, scales: Scales, root_seed: int, case: str
) -> FloatArray:
    """Observation noise of each flow at each step, ``(flows, steps, dimension)``.

    It is as large as the noise of the training series, but drawn separately: observations under
    control differ from observations of the same series without control.
    """
    silence = np.zeros((len(series), steps, len(scales.standard_deviation)))
    return add_observation_noise(
        silence, series.start, noise, scales, root_seed, "control noise", case
    )
