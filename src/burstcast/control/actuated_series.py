"""Series of flows whose actuator switches at random, from which aware forecasters learn."""

from dataclasses import dataclass

import numpy as np

from burstcast.base.arrays import FloatArray
from burstcast.control.actuation import ActuationValues
from burstcast.data.scheduled_series import RandomActuation, simulated_series
from burstcast.systems.base import DynamicalSystem
from burstcast.systems.parameters import Parameters

CANDIDATES = 8
"""Series that are drawn for each one that is wanted, for some may laminarise."""


@dataclass(frozen=True)
class RandomlyActuated:
    """A flow under an actuator that switches at random."""

    system: DynamicalSystem
    parameters: Parameters  #: that forecasters know, with the values of the free flow
    under_actuation: tuple[float, ...]  #: their values while the actuator is on
    switching: RandomActuation
    time_step: float
    sampling_stride: int
    laminarisation_threshold: float | None  #: series beyond it are left out; None: none is

    def series(
        self, free: FloatArray, generator: np.random.Generator
    ) -> tuple[FloatArray, FloatArray]:
        """As many series as free ones, which go on from the ends of these, and their schedules.

        ``free``: States ``(series, time, dimension)``. Returns states of that shape, and the values
        in force from each sample to the next, ``(series, time - 1, parameters)``.
        """
        acting = self.switching.draw(CANDIDATES * len(free), free.shape[1] - 1, generator)
        values = ActuationValues(self.parameters.defaults, self.under_actuation)
        return simulated_series(
            self.parameters,
            self.system,
            np.ascontiguousarray(np.tile(free[:, -1].T, CANDIDATES)),
            values.schedule(acting.T).transpose(2, 0, 1),
            len(free),
            time_step=self.time_step,
            sampling_stride=self.sampling_stride,
            laminarisation_threshold=self.laminarisation_threshold,
        )
