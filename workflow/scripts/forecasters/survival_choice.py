"""Choose, of equally good hyperparameters, the ones with the best survival."""

import numpy as np

from burstcast.files.netcdf import read_netcdf
from burstcast.files.tables import read_table
from burstcast.statistics.long_term import Fate, run_long_term
from burstcast.statistics.survival import Lifetimes, escape_rate
from burstcast.tuning.survival import as_good_as_the_best, nearest_escape_rate
from burstcast_workflow.harness.job import at, job, write_json, write_table
from burstcast_workflow.jobs.long_runs import LongTerm
from burstcast_workflow.jobs.networks import Networks
from burstcast_workflow.jobs.trained_networks import trained_networks


class Survival(LongTerm, Networks):
    """How fast long runs of networks escape."""

    confidence: float = at("bootstrap.confidence")


@job
def choose_by_survival(
    *,
    ensemble: str,
    scheduled: list[str],
    trace: str,
    chosen: str,
    candidates: str,
    settings: Survival,
) -> None:
    """Write how fast the candidates' long runs escape, and the point that is taken."""
    interval, confidence = settings.sampling_interval, settings.confidence
    found = read_netcdf(ensemble, "series", "lifetime", "time")
    whole = Lifetimes.of_ensemble(found["lifetime"], found["series"], len(found["time"]) - 1)
    of_training = whole.of_training(found["series"], settings.training_series)
    data = escape_rate(of_training, interval, confidence)
    points = read_table(trace)
    good = as_good_as_the_best(
        points["excess"].to_numpy(dtype=np.float64),
        points["paired_standard_error"].to_numpy(dtype=np.float64),
    )
    points = points[good].sort_values("objective", kind="stable")
    how, bound = settings.long_term(ensemble), settings.divergence_bound
    rates = []
    records = ({str(key): at for key, at in one.items()} for one in points.to_dict("records"))
    for model in trained_networks(settings, ensemble, scheduled, records, bound):
        washouts = settings.washouts(ensemble, model)
        run = run_long_term(model, settings.space.observable, washouts, how)
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
    names += [name for name in ["leak_rate"] if name in table]
    write_json(chosen, table.iloc[row][names].dropna().to_dict(), settings.provenance)
