"""The probability of an event as the share of a committee that forecasts it."""

from collections.abc import Sequence

import numpy as np

from burstcast.base.arrays import FloatArray
from burstcast.forecasts.windows import WindowSummaries, crosses


def share_of_votes(
    members: Sequence[WindowSummaries], first_window: int, windows: int, threshold: float
) -> FloatArray:
    """Share of the members that forecast a crossing (see `crosses`), ``(points,)``, in [0, 1].

    A member whose forecast does not stay finite votes against.
    """
    if not members:
        raise ValueError("a committee needs members")
    votes = sum(
        crosses(member, first_window, windows, threshold).astype(np.int64) for member in members
    )
    return np.asarray(votes / len(members))
