"""The unit of time of a case, from the config or from the exponent that a job computed."""

from burstcast import durations
from burstcast.files.netcdf import read_netcdf
from burstcast_workflow.harness.settings import Settings, concerning


def sampling_interval(settings: Settings) -> float:
    """Time between two steps of a forecast, in time units."""
    stride = settings["case.ensemble.sampling_stride"]
    return float(settings["case.ensemble.time_step"] * stride)


def long_run_steps(settings: Settings, ensemble: str) -> int:
    """Steps of each long run; without ``statistics.duration``, as many as a series has."""
    duration: float | None = settings["statistics.duration"]
    if duration is None:
        return len(read_netcdf(ensemble, "time")["time"]) - 1
    return round(duration / sampling_interval(settings))


def lyapunov_time(settings: Settings) -> int:
    """Network steps in a Lyapunov time."""
    published, interval = settings["case.lyapunov.published_exponent"], sampling_interval(settings)
    known = durations.known_exponent(settings["case.lyapunov.time_unit"], published)
    if known is not None:
        return durations.steps_per_lyapunov_time(known, interval)
    assert settings.computed_exponent is not None
    with concerning("the computed exponent (lyapunov.published_exponent, lyapunov.time_unit)"):
        return durations.steps_per_lyapunov_time(settings.computed_exponent, interval)
