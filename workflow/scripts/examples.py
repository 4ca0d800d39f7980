"""Single forecasts of one network: one of each outcome, and the last ones before a success."""

from typing import Any

import numpy as np

from burstcast import durations
from burstcast.forecast.examples import (
    OUTCOMES,
    evaluate_lead_times,
    forecast_observable,
    horizon_example,
    outcome_examples,
    stretch,
)
from burstcast.forecast.horizon import HorizonSearch
from burstcast.forecast.windows import WindowSummaries
from burstcast.systems.registry import make_system
from burstcast_workflow.job import Provenance, run_job
from burstcast_workflow.network_files import read_forecaster
from burstcast_workflow.storage import Variable, read_json, read_netcdf, read_rows, write_netcdf
from burstcast_workflow.time_unit import read_steps_per_lyapunov_time


def main(inputs: Any, outputs: Any, settings: dict[str, Any], provenance: Provenance) -> None:
    """Write true and forecast observables of the examples."""
    lyapunov_time = read_steps_per_lyapunov_time(settings, inputs.lyapunov)
    observable = make_system(settings["system"], settings["parameters"]).observable
    forecaster = read_forecaster(inputs.network, settings["kernel"])
    variables = {
        **_outcomes(inputs, settings, forecaster, observable, lyapunov_time),
        **_evaluations(inputs, settings, forecaster, observable, lyapunov_time),
    }
    write_netcdf(outputs.examples, variables, provenance)


def _outcomes(inputs, settings, forecaster, observable, lyapunov_time):
    """One forecast of the test set for each outcome, as variables of the file."""
    resolution = settings["resolution_lt"]
    test_set = read_netcdf(inputs.test_set)
    forecast = read_netcdf(inputs.forecast, "first", "largest")
    chosen = outcome_examples(
        WindowSummaries(forecast["first"], forecast["largest"]),
        WindowSummaries(test_set["first"], test_set["largest"]),
        test_set["washout_maximum"],
        first_window=round(settings["prediction_time_lt"] / resolution) - 1,
        windows=round(settings["window_lt"] / resolution),
        threshold=settings["event_threshold"],
    )
    before = durations.steps(settings["before_lt"], lyapunov_time)
    reach = durations.steps(settings["reach_lt"], lyapunov_time)
    rows = list(chosen.values())
    truth = np.full((len(rows), before + 1 + reach), np.nan)
    forecasts = np.full_like(truth, np.nan)
    for number, row in enumerate(rows):
        series = settings["training_series"] + int(test_set["series"][row])
        first = int(test_set["step"][row]) - before
        truth[number] = stretch(_observable(inputs, series), first, truth.shape[1])
    if rows:
        forecasts[:, before + 1 :] = forecast_observable(
            forecaster, observable, test_set["washout"][rows], reach
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
            np.arange(-before, reach + 1) / lyapunov_time,
            "1",
            "time after the starting point in Lyapunov times",
        ),
        "example_truth": Variable(("example", "example_step"), truth, "1", "true observable"),
        "example_forecast": Variable(
            ("example", "example_step"), forecasts, "1", "forecast observable"
        ),
    }


def _evaluations(inputs, settings, forecaster, observable, lyapunov_time):
    """Forecasts of one event from its last starts, as variables of the file."""
    horizon = settings["horizon"]
    threshold = settings["event_threshold"]
    search = HorizonSearch(
        longest_lead_time_lt=horizon["longest_start_lt"],
        lead_time_step_lt=horizon["start_step_lt"],
        tolerance=horizon["tolerance"] * (threshold - read_json(inputs.summary)["mean_observable"]),
        washout=durations.steps(settings["washout_lt"], lyapunov_time),
        steps_per_lyapunov_time=lyapunov_time,
    )
    events = read_netcdf(inputs.events)
    example = horizon_example(
        read_netcdf(inputs.horizon)["prediction_horizon_lt"],
        search.lead_times_lt,
        settings["horizon_lt"],
    )
    before = search.steps_before_event
    steps = before + 1 + durations.steps(settings["after_event_lt"], lyapunov_time)
    truth = np.full(steps, np.nan)
    observed = np.full((before + 1, events["observed"].shape[2]), np.nan)
    starts = ()
    if example is not None:
        series, step = (int(events[name][example.event]) for name in ("series", "step"))
        truth = stretch(_observable(inputs, series), step - before, steps)
        observed = events["observed"][example.event]
        starts = example.lead_times_lt
    evaluations = evaluate_lead_times(forecaster, observable, observed, truth, starts, search)
    return {
        "evaluation_time_lt": Variable(
            ("event_step",),
            (np.arange(steps) - before) / lyapunov_time,
            "1",
            "time after the event in Lyapunov times",
        ),
        "evaluation_truth": Variable(("event_step",), truth, "1", "true observable"),
        "evaluation_forecast": Variable(
            ("evaluation", "event_step"), evaluations.forecast, "1", "forecast observable"
        ),
        "evaluation_start_lt": Variable(
            ("evaluation",), evaluations.lead_time_lt, "1", "tau_e in Lyapunov times"
        ),
        "evaluation_horizon_lt": Variable(
            ("evaluation",), evaluations.horizon_lt, "1", "horizon in Lyapunov times"
        ),
        "allowed_error": Variable((), search.tolerance, "1", "error at which a prediction is lost"),
    }


def _observable(inputs, series):
    """Return the true observable of one kept series."""
    return read_rows(inputs.ensemble, "observable", series, series + 1)[0]


if __name__ == "__main__":
    run_job(snakemake, main)  # noqa: F821 - Snakemake puts it there
