"""Single forecasts of one forecaster: one of each outcome, and the last ones before a success."""

import numpy as np

from burstcast import durations
from burstcast.arrays import FloatArray
from burstcast.forecast.examples import (
    OUTCOMES,
    evaluate_lead_times,
    forecast_observable,
    horizon_example,
    outcome_examples,
    stretch,
)
from burstcast.forecast.windows import WindowSummaries
from burstcast.forecasters.base import Forecaster
from burstcast_workflow.harness.job import Provenance, run_job
from burstcast_workflow.harness.settings import Settings
from burstcast_workflow.harness.storage import (
    Variable,
    read_json,
    read_netcdf,
    read_rows,
    write_netcdf,
)
from burstcast_workflow.jobs.forecasters import read_forecaster, seen
from burstcast_workflow.jobs.horizons import horizon_search
from burstcast_workflow.jobs.systems import system_of
from burstcast_workflow.jobs.time_unit import lyapunov_time

BEFORE_WASHOUT_LT = 1.0
AFTER_EVENT_LT = 0.5
"""What is shown before the washout of a forecast, and after an event."""

Variables = dict[str, Variable]


def examples_of_forecaster(
    *,
    ensemble: str,
    summary: str,
    evaluation_set: str,
    events: str,
    time_unit: str | list[str],
    forecaster: str,
    forecast: str,
    horizon: str,
    examples: str,
    settings: Settings,
    provenance: Provenance,
) -> None:
    """Write true and forecast observables of the examples."""
    who = read_forecaster(forecaster, settings, time_unit)
    steps = lyapunov_time(settings, time_unit)
    mean = read_json(summary)["mean_observable"]
    outcomes = _outcomes(ensemble, evaluation_set, forecast, settings, who, steps)
    evaluations = _evaluations(ensemble, events, horizon, time_unit, settings, who, steps, mean)
    write_netcdf(examples, {**outcomes, **evaluations}, provenance)


def _outcomes(
    ensemble: str,
    evaluation_set: str,
    forecast_file: str,
    settings: Settings,
    forecaster: Forecaster,
    steps: int,
) -> Variables:
    """One forecast of the test set for each outcome, as variables of the file."""
    resolution = settings["classification.resolution_lt"]
    window_lt = settings["classification.window_lt"]
    prediction_time_lt = settings["figures.example_prediction_time_lt"]
    points = read_netcdf(evaluation_set)
    forecast = read_netcdf(forecast_file, "first", "largest")
    chosen = outcome_examples(
        WindowSummaries(forecast["first"], forecast["largest"]),
        WindowSummaries(points["first"], points["largest"]),
        points["washout_maximum"],
        first_window=round(prediction_time_lt / resolution) - 1,
        windows=round(window_lt / resolution),
        threshold=settings["case.event_threshold"],
    )
    before = durations.steps(settings["washout_lt"] + BEFORE_WASHOUT_LT, steps)
    # as far as the evaluation set surely reaches
    longest_lt = settings["classification.longest_prediction_time_lt"]
    reach = durations.steps(min(prediction_time_lt + 1, longest_lt) + window_lt, steps)
    rows = list(chosen.values())
    truth = np.full((len(rows), before + 1 + reach), np.nan)
    forecasts = np.full_like(truth, np.nan)
    for number, row in enumerate(rows):
        series = settings["case.training.series"] + int(points["series"][row])
        first = int(points["step"][row]) - before
        truth[number] = stretch(_observable(ensemble, series), first, truth.shape[1])
    if rows:
        given = seen(forecaster, points["washout"][rows], points["true_state"][rows, np.newaxis])
        forecasts[:, before + 1 :] = forecast_observable(
            forecaster, system_of(settings).observable, given, reach
        )
    meanings = ", ".join(f"{number}: {outcome}" for number, outcome in enumerate(OUTCOMES))
    return {
        "outcome": Variable(
            ("example",),
            np.array([OUTCOMES.index(outcome) for outcome in chosen], dtype=np.int64),
            "1",
            f"outcome ({meanings})",
        ),
        "example_time_lt": Variable(
            ("example_step",),
            np.arange(-before, reach + 1) / steps,
            "1",
            "time after the starting point in Lyapunov times",
        ),
        "example_truth": Variable(("example", "example_step"), truth, "1", "true observable"),
        "example_forecast": Variable(
            ("example", "example_step"), forecasts, "1", "forecast observable"
        ),
    }


def _evaluations(
    ensemble: str,
    events_file: str,
    horizon: str,
    time_unit: str | list[str],
    settings: Settings,
    forecaster: Forecaster,
    steps_per_lyapunov_time: int,
    mean_observable: float,
) -> Variables:
    """Forecasts of one event from its last starts, as variables of the file."""
    search = horizon_search(settings, time_unit, mean_observable)
    events = read_netcdf(events_file)
    example = horizon_example(
        read_netcdf(horizon)["prediction_horizon_lt"],
        search.lead_times_lt,
        settings["figures.example_horizon_lt"],
    )
    before = search.steps_before_event
    steps = before + 1 + durations.steps(AFTER_EVENT_LT, steps_per_lyapunov_time)
    truth = np.full(steps, np.nan)
    observed = np.full((before + 1, events["observed"].shape[2]), np.nan)
    starts: tuple[float, ...] = ()
    if example is not None:
        series, step = (int(events[name][example.event]) for name in ("series", "step"))
        truth = stretch(_observable(ensemble, series), step - before, steps)
        given = seen(forecaster, events["observed"], events["true_state"])
        observed = given[example.event]
        starts = example.lead_times_lt
    observable = system_of(settings).observable
    evaluations = evaluate_lead_times(forecaster, observable, observed, truth, starts, search)
    return {
        "evaluation_time_lt": Variable(
            ("event_step",),
            (np.arange(steps) - before) / steps_per_lyapunov_time,
            "1",
            "time after the event in Lyapunov times",
        ),
        "evaluation_truth": Variable(("event_step",), truth, "1", "true observable"),
        "evaluation_forecast": Variable(
            ("evaluation", "event_step"), evaluations.forecast, "1", "forecast observable"
        ),
        "evaluation_lead_time_lt": Variable(
            ("evaluation",), evaluations.lead_time_lt, "1", "tau_e in Lyapunov times"
        ),
        "evaluation_horizon_lt": Variable(
            ("evaluation",), evaluations.horizon_lt, "1", "horizon in Lyapunov times"
        ),
        "allowed_error": Variable((), search.tolerance, "1", "error at which a prediction is lost"),
    }


def _observable(ensemble: str, series: int) -> FloatArray:
    """Return the true observable of one kept series."""
    found: FloatArray = read_rows(ensemble, "observable", series, series + 1)[0]
    return found


if __name__ == "__main__":
    run_job(snakemake, examples_of_forecaster)  # noqa: F821 - Snakemake puts it there
