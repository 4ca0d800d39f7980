"""Choose, of equally good hyperparameters, the ones with the best survival."""

from typing import Any

import numpy as np

from burstcast import durations
from burstcast.files.netcdf import read_netcdf
from burstcast.statistics.long_term import Fate, run_long_term
from burstcast.statistics.survival import Lifetimes, escape_rate
from burstcast.tuning.survival import as_good_as_the_best, nearest_escape_rate
from burstcast_workflow.harness.job import Settings, job, write_json
from burstcast_workflow.harness.tables import read_table, write_table
from burstcast_workflow.jobs.forecasters import kind_of
from burstcast_workflow.jobs.long_runs import long_run_washouts, long_term_settings
from burstcast_workflow.jobs.networks import (
    dynamics_at,
    knowledge,
    reservoir_seed,
    training_series,
)
from burstcast_workflow.jobs.systems import system_of
from burstcast_workflow.jobs.time_unit import lyapunov_time, sampling_interval


@job
def choose_by_survival(
    *,
    ensemble: str,
    scheduled: list[str],
    trace: str,
    chosen: str,
    candidates: str,
    settings: Settings,
) -> None:
    """Write how fast the candidates' long runs escape, and the point that is taken."""
    interval, confidence = sampling_interval(settings), settings["bootstrap.confidence"]
    found = read_netcdf(ensemble, "series", "lifetime", "time")
    whole = Lifetimes.of_ensemble(found["lifetime"], found["series"], len(found["time"]) - 1)
    of_training = whole.of_training(found["series"], settings["case.training.series"])
    data = escape_rate(of_training, interval, confidence)
    points = read_table(trace)
    good = as_good_as_the_best(
        points["excess"].to_numpy(dtype=np.float64),
        points["paired_standard_error"].to_numpy(dtype=np.float64),
    )
    points = points[good].sort_values("objective", kind="stable")
    series = training_series(settings, ensemble, scheduled)
    how = long_term_settings(settings, ensemble)
    networks: Any = kind_of(settings["forecaster"])
    told = knowledge(settings, scheduled)
    seed = reservoir_seed(settings, settings["forecaster"])
    rates = []
    for point in points.to_dict("records"):
        values = {str(key): at for key, at in point.items()}
        model = networks.trained(
            dynamics_at(settings, seed, series.dimension, values),
            seed,
            series,
            washout=durations.steps(settings["washout_lt"], lyapunov_time(settings)),
            tikhonov=values["tikhonov"],
            divergence_bound=settings["forecaster.divergence_bound"],
            **told,
        )
        washouts = long_run_washouts(settings, ensemble, model)
        run = run_long_term(model, system_of(settings).observable, washouts, how)
        lifetimes = Lifetimes(run.lifetimes, run.fates != Fate.KEPT, how.steps)
        rates.append(escape_rate(lifetimes, interval, confidence))
    row = nearest_escape_rate(np.array([rate.rate for rate in rates]), data.rate)
    table = points.assign(
        escapes=[rate.escapes for rate in rates],
        escape_rate=[rate.rate for rate in rates],
        escape_rate_low=[rate.low for rate in rates],
        escape_rate_high=[rate.high for rate in rates],
        escape_rate_of_data=data.rate,
        escape_rate_of_data_low=data.low,
        escape_rate_of_data_high=data.high,
        chosen=np.arange(len(points)) == row,
    )
    write_table(candidates, table)
    names = ["spectral_radius", "input_scaling", "tikhonov", "objective", "solver"]
    write_json(chosen, table.iloc[row][names].to_dict(), settings.provenance)
