"""Forecast the calibration set out of sample; keep only the window summaries."""

import numpy as np

from burstcast import durations
from burstcast.files.netcdf import read_netcdf
from burstcast.forecast.forecast_files import forecast_variables
from burstcast.forecast.window_forecasts import window_forecasts
from burstcast.probability.out_of_sample import out_of_sample_forecasts
from burstcast_workflow.harness.job import Settings, job, write_netcdf
from burstcast_workflow.jobs.forecasters import (
    forecasting_case,
    learnt_rows,
    read_forecaster,
    seen,
)
from burstcast_workflow.jobs.forecasts import boundaries_of
from burstcast_workflow.jobs.scheduled import read_scheduled
from burstcast_workflow.jobs.systems import system_of
from burstcast_workflow.jobs.time_unit import lyapunov_time


@job
def forecast_calibration_set(
    *,
    ensemble: str,
    forecaster: str,
    calibration_set: str,
    scheduled: list[str],
    calibration_forecast: str,
    settings: Settings,
) -> None:
    """Forecast each training series without what it has taught, or other series as they are."""
    system, boundaries = system_of(settings), boundaries_of(settings)
    bound = settings["forecaster.divergence_bound"]
    model = read_forecaster(forecaster, settings, bound)
    points = read_netcdf(calibration_set)
    known = points.get("parameter")
    given = seen(model, points["washout"], points["true_washout"])
    learnt = read_scheduled(scheduled, settings["case"]) if scheduled else None
    if settings["probability.calibration_series"] or (learnt and not learnt.own_rows):
        forecasts = window_forecasts(model, system.observable, given, boundaries, known)
    else:
        forecasts = out_of_sample_forecasts(
            model,
            learnt.observed.states if learnt else learnt_rows(model, settings, ensemble),
            forecasting_case(settings, ensemble),
            durations.steps(settings["washout_lt"], lyapunov_time(settings)),
            system.observable,
            given,
            np.array(learnt.own_rows)[points["series"]] if learnt else points["series"],
            boundaries,
            learnt.schedules if learnt else None,
            known,
        )
    variables = forecast_variables(forecasts, system.observable_name)
    write_netcdf(calibration_forecast, variables, settings.provenance)
