"""Forecast the calibration set out of sample; keep only the window summaries."""

import numpy as np

from burstcast.base.files.netcdf import read_netcdf
from burstcast.forecasts.forecast_files import forecast_variables
from burstcast.forecasts.probabilities import announcement, out_of_sample_forecasts
from burstcast.forecasts.windows import window_forecasts
from burstcast_workflow.harness.job import JobSettings, at, job, tell, write_netcdf
from burstcast_workflow.jobs.cases import Washout
from burstcast_workflow.jobs.forecasters import Observing, seen
from burstcast_workflow.jobs.forecasts import Windows
from burstcast_workflow.jobs.series import read_scheduled


class Calibrating(JobSettings):
    """Forecasts of the calibration set."""

    observing: Observing
    windows: Windows
    washout: Washout
    calibration_series: int = at("probability.calibration_series")


@job
def forecast_calibration_set(
    *,
    ensemble: str,
    forecaster: str,
    calibration_set: str,
    scheduled: list[str],
    calibration_forecast: str,
    settings: Calibrating,
) -> None:
    """Forecast each training series without what it has taught, or other series as they are."""
    observing, forecasting = settings.observing, settings.observing.forecasting
    space, boundaries = forecasting.system.space, settings.windows.boundaries
    model = forecasting.read_forecaster(forecaster)
    points = read_netcdf(calibration_set)
    washouts = seen(model, points["washout"], points["true_washout"], points.get("parameter"))
    for text in announcement(model, space.observable, washouts, boundaries):
        tell(text)
    training_set = read_scheduled(scheduled, settings.case) if scheduled else None
    if settings.calibration_series or (training_set and not training_set.own_rows):
        forecasts = window_forecasts(model, space.observable, washouts, boundaries)
    else:
        if training_set:
            training = training_set.observed
            series = np.array(training_set.own_rows)[points["series"]]
        else:
            training, series = observing.learnt_rows(model, ensemble), points["series"]
        forecasts = out_of_sample_forecasts(
            model,
            training,
            forecasting.forecasting_case(ensemble),
            settings.washout.steps,
            space.observable,
            washouts,
            series,
            boundaries,
        )
    variables = forecast_variables(forecasts, space.observable_name)
    write_netcdf(calibration_forecast, variables, settings.provenance)
