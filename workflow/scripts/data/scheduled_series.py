"""Training series for forecasters that know the parameters: the case's own, or actuated ones."""

import numpy as np

from burstcast.data.scheduled_series import ScheduledSeries, scheduled_variables
from burstcast_workflow.harness.job import job, write_netcdf
from burstcast_workflow.jobs.data import known_rows
from burstcast_workflow.jobs.switched import Switched


@job
def schedule_series(*, ensemble: str, scheduled_series: str, settings: Switched) -> None:
    """Write the series, what is observed of them, and the parameters in force."""
    free = settings.training_states(ensemble)
    actuated = settings.switching is not None
    if actuated:
        series, observed = settings.switched_series(ensemble, range(len(free)), "training")
    elif (schedules := known_rows(ensemble, 0, len(free))) is not None:
        if not np.ptp(schedules, axis=(0, 1)).any():
            raise ValueError("data.known: nothing of it varies in the training series")
        series, observed = (
            ScheduledSeries(free, schedules),
            settings.observed_rows(ensemble, 0, free),
        )
    else:
        series = ScheduledSeries.constant(free, settings.known_parameters.defaults)
        observed = settings.observed_rows(ensemble, 0, free)
    variables = scheduled_variables(series, observed)
    write_netcdf(scheduled_series, variables, {**settings.provenance, "actuated": int(actuated)})
