"""Lyapunov exponents of a forecaster's own flow, along its long runs that stay chaotic."""

import numpy as np

from burstcast.base import random_streams
from burstcast.base.files.netcdf import read_netcdf, variables_of
from burstcast.statistics.long_term import Fate
from burstcast.statistics.lyapunov_spectrum import forecaster_spectrum
from burstcast_workflow.harness.job import JobSettings, at, job, write_netcdf
from burstcast_workflow.jobs.forecasters import Forecasting
from burstcast_workflow.jobs.forecasts import LongRuns


class Spectrum(JobSettings):
    """Exponents along long runs."""

    forecasting: Forecasting
    long_runs: LongRuns
    orthonormalisation_interval: float = at("case.lyapunov.orthonormalisation_interval")
    exponents: int = at("statistics.lyapunov_exponents")
    runs: int = at("statistics.lyapunov_runs")


@job
def lyapunov_spectrum(
    *, ensemble: str, forecaster: str, long_term: str, spectrum: str, settings: Spectrum
) -> None:
    """Write the leading exponents of each of the first runs that were kept."""
    model = settings.forecasting.read_forecaster(forecaster)
    washouts = settings.long_runs.washouts(ensemble, model)
    kept = np.flatnonzero(read_netcdf(long_term, "fate")["fate"] == Fate.KEPT)
    interval = settings.forecasting.clock.sampling_interval
    exponents = forecaster_spectrum(
        model,
        washouts[kept[: settings.runs]],
        settings.long_runs.run_steps(ensemble),
        max(1, round(settings.orthonormalisation_interval / interval)),
        settings.exponents,
        interval,
        random_streams.stream(
            settings.forecasting.random_seed,
            "lyapunov spectrum",
            settings.case,
            settings.forecaster,
        ),
    )
    write_netcdf(spectrum, variables_of(exponents), settings.provenance)
