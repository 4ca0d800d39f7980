"""Long-term statistics of all the data and of the training set, and the sampling floor."""

from dataclasses import fields
from typing import Any

import numpy as np

from burstcast import random_streams
from burstcast.statistics.densities import bin_edges
from burstcast.statistics.measures import Measures, sampling_floor
from burstcast.statistics.profiles import equally_spaced_profiles
from burstcast.statistics.reductions import reduce_series
from burstcast.systems.registry import make_system
from burstcast_workflow.job import Provenance, run_job
from burstcast_workflow.statistics_files import write_statistics
from burstcast_workflow.storage import Variable, read_json, read_rows, write_netcdf

SERIES_AT_A_TIME = 100


def main(inputs: Any, outputs: Any, settings: dict[str, Any], provenance: Provenance) -> None:
    """Write the statistics of the data and of the training set, and the floor of the measures."""
    system = make_system(settings["system"], settings["parameters"])
    kept = read_json(inputs.summary)["series_kept"]
    blocks = (
        read_rows(inputs.ensemble, "state", start, min(start + SERIES_AT_A_TIME, kept))
        for start in range(0, kept, SERIES_AT_A_TIME)
    )
    series = reduce_series(
        blocks,
        system.observable,
        bin_edges(*settings["density"]["range"], settings["density"]["bins"]),
    )
    training = slice(0, settings["training_series"])
    write_statistics(outputs.data, series.merged(slice(None)), provenance)
    write_statistics(outputs.training, series.merged(training), provenance)
    floor = sampling_floor(
        series,
        equally_spaced_profiles(system, settings["profile_points"]),
        settings["floor_splits"],
        random_streams.stream(settings["random_seed"], "sampling floor", settings["case"]),
    )
    names = [field.name for field in fields(Measures)]
    write_netcdf(
        outputs.floor,
        {
            "split": Variable(("split",), np.arange(len(floor)), "1", "random split of the data"),
            **{
                name: Variable(
                    ("split",),
                    np.array([getattr(measures, name) for measures in floor]),
                    "1",
                    f"{name} between the parts of the split",
                )
                for name in names
            },
        },
        provenance,
    )


if __name__ == "__main__":
    run_job(snakemake, main)  # noqa: F821 - Snakemake puts it there
