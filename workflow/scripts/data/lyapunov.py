"""Lyapunov exponents of a case: the spectrum by QR, the leading one by growth of perturbations."""

import numpy as np

from burstcast.base import random_streams
from burstcast.base.files.netcdf import read_rows, variables_of
from burstcast.base.resampling import mean_with_interval
from burstcast.systems.base import has_own
from burstcast.systems.lyapunov import (
    alignment_of,
    attractor_size,
    checked_jacobian,
    exponents_record,
    lyapunov_spectrum,
    perturbation_growth,
)
from burstcast_workflow.harness.job import JobSettings, at, job, write_json, write_netcdf
from burstcast_workflow.jobs.cases import Sampling, System
from burstcast_workflow.jobs.series import check_kept_series, kept_series


class Exponents(JobSettings):
    """Lyapunov exponents of the case."""

    system: System
    sampling: Sampling
    random_seed: int = at("random_seed")
    series: int = at("case.lyapunov.series")
    exponents: int = at("case.lyapunov.exponents")
    perturbation: float = at("case.lyapunov.perturbation")
    saturation: float = at("case.lyapunov.saturation")
    orthonormalisation_interval: float = at("case.lyapunov.orthonormalisation_interval")


@job
def lyapunov(*, ensemble: str, exponents: str, spectrum: str, settings: Exponents) -> None:
    """Write the exponents with their 95 % confidence intervals, also of each series."""
    system, series = settings.system.equations, settings.series
    time_step, stride = settings.sampling.time_step, settings.sampling.stride
    check_kept_series(kept_series(ensemble), {str(Exponents.series): series})
    states = read_rows(ensemble, "state", 0, series)
    start = np.ascontiguousarray(states[:, 0].T)
    if has_own(system, "jacobian") and not has_own(system, "flow_map"):
        checked_jacobian(system, start)
    # along the kept series, which are known not to laminarise
    steps = (states.shape[1] - 1) * stride
    interval = round(settings.orthonormalisation_interval / time_step)
    alignment = alignment_of(steps, interval)
    by_series = lyapunov_spectrum(
        system,
        start,
        time_step,
        steps - alignment,
        interval,
        alignment_steps=alignment,
        exponents=min(system.dimension, settings.exponents),
    )
    size = attractor_size(states.reshape(-1, states.shape[2]).T)
    growth = perturbation_growth(
        system,
        start,
        time_step,
        steps - alignment,
        settings.perturbation * size,
        settings.saturation * size,
        random_streams.stream(settings.random_seed, "lyapunov", settings.case),
        alignment_steps=alignment,
    )
    estimates = exponents_record(
        mean_with_interval(by_series.exponents), mean_with_interval(growth)
    )
    record = {"series": len(states), "duration": by_series.duration, **estimates}
    write_json(exponents, record, settings.provenance)
    write_netcdf(spectrum, variables_of(by_series), settings.provenance)
