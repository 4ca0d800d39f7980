"""Single forecasts of one forecaster: one of each outcome, and the last ones before a success."""

from burstcast.base.files.netcdf import read_netcdf, read_rows, variables_of
from burstcast.data.starting_points import SeriesPoints
from burstcast.forecasters.base import Forecaster
from burstcast.forecasts.examples import (
    OutcomeExamples,
    evaluate_event,
    forecast_outcomes,
    outcome_examples,
)
from burstcast.forecasts.windows import WindowSummaries
from burstcast_workflow.harness.job import JobSettings, at, job, write_netcdf
from burstcast_workflow.jobs.forecasters import Forecasting, seen
from burstcast_workflow.jobs.forecasts import Horizons, Windows
from burstcast_workflow.jobs.series import Training

BEFORE_WASHOUT_LT = 1.0
AFTER_EVENT_LT = 0.5
"""What is shown before the washout of a forecast, and after an event."""


class Examples(JobSettings):
    """Which forecasts are shown."""

    forecasting: Forecasting
    windows: Windows
    horizons: Horizons
    training: Training
    prediction_time_lt: float = at("shown.example_prediction_time_lt")
    wanted_lt: float = at("figures.example_horizon_lt")


def _outcomes(
    ensemble: str,
    evaluation_set: str,
    forecast_file: str,
    settings: Examples,
    forecaster: Forecaster,
) -> OutcomeExamples:
    """One forecast of the test set for each outcome."""
    windows, washout = settings.windows, settings.horizons.washout
    window_lt, prediction_time_lt = windows.window_lt, settings.prediction_time_lt
    points = read_netcdf(evaluation_set)
    chosen = outcome_examples(
        WindowSummaries(**read_netcdf(forecast_file, "first", "largest")),
        WindowSummaries(points["first"], points["largest"]),
        points["washout_maximum"],
        first_window=round(prediction_time_lt / windows.resolution_lt) - 1,
        windows=round(window_lt / windows.resolution_lt),
        threshold=settings.horizons.event_threshold,
    )
    # as far as the evaluation set surely reaches
    reach_lt = min(prediction_time_lt + 1, windows.longest_prediction_time_lt) + window_lt
    first, rows = settings.training.series, list(chosen.values())
    return forecast_outcomes(
        forecaster,
        settings.forecasting.system.space.observable,
        seen(forecaster, points["washout"][rows], points["true_washout"][rows]),
        read_rows(ensemble, "observable", first, first + int(points["series"].max()) + 1),
        SeriesPoints(points["series"][rows], points["step"][rows]),
        list(chosen),
        before=washout.clock.steps(washout.lt + BEFORE_WASHOUT_LT),
        reach=washout.clock.steps(reach_lt),
        steps_per_lyapunov_time=washout.clock.lyapunov_time,
    )


@job
def examples_of_forecaster(
    *,
    ensemble: str,
    summary: str,
    evaluation_set: str,
    events: str,
    forecaster: str,
    forecast: str,
    horizon: str,
    examples: str,
    settings: Examples,
) -> None:
    """Write true and forecast observables of the examples."""
    model = settings.forecasting.read_forecaster(forecaster)
    outcomes = _outcomes(ensemble, evaluation_set, forecast, settings, model)
    before = read_netcdf(events)
    evaluations = evaluate_event(
        model,
        settings.forecasting.system.space.observable,
        seen(model, before["observed"], before["true_state"]),
        SeriesPoints(before["series"], before["step"]),
        lambda series: read_rows(ensemble, "observable", series, series + 1)[0],
        read_netcdf(horizon)["prediction_horizon_lt"],
        settings.horizons.search(summary),
        wanted_lt=settings.wanted_lt,
        after_lt=AFTER_EVENT_LT,
    )
    write_netcdf(examples, variables_of(outcomes) | variables_of(evaluations), settings.provenance)
