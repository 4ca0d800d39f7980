"""Check that what the forecasts of a case need fits into its series, at its computed Lyapunov time.

Nothing waits for it, but it runs before what would fail for the same reason, job after job.
"""

from burstcast.files.netcdf import read_netcdf
from burstcast_workflow.harness.job import Settings, job, write_json
from burstcast_workflow.jobs.lengths import misfits
from burstcast_workflow.jobs.time_unit import lyapunov_time, sampling_interval


@job
def lengths_of_case(*, ensemble: str, lengths: str, settings: Settings) -> None:
    """Write the steps of a Lyapunov time and of a series, or raise with all that does not fit."""
    steps, samples = lyapunov_time(settings), len(read_netcdf(ensemble, "time")["time"])
    problems = misfits(
        settings,
        steps,
        samples,
        sampling_interval(settings),
        settings["asked.kinds"],
        settings["asked.validations"],
        settings["asked.long_runs"],
    )
    if problems:
        raise ValueError(
            f"a series of {samples} samples has {samples / steps:.3g} Lyapunov times of {steps} "
            f"steps; {'; '.join(problems)}"
        )
    found = {"case": settings["case"], "steps_per_lyapunov_time": steps, "samples": samples}
    write_json(lengths, found, settings.provenance)
