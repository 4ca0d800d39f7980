"""Long run of control: flows go on for as long as asked, and only their events are counted."""

from dataclasses import replace
from typing import Any

from burstcast.base.files.netcdf import variables_of
from burstcast.base.names import parsed
from burstcast.control.controllers import controlling_policy
from burstcast.control.long_run import run_long
from burstcast_workflow.harness.job import JobSettings, at, job, write_netcdf
from burstcast_workflow.jobs.control import Controlled, sensor_of


class LongControl(JobSettings):
    """Long runs of control by any controller."""

    run: Controlled
    aware: dict[str, Any] | None = at("forecasters.aware", otherwise=None)
    sensor: dict[str, Any] | None = at("control.sensor", otherwise=None)
    levels: list[float] = at("control.return_levels")


@job
def long_control(
    *,
    ensemble: str,
    summary: str,
    forecasters: list[str],
    encoder: str | list[str],
    counts: str,
    settings: LongControl,
) -> None:
    """Write counts of each flow and level."""
    control, case = settings.run, settings.run.forecasting
    sensor = sensor_of(settings.sensor, case.system.equations, encoder)
    strategy, experiment, asked = control.deciding(
        ensemble, summary, forecasters, sensor, settings.aware
    )
    # random streams are called after the case that is observed
    experiment = replace(experiment, case=control.observed or experiment.case)
    role = parsed(settings.controller).role or "forecaster"
    scales = control.noise_scales(ensemble, asked, sensor)
    run = run_long(
        experiment,
        strategy.timing(experiment.schedule),
        controlling_policy(role, strategy, experiment, asked),
        levels=sorted({control.event_threshold, *settings.levels}),
        laminarisation_threshold=control.laminarisation_threshold,
        noise_scale=None if scales is None else control.noise * scales.standard_deviation,
    )
    attributes: dict[str, str | int | float] = {
        **settings.provenance,
        **control.attributes,
        "steps_per_lyapunov_time": case.clock.lyapunov_time,
    }
    write_netcdf(counts, variables_of(run), attributes)
