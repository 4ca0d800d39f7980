"""Measure how far the statistics of forecasters and of the training set are from the data's."""

from burstcast import random_streams
from burstcast.files.netcdf import read_netcdf
from burstcast.statistics.intervals import resampled_measures
from burstcast.statistics.long_term import Fate
from burstcast.statistics.measures import compare
from burstcast.statistics.profiles import equally_spaced_profiles
from burstcast.statistics.resampling import bootstrap_weights
from burstcast_workflow.harness.job import job
from burstcast_workflow.harness.settings import Settings
from burstcast_workflow.jobs.gather import case_keys, gathered
from burstcast_workflow.jobs.statistics import read_reductions, read_statistics
from burstcast_workflow.jobs.systems import system_of
from burstcast_workflow.jobs.tables import between, write_tables

SHARES = {
    "laminarised_fraction": Fate.LAMINAR,
    "fixed_point_fraction": Fate.FIXED_POINT,
    "diverged_fraction": Fate.DIVERGED,
}
"""Parts of the discarded share, by what became of the runs."""

OF_PROFILES = ("nrmse_u", "nrmse_uu", "nrmse_uv")
"""Measures that only a flow has."""


@job
def statistics_table(
    *,
    data: str,
    training: str,
    floor: str,
    long_term: list[str],
    tables: list[str],
    settings: Settings,
) -> None:
    """Write one row for each forecaster, for the training set and for each sampling floor.

    With the intervals of the forecasters' statistics over their long runs.
    """
    reference = read_statistics(data)
    matrices = equally_spaced_profiles(system_of(settings), settings["statistics.profile_points"])
    of_case = {**case_keys(settings), "neurons": None, "validation": None}
    measures = vars(compare(reference, read_statistics(training), matrices))
    rows = [{**of_case, "forecaster": "training", "seed": None, **measures}]
    # one row for each split of the data
    splits = read_netcdf(floor)
    for split in range(splits["split"].size):
        row = {measure: float(splits[measure][split]) for measure in measures}
        rows.append({**of_case, "forecaster": "floor", "seed": split, **row})
    ends = []
    for keys, origin in gathered(settings, long_term):
        measures = vars(compare(reference, read_statistics(origin.path), matrices))
        fates = read_netcdf(origin.path, "fate")["fate"]
        shares = {name: float((fates == fate).mean()) for name, fate in SHARES.items()}
        discarded = {"discarded_fraction": float((fates != Fate.KEPT).mean()), **shares}
        rows.append({**keys, **discarded, **measures})
        generator = random_streams.stream(
            settings["random_seed"], "bootstrap", settings["case"], "long runs"
        )
        weights = bootstrap_weights(len(fates), settings["bootstrap.resamples"], generator)
        samples = {
            "discarded_fraction": weights @ (fates != Fate.KEPT) / len(fates),
            **{name: weights @ (fates == fate) / len(fates) for name, fate in SHARES.items()},
            **resampled_measures(
                reference, read_reductions(origin.path), fates == Fate.KEPT, matrices, weights
            ),
        }
        ends += [
            {
                **keys,
                "metric": metric,
                **between(values, settings["bootstrap.confidence"]),
            }
            for metric, values in samples.items()
            if not (metric in OF_PROFILES and matrices is None)
        ]
    write_tables(tables, settings, statistics=rows, statistics_intervals=ends)
