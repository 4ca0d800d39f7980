"""Single forecasts of one forecaster: one of each outcome, and the last ones before a success."""

from burstcast import durations
from burstcast.data.starting_points import SeriesPoints
from burstcast.files.netcdf import read_netcdf, read_rows, variables_of
from burstcast.forecast.examples import (
    OutcomeExamples,
    evaluate_event,
    forecast_outcomes,
    outcome_examples,
)
from burstcast.forecast.windows import WindowSummaries
from burstcast.forecasters.base import Forecaster
from burstcast_workflow.harness.job import Settings, job, write_netcdf
from burstcast_workflow.jobs.forecasters import read_forecaster, seen
from burstcast_workflow.jobs.forecasts import horizon_search
from burstcast_workflow.jobs.systems import system_of
from burstcast_workflow.jobs.time_unit import lyapunov_time

BEFORE_WASHOUT_LT = 1.0
AFTER_EVENT_LT = 0.5
"""What is shown before the washout of a forecast, and after an event."""


def _outcomes(
    ensemble: str,
    evaluation_set: str,
    forecast_file: str,
    settings: Settings,
    forecaster: Forecaster,
) -> OutcomeExamples:
    """One forecast of the test set for each outcome."""
    steps = lyapunov_time(settings)
    resolution = settings["classification.resolution_lt"]
    window_lt = settings["classification.window_lt"]
    prediction_time_lt = settings["prediction_time_lt"]
    points = read_netcdf(evaluation_set)
    chosen = outcome_examples(
        WindowSummaries(**read_netcdf(forecast_file, "first", "largest")),
        WindowSummaries(points["first"], points["largest"]),
        points["washout_maximum"],
        first_window=round(prediction_time_lt / resolution) - 1,
        windows=round(window_lt / resolution),
        threshold=settings["case.event_threshold"],
    )
    # as far as the evaluation set surely reaches
    longest_lt = settings["classification.longest_prediction_time_lt"]
    reach_lt = min(prediction_time_lt + 1, longest_lt) + window_lt
    first, rows = settings["case.training.series"], list(chosen.values())
    return forecast_outcomes(
        forecaster,
        system_of(settings).observable,
        seen(forecaster, points["washout"][rows], points["true_washout"][rows]),
        read_rows(ensemble, "observable", first, first + int(points["series"].max()) + 1),
        SeriesPoints(points["series"][rows], points["step"][rows]),
        list(chosen),
        before=durations.steps(settings["washout_lt"] + BEFORE_WASHOUT_LT, steps),
        reach=durations.steps(reach_lt, steps),
        steps_per_lyapunov_time=steps,
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
    settings: Settings,
) -> None:
    """Write true and forecast observables of the examples."""
    model = read_forecaster(forecaster, settings)
    outcomes = _outcomes(ensemble, evaluation_set, forecast, settings, model)
    before = read_netcdf(events)
    evaluations = evaluate_event(
        model,
        system_of(settings).observable,
        seen(model, before["observed"], before["true_state"]),
        SeriesPoints(before["series"], before["step"]),
        lambda series: read_rows(ensemble, "observable", series, series + 1)[0],
        read_netcdf(horizon)["prediction_horizon_lt"],
        horizon_search(settings, summary),
        wanted_lt=settings["figures.example_horizon_lt"],
        after_lt=AFTER_EVENT_LT,
    )
    write_netcdf(examples, variables_of(outcomes) | variables_of(evaluations), settings.provenance)
