"""Other choices of the training series from one ensemble; the scatter over them and over seeds.

All networks of an ensemble are trained on the same few series: their scatter over seeds does not
contain the effect of the choice of series. With several choices of the training series, and several
seeds for each, a one-way analysis of variance with random effects separates the two (Searle,
Casella & McCulloch, Variance Components, Wiley 1992, chapter 3).
"""

import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from burstcast.base.arrays import FloatArray, IntArray

DRAWS = 1000
"""Random sets of series of which the one with the nearest share of events is taken."""

_REALISATION = re.compile(r"(.+)-training([1-9]\d*)")


def realisation_of(name: str) -> tuple[str, int]:
    """Source of a case with other training series, and the number of the choice.

    ``Re400-training2`` is the second other choice of ``Re400``; choice 0 is a case's own.
    """
    match = _REALISATION.fullmatch(name)
    return (match[1], int(match[2])) if match else (name, 0)


def rows_of_realisation(kept: int, training: int, realisation: int) -> IntArray:
    """Order of an ensemble's series with another choice of training series first, ``(kept,)``.

    The first series change places with a block of equally many from the end; the series in between,
    the test series among them, keep their places.

    ``realisation``: Number of the choice: 0 is the ensemble's own order, 1 takes the last block, 2
    the block before it.
    """
    first = kept - realisation * training
    if first < training:
        raise ValueError(
            f"{kept} series are too few for {realisation + 1} choices of {training} of them"
        )
    return trained_first(kept, np.arange(training) + (first if realisation else 0))


def trained_first(kept: int, chosen: IntArray) -> IntArray:
    """Order of an ensemble's series in which the chosen ones come first, ``(kept,)``.

    The displaced series take the places that become free; all other series keep theirs.
    """
    rows = np.arange(kept)
    first = rows[: len(chosen)].copy()
    rows[np.setdiff1d(chosen, first)] = np.setdiff1d(first, chosen)
    rows[: len(chosen)] = chosen
    return rows


def draw_training_series(
    event_shares: FloatArray,
    candidates: IntArray,
    training: int,
    wanted: Sequence[float],
    generators: Sequence[np.random.Generator],
) -> list[IntArray]:
    """Draw choices of the training series by their share of time with an extreme event.

    Each choice is, of `DRAWS` random sets of series that no earlier choice has, the set whose share
    is nearest to the wanted one. Neither forecasts nor their scores enter.

    ``event_shares``: Share of its time that the observable of each series is at or above the event
    threshold, ``(kept,)``; the share of a set is their mean.
    ``candidates``: Rows of the series that may be drawn: all but the test series. Returns rows of
    each choice, in random order, ``(training,)``.
    """
    if len(candidates) < training * len(wanted):
        raise ValueError(
            f"{len(candidates)} series are too few for {len(wanted)} choices of {training} of them"
        )
    chosen: list[IntArray] = []
    for share, generator in zip(wanted, generators, strict=True):
        left = np.setdiff1d(candidates, np.concatenate([candidates[:0], *chosen]))
        order = generator.random((DRAWS, len(left))).argsort(axis=1)
        sets = left[order[:, :training]]
        distance = np.abs(event_shares[sets].mean(axis=1) - share)
        chosen.append(sets[int(np.argmin(distance))])
    return chosen


def rows_of_drawn_series(
    event_shares: FloatArray,
    training: int,
    held: int,
    wanted: Sequence[float | str],
    generators: Sequence[np.random.Generator],
) -> IntArray:
    """Order of an ensemble's series in which the last of several drawn choices comes first.

    ``held``: Number of series after the training series that are not drawn, and keep their places:
    the test and calibration series. ``wanted``: Wanted share of each choice; "all": the share of
    all series. Returns rows of the ensemble in the new order, ``(kept,)``.
    """
    kept = len(event_shares)
    candidates = np.delete(np.arange(kept), np.s_[training : training + held])
    shares = [float(event_shares.mean() if share == "all" else share) for share in wanted]
    chosen = draw_training_series(event_shares, candidates, training, shares, generators)
    return trained_first(kept, chosen[-1])


@dataclass(frozen=True)
class VarianceComponents:
    """Components of the variance of a metric."""

    mean: float
    #: standard deviation of the groups' own effects, beyond the scatter of their members; 0 where
    #: groups differ by no more than chance, NaN for a single group
    between: float
    within: float  #: standard deviation of the members of a group; NaN where no group has two
    groups: int  #: number of groups with values
    values: int  #: number of values in all groups


def variance_components(groups: Sequence[FloatArray]) -> VarianceComponents:
    """Separate the variance between groups from that within them, by the method of moments.

    ``groups``: Values of each group (a choice of the training series), ``(members,)``; groups
    without values do not count. Where no group has two members, the scatter within is unknown, and
    all variance counts as variance between groups.
    """
    present = [np.asarray(group, dtype=np.float64) for group in groups if len(group)]
    sizes = np.array([len(group) for group in present], dtype=np.float64)
    if not present:
        return VarianceComponents(float("nan"), float("nan"), float("nan"), 0, 0)
    values = np.concatenate(present)
    count, number = len(present), len(values)
    mean, means = float(values.mean()), np.array([group.mean() for group in present])
    spare = number - count
    squares = sum(float(np.square(group - group.mean()).sum()) for group in present)
    within = squares / spare if spare else float("nan")
    between = float("nan")
    if count > 1:
        mean_square = float((sizes * np.square(means - mean)).sum()) / (count - 1)
        # the members of a group, where groups are of one size
        typical = (number - float(np.square(sizes).sum()) / number) / (count - 1)
        between = max(0.0, (mean_square - (within if spare else 0.0)) / typical)
    return VarianceComponents(mean, float(np.sqrt(between)), float(np.sqrt(within)), count, number)
