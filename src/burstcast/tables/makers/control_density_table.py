"""Average the densities with and without control over the networks of an ensemble."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np

from burstcast.base import random_streams
from burstcast.base.declared import at, declaring, gathered
from burstcast.base.names import ForecasterName
from burstcast.statistics.densities import Histogram, density_interval, mean_density
from burstcast.tables.makers.registry import Gathered, Rows

SAMPLES = ("uncontrolled", "controlled", "free")
WITH_INTERVAL = SAMPLES[:2]


@declaring
def make(
    *,
    flows: Sequence[Gathered] = gathered(
        "control_runs/flows.nc",
        "edge histogram_uncontrolled histogram_controlled histogram_free row "
        "laminar_step_uncontrolled laminar_step_controlled escape_step",
    ),
    case: str = at("case"),
    root_seed: int = at("random_seed"),
    resamples: int = at("bootstrap.resamples"),
    confidence: float = at("bootstrap.confidence"),
) -> dict[str, Rows]:
    """Densities of each group of networks that differ by their seed only."""
    groups: dict[tuple[ForecasterName, float], list[Mapping[str, Any]]] = {}
    for run in flows:
        group = replace(run.name, seed=None), run.plan["settings"]["prediction_time_lt"]
        groups.setdefault(group, []).append(_counted(run.content))
    rows: Rows = []
    for (name, time), counts in groups.items():
        edges = counts[0]["edge"]
        densities = {
            sample: mean_density([Histogram(edges, data[sample].sum(axis=0)) for data in counts])
            for sample in SAMPLES
        }
        ends = {
            sample: density_interval(
                edges,
                [data[sample] for data in counts],
                [data["row"] for data in counts],
                resamples=resamples,
                confidence=confidence,
                # flows with and without control are resampled alike
                generator=random_streams.stream(root_seed, "control density", case),
            )
            for sample in WITH_INTERVAL
        }
        rows += [
            {
                **{key: value for key, value in name.keys.items() if key != "seed"},
                "prediction_time_lt": time,
                "low": low,
                "high": high,
                **{f"density_{sample}": density[index] for sample, density in densities.items()},
                **{
                    f"density_{sample}_{end}": values[index]
                    for sample, both in ends.items()
                    for end, values in zip(("low", "high"), both, strict=True)
                },
            }
            for index, (low, high) in enumerate(pairwise(edges))
        ]
    return {"control_density": rows}


def _counted(content: Mapping[str, Any]) -> dict[str, Any]:
    """Rows and histograms of the flows that neither laminarise nor escape."""
    steps = "laminar_step_uncontrolled", "laminar_step_controlled", "escape_step"
    kept = np.all([content[name] < 0 for name in steps], axis=0)
    histograms = {sample: content[f"histogram_{sample}"][kept] for sample in SAMPLES}
    return {"edge": content["edge"], "row": content["row"][kept], **histograms}
