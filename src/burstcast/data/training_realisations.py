"""Other choices of the training series from one ensemble, and their scatter beside that of seeds.

All networks of an ensemble are trained on the same few series: their scatter over seeds leaves out
what other series would have taught. With several choices of the training series, and several seeds
for each, a one-way analysis of variance with random effects separates the two (Searle, Casella &
McCulloch, Variance Components, Wiley 1992, chapter 3).
"""

import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from burstcast.arrays import FloatArray, IntArray

_REALISATION = re.compile(r"(.+)-training([1-9]\d*)")


def realisation_of(name: str) -> tuple[str, int]:
    """Case that a case differs from by its training series only, and which choice of them it has.

    ``Re400-training2`` is the second other choice of ``Re400``; choice 0 is a case's own.
    """
    match = _REALISATION.fullmatch(name)
    return (match[1], int(match[2])) if match else (name, 0)


def rows_of_realisation(kept: int, training: int, realisation: int) -> IntArray:
    """Order of an ensemble's series in which others come first, to be trained on.

    The first ones change places with a block of as many from the end, so that all that lies
    between, the test series among it, stays where it is.

    Parameters
    ----------
    kept
        Number of series.
    training
        How many are trained on.
    realisation
        Which choice: 0 is the ensemble's own order, 1 takes the last block, 2 the one before.

    Returns
    -------
    Rows of the ensemble in the new order, ``(kept,)``.

    Raises
    ------
    ValueError
        If the ensemble is too small for so many choices that share no series.
    """
    rows = np.arange(kept)
    first = kept - realisation * training
    if first < training:
        raise ValueError(
            f"{kept} series are too few for {realisation + 1} choices of {training} of them"
        )
    if realisation:
        block = slice(first, first + training)
        rows[:training], rows[block] = rows[block].copy(), rows[:training].copy()
    return rows


@dataclass(frozen=True)
class VarianceComponents:
    """Components of the variance of a metric.

    Attributes
    ----------
    mean
        Over all values.
    between
        Standard deviation of what the groups themselves have, beyond what their members explain; 0
        where the groups differ by no more than chance. NaN for a single group.
    within
        Standard deviation of the members of a group; NaN where no group has two.
    groups, values
        How many there are.
    """

    mean: float
    between: float
    within: float
    groups: int
    values: int


def variance_components(groups: Sequence[FloatArray]) -> VarianceComponents:
    """Separate the variance between groups from that within them, by the method of moments.

    Parameters
    ----------
    groups
        Values of each group (a choice of the training series), ``(members,)``; groups without
        values do not count. Where no group has two members, nothing is known of the scatter within,
        and the variance of the groups is all there is.
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
