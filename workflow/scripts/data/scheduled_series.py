"""Training series for forecasters that know the parameters: the case's own, or actuated ones."""

import numpy as np

from burstcast.data.scheduled_series import scheduled_variables
from burstcast_workflow.harness.job import job, write_netcdf
from burstcast_workflow.jobs.series import Switched, known_rows


@job
def schedule_series(*, ensemble: str, scheduled_series: str, settings: Switched) -> None:
    """Write the series, what is observed of them, and the parameters in force."""
    states = settings.observed.training.states(ensemble)
    actuated = settings.switching is not None
    if actuated:
        rows = range(len(states))
        states, observed, schedules = settings.series(ensemble, rows, "training")
    else:
        observed = settings.observed.rows(ensemble, 0, states)
        columns = known_rows(ensemble, 0, len(states))
        if columns is None:
            series, time, _ = states.shape
            constant = settings.known_parameters.constant(time - 1, series)
            schedules = constant.transpose(2, 0, 1)
        elif np.ptp(columns, axis=(0, 1)).any():
            schedules = columns
        else:
            raise ValueError("data.known: nothing of it varies in the training series")
    variables = scheduled_variables(states, observed, schedules)
    write_netcdf(scheduled_series, variables, {**settings.provenance, "actuated": int(actuated)})
