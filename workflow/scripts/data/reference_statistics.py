"""Long-term statistics of all the data and of the training set, and the sampling floor."""

from burstcast.base import random_streams
from burstcast.base.files.netcdf import read_rows
from burstcast.statistics.measures import floor_variables, sampling_floor
from burstcast.statistics.profiles import equally_spaced_profiles
from burstcast.statistics.reductions import reduce_series
from burstcast.statistics.statistics_files import statistics_variables
from burstcast_workflow.harness.job import JobSettings, at, job, read_json, write_netcdf
from burstcast_workflow.jobs.cases import Density, System
from burstcast_workflow.jobs.series import Training

MOST_SERIES, MOST_NUMBERS = 100, 2**25
"""Series that are read at a time, and numbers in them: bounds the memory, changes no result."""


class ReferenceStatistics(JobSettings):
    """Statistics of the data, and how much they scatter."""

    system: System
    training: Training
    density: Density
    random_seed: int = at("random_seed")
    profile_points: int = at("statistics.profile_points")
    floor_splits: int = at("statistics.floor_splits")


@job
def reference_statistics(
    *,
    ensemble: str,
    summary: str,
    data: str,
    training: str,
    floor: str,
    settings: ReferenceStatistics,
) -> None:
    """Write the statistics of the data and of the training set, and the floor of the measures."""
    system = settings.system.space
    kept = read_json(summary)["series_kept"]
    series_at_a_time = min(MOST_SERIES, MOST_NUMBERS // read_rows(ensemble, "state", 0, 1).size + 1)
    blocks = (
        read_rows(ensemble, "state", start, min(start + series_at_a_time, kept))
        for start in range(0, kept, series_at_a_time)
    )
    series = reduce_series(blocks, system.observable, settings.density.edges(ensemble))
    first = slice(0, settings.training.series)
    write_netcdf(data, statistics_variables(series.merged(slice(None))), settings.provenance)
    write_netcdf(training, statistics_variables(series.merged(first)), settings.provenance)
    splits = sampling_floor(
        series,
        equally_spaced_profiles(system, settings.profile_points),
        settings.floor_splits,
        random_streams.stream(settings.random_seed, "sampling floor", settings.case),
    )
    write_netcdf(floor, floor_variables(splits), settings.provenance)
