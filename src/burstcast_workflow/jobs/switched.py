"""Series of a case under an actuator that switches at random, for training and for tests."""

from typing import Any

import numpy as np

from burstcast.base import random_streams
from burstcast.base.arrays import FloatArray
from burstcast.base.durations import positive_steps
from burstcast.base.files.netcdf import read_rows
from burstcast.control.actuation import ActuationValues, actuated_system
from burstcast.data.scheduled_series import RandomActuation, simulated_series
from burstcast.systems.parameters import SHARE, Parameters, SystemParameters
from burstcast_workflow.harness.settings import at
from burstcast_workflow.jobs.data import Observed
from burstcast_workflow.jobs.systems import System
from burstcast_workflow.jobs.time_unit import Clock

CANDIDATES = 8
"""Series that are drawn for each one that is wanted, for some may laminarise."""


class Switched(System, Clock, Observed):
    """An actuator that switches at random, and what forecasters know about it."""

    switching: dict[str, Any] | None = at("case.training.actuation")
    actuation: dict[str, Any] | None = at("case.actuation")
    laminarisation_threshold: float | None = at("case.laminarisation_threshold")
    names: list[str] = at("job.parameters")

    @property
    def known_parameters(self) -> Parameters:
        """Parameters that forecasters are given, with the case's own values."""
        return self.forecaster_parameters(self.names, self.actuation)

    def switched_series(
        self, ensemble: str, rows: range, purpose: str
    ) -> tuple[FloatArray, FloatArray, FloatArray]:
        """States of series under an actuator that switches at random; observations; schedules.

        ``purpose``: "training" or "test": the random streams are called after it.
        """
        given, actuation, steps = self.switching, self.actuation, self.lyapunov_time
        assert given is not None
        assert actuation is not None
        system, parameters = self.equations, self.known_parameters
        on: tuple[float, ...] = (given["strength"],)
        if self.names != [SHARE]:
            actuated = actuated_system(
                system, actuation["parameters"], actuation["force"], given["strength"]
            )
            on = SystemParameters.of(actuated, self.names).defaults
        switching = RandomActuation(
            positive_steps(given["interval_lt"], steps, f"{Switched.switching}.interval_lt"),
            given["mean_on_lt"] / given["interval_lt"],
            given["mean_off_lt"] / given["interval_lt"],
        )
        free = read_rows(ensemble, "state", rows.start, rows.stop)
        acting = switching.draw(
            CANDIDATES * len(rows),
            free.shape[1] - 1,
            random_streams.stream(self.random_seed, f"{purpose} actuation", self.case),
        )
        states, schedules = simulated_series(
            parameters,
            system,
            np.ascontiguousarray(np.tile(free[:, -1].T, CANDIDATES)),
            ActuationValues(parameters.defaults, on).schedule(acting.T).transpose(2, 0, 1),
            len(rows),
            time_step=self.time_step,
            sampling_stride=self.sampling_stride,
            laminarisation_threshold=self.laminarisation_threshold,
        )
        observed = self.observed_rows(ensemble, rows.start, states, "actuated")
        return states, observed, schedules
