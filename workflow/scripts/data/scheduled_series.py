"""Training series for forecasters that know the parameters: the case's own, or actuated ones."""

import numpy as np

from burstcast.data.scheduled_series import ScheduledSeries, scheduled_variables
from burstcast_workflow.harness.job import Settings, job, write_netcdf
from burstcast_workflow.jobs.data import known_rows, observed_rows, training_states
from burstcast_workflow.jobs.switched import switched_series
from burstcast_workflow.jobs.systems import parameters_of
from burstcast_workflow.jobs.time_unit import lyapunov_time


@job
def schedule_series(*, ensemble: str, scheduled_series: str, settings: Settings) -> None:
    """Write the series, what is observed of them, and the parameters in force."""
    free = training_states(settings, ensemble)
    actuated = settings["case.training.actuation"] is not None
    if actuated:
        steps = lyapunov_time(settings)
        series, observed = switched_series(settings, ensemble, range(len(free)), steps, "training")
    elif (known := known_rows(ensemble, 0, len(free))) is not None:
        if not np.ptp(known, axis=(0, 1)).any():
            raise ValueError("data.known: nothing of it varies in the training series")
        series, observed = ScheduledSeries(free, known), observed_rows(settings, ensemble, 0, free)
    else:
        own = parameters_of(settings, settings["parameters"]).own
        series = ScheduledSeries.constant(free, own)
        observed = observed_rows(settings, ensemble, 0, free)
    variables = scheduled_variables(series, observed)
    write_netcdf(scheduled_series, variables, {**settings.provenance, "actuated": int(actuated)})
