"""Settings of a strategy chosen on some flows, to be scored on others.

A strategy with several settings looks better than it is where its best run is picked on the flows
that it is scored on. Here every second series chooses and the others score. The series, not the
flow, decides: runs that leave out different flows are split alike.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from burstcast.arrays import BoolArray, FloatArray
from burstcast.control.records import RECORDS, FlowRecords, Span, weighted_scores


@dataclass(frozen=True)
class FlowSample:
    """Flows under one strategy with one choice of its settings."""

    records: FlowRecords
    span: Span
    #: costs of the actuation in each flow, ``(flows,)``, by name; empty: they were not recorded
    costs: Mapping[str, FloatArray]

    def part(self, chosen: BoolArray) -> "FlowSample":
        """Outcomes of the ``chosen`` flows, ``(flows,)``."""
        records = {name: getattr(self.records, name)[chosen] for name in RECORDS}
        costs = {name: values[chosen] for name, values in self.costs.items()}
        return replace(self, records=FlowRecords(**records), costs=costs)

    def halves(self) -> tuple["FlowSample", "FlowSample"]:
        """Flows that choose, of series with even numbers, and flows that score."""
        even = self.records.row % 2 == 0
        return self.part(even), self.part(~even)

    def values(self) -> dict[str, float]:
        """Scores of the flows by name (see `burstcast.control.records.weighted_scores`)."""
        weights = np.ones((1, len(self.records.row)))
        found = weighted_scores(self.records, self.span, weights, self.costs)
        return {name: float(value[0]) for name, value in found.items()}


def choose(candidates: Sequence[FlowSample], tolerance: float) -> int:
    """Number of the cheapest settings that leave little, or else of settings that leave the least.

    ``candidates``: The same flows under different settings. ``tolerance``: Share of the
    uncontrolled exceedance that may be left. The cost is the effort, or the time under actuation
    where efforts were not recorded. The first one of equals is chosen.
    """
    if not candidates:
        raise ValueError("there is nothing to choose from")
    found = [
        # scores of no flows are not defined: such settings are the last choice
        {name: value if np.isfinite(value) else np.inf for name, value in one.values().items()}
        for one in candidates
    ]
    cost = "effort" if all("effort" in one for one in found) else "control_fraction"

    def rank(scores: Mapping[str, float]) -> tuple[bool, float, float]:
        left = scores["relative_exceedance"]
        within = left <= tolerance
        return (not within, *((scores[cost], left) if within else (left, scores[cost])))

    return min(range(len(found)), key=lambda number: rank(found[number]))
