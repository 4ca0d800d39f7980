"""Where the validation strategies train and validate in the training series.

Source: section "Validation" and the appendix "Training and validation sets" of the paper.
"""

from dataclasses import dataclass


@dataclass(frozen=True)
class ValidationPlan:
    """Which intervals of the training series validate a network.

    Attributes
    ----------
    washout
        Inputs before the first state that counts, in steps.
    interval
        Length of a validation interval, in steps.
    recycle_series
        Recycle Validation: number of series with validation intervals, from the first.
    recycle_intervals
        Recycle Validation: intervals in each, laid end to end from the end of the washout.
    """

    washout: int
    interval: int
    recycle_series: int
    recycle_intervals: int

    def single_shot_start(self, length: int) -> int:
        """First step of the Single Shot Validation's interval in series of ``length`` samples."""
        return length - self.interval

    def recycle_starts(self) -> list[int]:
        """First steps of the Recycle Validation's intervals."""
        return [self.washout + index * self.interval for index in range(self.recycle_intervals)]

    def check(self, series: int, length: int) -> None:
        """Check that the intervals fit into ``series`` series of ``length`` samples.

        Raises
        ------
        ValueError
            If they do not; the message names the setting.
        """
        if self.recycle_series > series:
            raise ValueError(
                f"recycle_validation.series is {self.recycle_series}, but there are only {series} "
                f"training series"
            )
        needed = self.washout + self.interval * self.recycle_intervals
        if needed > length:
            fit = (length - self.washout) // self.interval
            raise ValueError(
                f"recycle_validation.intervals_per_series is {self.recycle_intervals}, but only "
                f"{fit} intervals of {self.interval} steps fit into a series of {length} samples"
            )
        if self.single_shot_start(length) <= self.washout:
            raise ValueError(
                f"series of {length} samples leave nothing to train on before the last validation "
                f"interval of {self.interval} steps"
            )
