"""Lyapunov exponents of a forecaster's own flow, along its long runs that stay chaotic."""

import numpy as np

from burstcast import random_streams
from burstcast.files.netcdf import read_netcdf, variables_of
from burstcast.statistics.long_term import Fate
from burstcast.statistics.lyapunov_spectrum import forecaster_spectrum
from burstcast_workflow.harness.job import Settings, job, write_netcdf
from burstcast_workflow.jobs.forecasters import read_forecaster
from burstcast_workflow.jobs.long_runs import long_run_washouts
from burstcast_workflow.jobs.time_unit import long_run_steps, sampling_interval


@job
def lyapunov_spectrum(
    *, ensemble: str, forecaster: str, long_term: str, spectrum: str, settings: Settings
) -> None:
    """Write the leading exponents of each of the first runs that were kept."""
    model = read_forecaster(forecaster, settings)
    washouts = long_run_washouts(settings, ensemble, model)
    kept = np.flatnonzero(read_netcdf(long_term, "fate")["fate"] == Fate.KEPT)
    interval = sampling_interval(settings)
    found = forecaster_spectrum(
        model,
        washouts[kept[: settings["statistics.lyapunov_runs"]]],
        long_run_steps(settings, ensemble),
        max(1, round(settings["case.lyapunov.orthonormalisation_interval"] / interval)),
        settings["statistics.lyapunov_exponents"],
        interval,
        random_streams.stream(
            settings["random_seed"], "lyapunov spectrum", settings["case"], settings["forecaster"]
        ),
    )
    write_netcdf(spectrum, variables_of(found), settings.provenance)
