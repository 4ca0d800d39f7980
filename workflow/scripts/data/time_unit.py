"""Find the unit of time of a case: the Lyapunov time, in steps of a forecast."""

from burstcast.base.durations import known_exponent, steps_per_lyapunov_time
from burstcast_workflow.harness.job import JobSettings, at, concerning, job, read_json, write_json
from burstcast_workflow.jobs.cases import Sampling


class TimeUnit(JobSettings):
    """The exponent that sets the Lyapunov time, and the steps of a forecast."""

    sampling: Sampling
    exponent: str = at("case.lyapunov.time_unit")
    given_exponent: float | None = at("case.lyapunov.given_exponent")


@job
def time_unit_of_case(*, exponents: str | list[str], time_unit: str, settings: TimeUnit) -> None:
    """Write the exponent, given or computed in a job, and the steps in a Lyapunov time."""
    exponent, interval = (
        known_exponent(settings.exponent, settings.given_exponent),
        settings.sampling.interval,
    )
    if exponent is None:
        assert isinstance(exponents, str)
        exponent = read_json(exponents)["leading"]["mean"]
    with concerning(f"the computed exponent ({TimeUnit.given_exponent}, {TimeUnit.exponent})"):
        steps = steps_per_lyapunov_time(exponent, interval)
    record = {
        "lyapunov_exponent": exponent,
        "sampling_interval": interval,
        "steps_per_lyapunov_time": steps,
    }
    write_json(time_unit, record, settings.provenance)
