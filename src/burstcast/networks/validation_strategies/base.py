"""The interface of a validation strategy: training steps and validation intervals.

Sources: section "Validation" and the appendix "Training and validation sets" of the paper; Racca &
Magri, "Robust optimization and validation of echo state networks for learning chaotic dynamics",
Neural Networks 142 (2021).
"""

import abc
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import ClassVar


@dataclass(frozen=True)
class ValidationPlan:
    """Parameters of a validation, common to all strategies; a strategy uses some of them.

    Attributes
    ----------
    washout
        Inputs before the first state that counts, in steps.
    interval
        Length of a validation interval, in steps.
    series
        Number of training series with validation intervals, from the first.
    intervals
        Intervals in each of them, laid end to end from the end of the washout; None for as many as
        fit.
    single_shot_lead
        Steps before the end of the training data at which the interval of the Single Shot
        Validation starts.
    """

    washout: int
    interval: int
    series: int
    intervals: int | None
    single_shot_lead: int = 0

    def fitting(self, length: int) -> int:
        """Number of intervals that fit into a series of ``length`` samples after the washout."""
        return max(0, (length - self.washout) // self.interval)

    def fitted_to(self, lengths: Sequence[int]) -> "ValidationPlan":
        """Plan with as many intervals as fit the shortest validated series, unless they are given.

        ``lengths``: Samples of each training series, the longest first. A ValueError says how many
        series are long enough if these are too few.
        """
        wanted = self.intervals or 1
        fitting = [self.fitting(length) for length in lengths]
        if self.series > (enough := sum(count >= wanted for count in fitting)):
            raise ValueError(
                f"{self.series} series are to have validation intervals, but only {enough} of "
                f"{len(lengths)} training series have a washout of {self.washout} steps and "
                f"{wanted} {'interval' if wanted == 1 else 'intervals'} of {self.interval}"
            )
        return replace(self, intervals=self.intervals or min(fitting[: self.series]))

    def starts(self, length: int) -> tuple[int, ...]:
        """First steps of the intervals, laid end to end in a series of ``length`` samples."""
        count = self.fitting(length) if self.intervals is None else self.intervals
        return tuple(self.washout + index * self.interval for index in range(count))

    def check_intervals(self, series: int, length: int) -> None:
        """Check that the intervals fit ``series`` series of ``length`` samples."""
        if self.series > series:
            raise ValueError(
                f"{self.series} series are to have validation intervals, but there are only "
                f"{series} training series"
            )
        fit, wanted = self.fitting(length), 1 if self.intervals is None else self.intervals
        if wanted > fit:
            raise ValueError(
                f"{wanted} validation intervals per series are requested, but only {fit} "
                f"intervals of {self.interval} steps fit into a series of {length} samples"
            )


@dataclass(frozen=True)
class Block:
    """Data that a readout is trained on: some series, from the washout on.

    Attributes
    ----------
    series
        Rows of neighbouring series.
    stop
        First step that is no longer a target.
    """

    series: range
    stop: int


@dataclass(frozen=True)
class Fold:
    """A readout to be trained, and the closed loops that validate it.

    Attributes
    ----------
    trained
        Training data, with no series in two blocks. The moments of the blocks are added up.
    series
        Rows of neighbouring series that validate the readout.
    starts
        First steps of the intervals, in each of these series. The closed loop starts from the
        state that has seen all the data of its series before that step.
    """

    trained: tuple[Block, ...]
    series: range
    starts: tuple[int, ...]


class ValidationStrategy(abc.ABC):
    """Validation of hyperparameters from the training series alone.

    A subclass is found by its `name`, in any module of this package.
    """

    name: ClassVar[str]
    """Short name, unique: "RV"."""
    title: ClassVar[str]
    """Name in full: "Recycle Validation"."""

    @abc.abstractmethod
    def folds(self, plan: ValidationPlan, series: int, length: int) -> list[Fold]:
        """Folds of a validation of ``series`` training series of ``length`` samples, one at least.

        The objective is the mean over the intervals of all folds.
        """


def use_of_series(folds: Sequence[Fold], row: int) -> tuple[int, list[int]]:
    """Step up to which folds train on a series, and the first steps of its validation intervals."""
    stops = [block.stop for fold in folds for block in fold.trained if row in block.series]
    starts = {start for fold in folds if row in fold.series for start in fold.starts}
    return max(stops, default=0), sorted(starts)
