"""Check that what the forecasts of a case need fits into its series, at its computed Lyapunov time.

Nothing waits for it, but it runs before what would fail for the same reason, job after job.
"""

import numpy as np

from burstcast.base.files.netcdf import read_netcdf, variable_names
from burstcast_workflow.harness.job import JobSettings, at, job, write_json
from burstcast_workflow.jobs.cases import Clock
from burstcast_workflow.jobs.lengths import Lengths


class LengthsOfCase(JobSettings):
    """What the forecasters of the case need of its series."""

    lengths: Lengths
    clock: Clock
    kinds: list[str] = at("job.asked_of_series.kinds")
    validations: list[str] = at("job.asked_of_series.validations")
    long_runs: bool = at("job.asked_of_series.long_runs")


@job
def lengths_of_case(*, ensemble: str, lengths: str, settings: LengthsOfCase) -> None:
    """Write the steps of a Lyapunov time and of a series, or raise with all that does not fit."""
    needs, steps, samples = (
        settings.lengths,
        settings.clock.lyapunov_time,
        len(read_netcdf(ensemble, "time")["time"]),
    )
    training: list[int] = []
    if "length" in variable_names(ensemble):
        lengths_of_series = read_netcdf(ensemble, "length")["length"]
        trained, tested = np.split(lengths_of_series, [needs.training_series])
        training = sorted(trained.tolist(), reverse=True)
        samples = int(min(trained.max(), tested.max()))  # the longest series of either set
    problems = needs.misfits(
        steps,
        settings.clock.sampling_interval,
        samples,
        settings.kinds,
        settings.validations,
        settings.long_runs,
        training,
    )
    if problems:
        raise ValueError(
            f"a series of {samples} samples has {samples / steps:.3g} Lyapunov times of {steps} "
            f"steps; {'; '.join(problems)}"
        )
    record = {"case": settings.case, "steps_per_lyapunov_time": steps, "samples": samples}
    write_json(lengths, record, settings.provenance)
