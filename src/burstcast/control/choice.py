"""Settings of a strategy chosen on some flows, to be scored on others.

A strategy with several settings looks better than it is where its best run is picked on the flows
that it is scored on. Here every second series chooses and the others score. The series, not the
flow, decides: runs that leave out different flows are split alike.
"""

from collections.abc import Mapping, Sequence

import numpy as np

from burstcast.control.records import FlowSample, weighted_scores


def choose(candidates: Sequence[FlowSample], tolerance: float) -> int:
    """Number of the cheapest settings that leave little, or else of settings that leave the least.

    ``candidates``: The same flows under different settings. ``tolerance``: Share of the
    uncontrolled exceedance that may be left. The cost is the effort, or the time under actuation
    where efforts were not recorded. The first one of equals is chosen.
    """
    if not candidates:
        raise ValueError("there is nothing to choose from")
    finite = []
    for candidate in candidates:
        weighted = weighted_scores(candidate, np.ones((1, len(candidate))))
        scores = {name: float(value[0]) for name, value in weighted.items()}
        # scores of no flows are not defined: such settings are the last choice
        undefined = {name: np.inf for name, value in scores.items() if not np.isfinite(value)}
        finite.append({**scores, **undefined})
    cost = "effort" if all("effort" in scores for scores in finite) else "control_fraction"

    def rank(scores: Mapping[str, float]) -> tuple[bool, float, float]:
        left = scores["relative_exceedance"]
        if left <= tolerance:
            return False, scores[cost], left
        return True, left, scores[cost]

    return min(range(len(finite)), key=lambda number: rank(finite[number]))
