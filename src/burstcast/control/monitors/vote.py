"""Monitor by vote: an alarm where enough members raise one."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from burstcast.arrays import BoolArray, ByteArray, FloatArray, IntArray
from burstcast.control.monitors.base import Monitor


def check_share(share: float) -> None:
    """Raise ValueError if a share of a vote is not in (0, 1]."""
    if not 0 < share <= 1:
        raise ValueError(f"the share of a vote must lie in (0, 1], not {share}")


def enough(votes: IntArray, members: int, share: float) -> BoolArray:
    """Whether numbers of votes, ``(batch,)``, reach a share of the members."""
    # a share such as 0.7 of ten misses seven by rounding error only
    return np.asarray(votes >= share * members - 1e-9)


@dataclass(frozen=True)
class VoteMonitor(Monitor):
    """Raises an alarm if a share of its members does: the alarm probability of a committee.

    Attributes
    ----------
    members
        One at least.
    share
        Share of the members, in (0, 1]: 0.5 of ten are five or more.
    """

    members: Sequence[Monitor]
    share: float

    def __post_init__(self) -> None:
        """Check members and share.

        Raises
        ------
        ValueError
            If there is no member, or the share is not in (0, 1].
        """
        if not self.members:
            raise ValueError("a vote needs one member at least")
        check_share(self.share)

    def alarms(
        self,
        rows: IntArray,
        forecast_number: IntArray,
        washout: FloatArray,
        acting: ByteArray | None = None,
    ) -> BoolArray:
        """Count the members' alarms (see `Monitor.alarms`)."""
        votes = np.zeros(len(rows), dtype=np.int64)
        for member in self.members:
            votes += member.alarms(rows, forecast_number, washout, acting)
        return enough(votes, len(self.members), self.share)
