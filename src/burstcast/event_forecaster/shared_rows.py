"""Series that share rows: windows that overlap, or one series that is given several times.

What calibrates a forecaster must not have been in its training. Where series that share no rows
hold all rows, the others are superfluous. Otherwise a series is left out together with all series
that share rows with it, and of such series only one is forecast.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from burstcast.base.arrays import BoolArray, FloatArray, IntArray
from burstcast.base.left_out import LeftOut

_ROWS = 16
"""Consecutive rows that are compared: single rows of rounded values are equal by chance."""
_CHANGES = 4
"""Rows among them, at least, that differ from the row before."""
_SHARE = 0.05
"""Least share of the shorter series in the longer one that counts as shared rows."""
_COVERED = 0.95
"""Share of all rows that disjoint series must hold, so that others add nothing."""
MOST_REFITS = 25
"""Forecasters that are fitted to calibrate; more series are left out several at a time."""


@dataclass(frozen=True)
class SharedRows:
    """Which series share rows with which."""

    linked: BoolArray  #: ``(series, series)``; a series with itself
    disjoint: IntArray  #: rows of series that share no rows with each other, as many as were found
    covered: float = 1.0  #: share of all different rows that disjoint series hold
    share: float = 0.0  #: share of all rows that lie in another series, too

    @property
    def count(self) -> int:
        """Number of series that share rows with others."""
        return int((self.linked.sum(axis=1) > 1).sum())

    @property
    def needed(self) -> IntArray:
        """Series that hold all rows: disjoint ones where these do, or else all series."""
        return self.disjoint if self.covered >= _COVERED else np.arange(len(self.linked))

    def finding(self, reduced: bool) -> list[str]:
        """A sentence about the rows that are shared; none where there are none.

        ``reduced``: Whether the series that are needed are used alone.
        """
        if not self.count:
            return []
        used = "they are left out together, and one of them is forecast, to calibrate"
        if reduced and (needed := len(self.needed)) < len(self.linked):
            used = f"{needed} series without others, which hold the same rows, are used"
        return [
            f"{self.count} of {len(self.linked)} series share rows with other series "
            f"({self.share:.0%} of all rows), as windows that overlap do: {used}; give records "
            f"whole, or cut into disjoint series"
        ]

    def left_out(self) -> list[LeftOut] | None:
        """Series to forecast, with the series to leave out for it; None: each series by itself."""
        number = len(self.linked)
        if not self.count and number <= MOST_REFITS:
            return None
        folds = []
        for first in range(min(MOST_REFITS, len(self.disjoint))):
            forecast = self.disjoint[first::MOST_REFITS]
            rows = np.flatnonzero(self.linked[forecast].any(axis=0))
            if len(rows) < number:
                folds.append(LeftOut(forecast, rows))
        if not folds:
            raise ValueError(
                f"all {number} series share rows, so that none can be left out to calibrate: give "
                f"the record as one series (series[np.newaxis]), which is cut into parts, or "
                f"calibrate=False"
            )
        return folds


def shared_rows(series: Sequence[FloatArray]) -> SharedRows:
    """Find rows that series ``(time, component)`` have in common, by runs of several rows."""
    number = len(series)
    lengths = np.array([len(states) for states in series])
    linked = np.eye(number, dtype=bool)
    none = SharedRows(linked, np.arange(number))
    if number < 2:
        return none
    owner, runs = _runs_of_rows(series, min(_ROWS, int(lengths.min())))
    if not len(runs):
        return none
    order = np.lexsort((owner, runs))
    owner, runs = owner[order], runs[order]
    own_before = np.r_[False, (runs[1:] == runs[:-1]) & (owner[1:] == owner[:-1])]
    repeated = np.unique(runs[own_before])  # within a series: rounded or periodic values
    lasting = ~np.isin(runs, repeated) if repeated.size else np.ones(len(runs), dtype=bool)
    owner, runs = owner[lasting], runs[lasting]
    total = np.bincount(owner, minlength=number)
    again = np.r_[False, runs[1:] == runs[:-1]]
    shared = again | np.r_[again[1:], False]
    if not shared.any():
        return none
    from scipy import sparse

    _, column = np.unique(runs[shared], return_inverse=True)
    entries = np.ones(len(column), np.int64), (owner[shared], column)
    has = sparse.csr_array(entries, shape=(number, int(column.max()) + 1))
    common = (has @ has.T).toarray()
    shorter = np.minimum(total[:, np.newaxis], total)
    linked |= common > _SHARE * np.maximum(1, shorter)
    disjoint: list[int] = []
    for row in np.argsort(-lengths, kind="stable").tolist():
        if not linked[row, disjoint].any():
            disjoint.append(row)
    chosen = np.array(sorted(disjoint), dtype=np.int64)
    hashes = [_hashes(states) for states in series]
    covered = len(np.unique(np.concatenate([hashes[row] for row in chosen])))
    return SharedRows(
        linked,
        chosen,
        covered / len(np.unique(np.concatenate(hashes))),
        float(shared.sum() / max(1, len(runs))),
    )


def _hashes(states: FloatArray) -> npt.NDArray[np.uint64]:
    """A number for each row ``(time, component)``, which equal rows have in common."""
    factors = np.random.default_rng(0).integers(0, 2**63, states.shape[1], np.uint64) * 2 + 1
    bits = np.ascontiguousarray(states + 0.0).view(np.uint64)
    mixed = ((bits ^ (bits >> np.uint64(29))) * factors).sum(axis=1, dtype=np.uint64)
    return np.asarray(mixed ^ (mixed >> np.uint64(32)))


def _runs_of_rows(series: Sequence[FloatArray], rows: int) -> tuple[IntArray, IntArray]:
    """Series of each run of some consecutive rows, and a number that equal runs have in common."""
    factors = np.random.default_rng(1).integers(0, 2**63, rows, np.uint64) * 2 + 1
    owners, found = [], []
    for number, states in enumerate(series):
        hashes = _hashes(states)
        windows = np.lib.stride_tricks.sliding_window_view(hashes, rows)
        values = (windows * factors).sum(axis=1, dtype=np.uint64)
        changes = np.r_[0, np.cumsum(hashes[1:] != hashes[:-1])]
        varied = changes[rows - 1 :] - changes[: len(values)] >= min(_CHANGES, rows - 1)
        found.append(values[varied].view(np.int64))
        owners.append(np.full(int(varied.sum()), number))
    return np.concatenate(owners), np.concatenate(found)
