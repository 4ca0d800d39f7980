"""Average the densities with and without control over the networks of an ensemble."""

from itertools import pairwise
from typing import Any

from burstcast.files.netcdf import read_netcdf
from burstcast.statistics.densities import Histogram, density_quartiles, mean_density
from burstcast_workflow.harness.job import job
from burstcast_workflow.harness.settings import Settings
from burstcast_workflow.jobs.gather import gathered
from burstcast_workflow.jobs.tables import write_tables

SAMPLES = ("uncontrolled", "controlled", "free")
GROUP = ("case", "reynolds", "forecaster", "neurons", "validation", "prediction_time_lt")


@job
def control_density_table(*, histograms: list[str], tables: list[str], settings: Settings) -> None:
    """Write the densities of each group of networks that differ by their seed only."""
    groups: dict[tuple[Any, ...], list[dict[str, Any]]] = {}
    for keys, origin in gathered(settings, histograms):
        of_run = {**keys, **origin.settings["control.run"]["settings"]}
        group = tuple(of_run[name] for name in GROUP)
        groups.setdefault(group, []).append(read_netcdf(origin.path))
    rows = []
    for group, found in groups.items():
        edges = found[0]["edge"]
        histograms_of = {
            name: [Histogram(data["edge"], data[name]) for data in found] for name in SAMPLES
        }
        densities = {name: mean_density(these) for name, these in histograms_of.items()}
        ends = density_quartiles(histograms_of["controlled"])
        rows += [
            {
                **dict(zip(GROUP, group, strict=True)),
                "low": low,
                "high": high,
                **{f"density_{name}": density[index] for name, density in densities.items()},
                "density_controlled_p25": ends[0][index],
                "density_controlled_p75": ends[1][index],
            }
            for index, (low, high) in enumerate(pairwise(edges))
        ]
    write_tables(tables, settings, control_density=rows)
