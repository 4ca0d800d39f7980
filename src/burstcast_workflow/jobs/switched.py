"""Series of a case under an actuator that switches at random, for training and for tests."""

import numpy as np

from burstcast import durations, random_streams
from burstcast.arrays import FloatArray
from burstcast.control.actuation import ActuationValues, actuated_system
from burstcast.data.scheduled_series import RandomActuation, ScheduledSeries, simulated_series
from burstcast.files.netcdf import read_rows
from burstcast.systems.parameters import SHARE, SystemParameters
from burstcast_workflow.harness.settings import Settings
from burstcast_workflow.jobs.data import observed_rows
from burstcast_workflow.jobs.systems import equations_of, parameters_of

CANDIDATES = 8
"""Series that are drawn for each one that is wanted, for some may laminarise."""


def switched_series(
    settings: Settings, ensemble: str, rows: range, steps_per_lyapunov_time: int, purpose: str
) -> tuple[ScheduledSeries, FloatArray]:
    """Series under an actuator that switches at random, and their observations.

    ``settings``: With ``parameters``, the names of the parameters that forecasters are given.
    ``purpose``: "training" or "test": the random streams are called after it.
    """
    given, actuation = settings["case.training.actuation"], settings["case.actuation"]
    system, names = equations_of(settings), settings["parameters"]
    parameters = parameters_of(settings, names)
    on: tuple[float, ...] = (given["strength"],)
    if names != [SHARE]:
        actuated = actuated_system(
            system, actuation["parameters"], actuation["force"], given["strength"]
        )
        on = SystemParameters.of(actuated, names).own
    interval = durations.positive_steps(
        given["interval_lt"], steps_per_lyapunov_time, "training.actuation.interval_lt"
    )
    switching = RandomActuation(
        interval,
        given["mean_on_lt"] / given["interval_lt"],
        given["mean_off_lt"] / given["interval_lt"],
    )
    root, case = settings["random_seed"], settings["case"]
    free = read_rows(ensemble, "state", rows.start, rows.stop)
    acting = switching.draw(
        CANDIDATES * len(rows),
        free.shape[1] - 1,
        random_streams.stream(root, f"{purpose} actuation", case),
    )
    found, _ = simulated_series(
        parameters,
        system,
        np.ascontiguousarray(np.tile(free[:, -1].T, CANDIDATES)),
        ActuationValues(parameters.own, on).schedule(acting.T).transpose(2, 0, 1),
        len(rows),
        time_step=settings["case.ensemble.time_step"],
        sampling_stride=settings["case.ensemble.sampling_stride"],
        laminarisation_threshold=settings["case.laminarisation_threshold"],
    )
    return found, observed_rows(settings, ensemble, rows.start, found.states, "actuated")
