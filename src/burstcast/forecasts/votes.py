"""The probability of an event as the share of a committee that forecasts it."""

from collections.abc import Sequence

import numpy as np

from burstcast.base.arrays import FloatArray
from burstcast.forecasts.windows import WindowSummaries, crosses


def share_of_votes(
    members: Sequence[WindowSummaries], first_window: int, windows: int, threshold: float
) -> FloatArray:
    """Share of the members that forecast a crossing of the threshold in a prediction window.

    ``members``: Forecasts of the same starting points: by the networks of an ensemble, say. A
    single one votes with 0 or 1. ``first_window``, ``windows``, ``threshold``: As in
    `burstcast.forecasts.windows.crosses`. A member whose forecast does not stay finite votes
    against. Shape ``(points,)``, in [0, 1].
    """
    if not members:
        raise ValueError("a committee needs members")
    votes = sum(
        crosses(member, first_window, windows, threshold).astype(np.int64) for member in members
    )
    return np.asarray(votes / len(members))
