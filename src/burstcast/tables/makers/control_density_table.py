"""Average the densities with and without control over the networks of an ensemble."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import pairwise
from typing import Any

from burstcast.forecasters._names import ForecasterName
from burstcast.statistics.densities import Histogram, density_quartiles, mean_density
from burstcast.tables.makers.registry import Declaration, Gathered, Rows

TABLES = Declaration(gathered={"histograms": "edge uncontrolled controlled free"})

SAMPLES = ("uncontrolled", "controlled", "free")


def make(*, histograms: Sequence[Gathered]) -> dict[str, Rows]:
    """Densities of each group of networks that differ by their seed only."""
    groups: dict[tuple[ForecasterName, float], list[Mapping[str, Any]]] = {}
    for one in histograms:
        group = replace(one.name, seed=None), one.plan["settings"]["prediction_time_lt"]
        groups.setdefault(group, []).append(one.content)
    rows: Rows = []
    for (name, time), found in groups.items():
        edges = found[0]["edge"]
        histograms_of = {
            sample: [Histogram(data["edge"], data[sample]) for data in found] for sample in SAMPLES
        }
        densities = {sample: mean_density(these) for sample, these in histograms_of.items()}
        ends = density_quartiles(histograms_of["controlled"])
        rows += [
            {
                **{key: value for key, value in name.keys.items() if key != "seed"},
                "prediction_time_lt": time,
                "low": low,
                "high": high,
                **{f"density_{sample}": density[index] for sample, density in densities.items()},
                "density_controlled_p25": ends[0][index],
                "density_controlled_p75": ends[1][index],
            }
            for index, (low, high) in enumerate(pairwise(edges))
        ]
    return {"control_density": rows}
