"""Measure distances of the statistics of forecasters and of the training set from the data's."""

from collections.abc import Mapping, Sequence
from dataclasses import fields
from typing import Any

from burstcast.base import random_streams
from burstcast.base.declared import at, declaring, gathered, read
from burstcast.base.names import ForecasterName
from burstcast.base.resampling import bootstrap_weights
from burstcast.statistics.intervals import resampled_measures
from burstcast.statistics.long_term import Fate
from burstcast.statistics.measures import compare
from burstcast.statistics.profiles import equally_spaced_profiles
from burstcast.statistics.reductions import LongTermStatistics, SeriesReductions
from burstcast.systems.registry import make_space
from burstcast.tables.cells import between
from burstcast.tables.makers.registry import Gathered, Rows

SHARES = {
    "laminarised_fraction": Fate.LAMINAR,
    "fixed_point_fraction": Fate.FIXED_POINT,
    "diverged_fraction": Fate.DIVERGED,
}
"""Parts of the discarded share, by what became of the runs."""

RUNS = tuple(field.name for field in fields(SeriesReductions))
"""Variables of the reductions of each long run."""

OF_PROFILES = ("nrmse_u", "nrmse_uu", "nrmse_uv")
"""Measures that only a flow has."""


@declaring
def make(
    *,
    data: Mapping[str, Any] = read("case/statistics_data.nc"),
    training: Mapping[str, Any] = read("case/statistics_training.nc"),
    floor: Mapping[str, Any] = read("case/statistics_floor.nc"),
    long_term: Sequence[Gathered] = gathered("long_term_forecasters/long_term.nc"),
    case: str = at("case"),
    root_seed: int = at("random_seed"),
    system: str = at("case.system"),
    parameters: Mapping[str, Any] = at("case.parameters"),
    profile_points: int = at("statistics.profile_points"),
    resamples: int = at("bootstrap.resamples"),
    confidence: float = at("bootstrap.confidence"),
) -> dict[str, Rows]:
    """One row for each forecaster, for the training set and for each sampling floor.

    With the intervals of the forecasters' statistics over their long runs.
    """
    reference = LongTermStatistics.from_arrays(data)
    matrices = equally_spaced_profiles(make_space(system, parameters), profile_points)
    measures = vars(compare(reference, LongTermStatistics.from_arrays(training), matrices))
    rows: Rows = [{**ForecasterName("training").keys, **measures}]
    # one row for each split of the data
    for split in range(floor["split"].size):
        of_split = {measure: float(floor[measure][split]) for measure in measures}
        rows.append({**ForecasterName("floor", seed=split).keys, **of_split})
    ends: Rows = []
    for file in long_term:
        measures = vars(compare(reference, LongTermStatistics.from_arrays(file.content), matrices))
        fates = file.content["fate"]
        lost = {"discarded_fraction": fates != Fate.KEPT}
        lost |= {name: fates == fate for name, fate in SHARES.items()}
        discarded = {name: float(runs.mean()) for name, runs in lost.items()}
        rows.append({**file.name.keys, **discarded, **measures})
        generator = random_streams.stream(root_seed, "bootstrap", case, "long runs")
        weights = bootstrap_weights(len(fates), resamples, generator)
        reduced = SeriesReductions(**{name: file.content[name] for name in RUNS})
        samples = {
            **{name: weights @ runs / len(fates) for name, runs in lost.items()},
            **resampled_measures(reference, reduced, fates == Fate.KEPT, matrices, weights),
        }
        ends += [
            {**file.name.keys, "metric": metric, **between(values, confidence)}
            for metric, values in samples.items()
            if not (metric in OF_PROFILES and matrices is None)
        ]
    return {"statistics": rows, "statistics_intervals": ends}
