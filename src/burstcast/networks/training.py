"""The open loop over the training series, gathered into what training and validation need.

Source: section "Echo State Networks" of the paper. All series are driven side by side, and the
states are summed up panel by panel as they come: they are never all in memory.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import reduce

import numpy as np

from burstcast.base.arrays import FloatArray, IntArray
from burstcast.base.series_lengths import series_lengths
from burstcast.networks.dynamics import Dynamics
from burstcast.networks.factored import FactoredStates
from burstcast.networks.readout import Moments, MomentsAccumulator, Readout, solve_ridge


@dataclass(frozen=True)
class TrainingSeries:
    """Series to learn from.

    Attributes
    ----------
    observed
        States with their observation noise, ``(series, time, dimension)``: inputs and targets.
        Series that are shorter than the longest are filled up with NaN.
    input_range
        What the inputs are divided by, ``(dimension,)``.
    factors
        Factors of parameters in force from each sample to the next, ``(series, time - 1,
        factors)``, in which the readout is linear (`burstcast.networks.factored`); None: a plain
        readout.
    input_offset
        What is subtracted from inputs and targets, ``(dimension,)``; None: nothing. The ridge
        regression penalises the bias of the readout, too, which would have to make up for it.
    """

    observed: FloatArray
    input_range: FloatArray
    factors: FloatArray | None = None
    input_offset: FloatArray | None = None

    def __post_init__(self) -> None:
        """Check the factors.

        Raises
        ------
        ValueError
            If they do not fit the series.
        """
        expected = (self.series, self.length - 1)
        if self.factors is not None and self.factors.shape[:2] != expected:
            raise ValueError(
                f"{self.series} series of {self.length} samples need factors of the shape "
                f"({self.series}, {self.length - 1}, factors), not {self.factors.shape}"
            )

    def longest_first(self) -> "TrainingSeries":
        """Series of unequal lengths in the order of these, others in their own."""
        lengths = series_lengths(self.observed)
        return self if lengths is None else self.part(np.argsort(-lengths, kind="stable"))

    def part(self, rows: slice | IntArray) -> "TrainingSeries":
        """Some of the series."""
        factors = None if self.factors is None else self.factors[rows]
        return replace(self, observed=self.observed[rows], factors=factors)

    @property
    def series(self) -> int:
        """Number of series."""
        return int(self.observed.shape[0])

    @property
    def length(self) -> int:
        """Samples of each series."""
        return int(self.observed.shape[1])

    @property
    def dimension(self) -> int:
        """Components of an observed state."""
        return int(self.observed.shape[2])


@dataclass(frozen=True)
class Collected:
    """Result of an open loop over the training series.

    The state at step j has seen the inputs up to step j - 1; its target is the data of step j.
    """

    moments: Moments  #: moments of all states after the washout
    #: moments of the states before a step, by step, where they were requested
    snapshots: dict[int, Moments]
    #: reservoir states ``(neurons, series)`` by step, where they were asked for
    states: dict[int, FloatArray]


def collect(
    dynamics: Dynamics,
    training: TrainingSeries,
    *,
    washout: int,
    snapshots: Sequence[int] = (),
    last: int | None = None,
    keep: Sequence[int] = (),
) -> Collected:
    """Drive a reservoir by the training series.

    ``washout``: Number of inputs before the first state that counts, which is the one at step
    ``washout``. ``last``: Last step that is needed; None: the end of the series. The states up to
    and including it are driven; its own state counts in the moments as all others do.
    """
    end = training.length - 1 if last is None else last
    wanted = sorted(set(keep))
    if washout < 1:
        raise ValueError(f"the washout must have at least one step, not {washout}")
    outside = [
        *(step for step in wanted if not washout <= step <= end),
        *(step for step in snapshots if not washout < step <= end),
    ]
    if outside or not washout < end <= training.length - 1:
        raise ValueError("the steps asked for lie outside of the training series")
    # inputs 0 .. end - 1 lead to the states at steps 1 .. end
    # a copy always: for a single series the transpose is contiguous as it is
    inputs = np.array(training.observed[:, :end].transpose(1, 2, 0), order="C")
    offset = training.input_offset
    if offset is not None:
        inputs -= offset[:, np.newaxis]
    inputs /= training.input_range[:, np.newaxis]
    lengths = series_lengths(training.observed)
    if lengths is not None:
        inputs[np.isnan(inputs)] = 0.0  # series that have ended are driven on, and do not count
    factors = training.factors
    layout = FactoredStates.of(dynamics.reservoir, 0 if factors is None else factors.shape[2])
    accumulator = MomentsAccumulator(layout.size, training.observed.shape[2])
    taken: dict[int, Moments] = {}
    states: dict[int, FloatArray] = {}
    breakpoints = [washout - 1, *(step - 1 for step in snapshots)]
    for panel in dynamics.state_panels(inputs, breakpoints=breakpoints):
        first, stop = panel.start + 1, panel.stop + 1  # steps of the states in this panel
        for step in wanted:
            if first <= step < stop:
                states[step] = panel.states[:, step - first].copy()
        if first < washout:
            continue
        if first in snapshots and first not in taken:
            taken[first] = accumulator.moments()
        targets = training.observed[:, first:stop].transpose(2, 1, 0)
        if offset is not None:
            targets = targets - offset[:, np.newaxis, np.newaxis]
        columns = dynamics.features(panel.columns)
        if factors is not None:
            # a state at step j predicts step j: what counts is in force from step j - 1 on
            in_force = factors[:, first - 1 : stop - 1].transpose(2, 1, 0)
            columns = layout.features(columns, in_force.reshape(layout.factors, columns.shape[1]))
        targets = targets.reshape(len(targets), -1)
        if lengths is not None:
            there = (np.arange(first, stop)[:, np.newaxis] < lengths).reshape(-1)
            columns, targets = np.ascontiguousarray(columns[:, there]), targets[:, there]
        accumulator.add(columns, targets)
    return Collected(moments=accumulator.moments(), snapshots=taken, states=states)


def train(
    dynamics: Dynamics, training: TrainingSeries, *, washout: int, tikhonov: float
) -> Readout:
    """Readout of a network trained on the whole of the series (paper, ridge regression).

    Examples
    --------
    >>> import numpy as np
    >>> from burstcast.networks.dynamics import Dynamics
    >>> from burstcast.networks.reservoir import make_reservoir
    >>> from burstcast.networks.training import TrainingSeries, train
    >>> series = np.sin(np.linspace(0, 50, 1000)).reshape(1, 1000, 1)
    >>> reservoir = make_reservoir(50, 1, 10, 0.1, np.random.default_rng(0))
    >>> dynamics = Dynamics(reservoir, spectral_radius=0.5, input_scaling=1.0)
    >>> training = TrainingSeries(series, np.array([2.0]))
    >>> train(dynamics, training, washout=100, tikhonov=1e-9).weights.shape
    (51, 1)
    """
    return solve_ridge(collect(dynamics, training, washout=washout).moments, tikhonov)


def train_leaving_one_out(
    dynamics: Dynamics, training: TrainingSeries, *, washout: int, tikhonov: float
) -> Iterator[Readout]:
    """Readouts trained on all series but one, for each series in turn.

    Moments are sums over the series: one open loop serves all readouts, and each takes one ridge
    regression. What the readout forecasts of the series left out is honest, but for what the series
    has contributed to the hyperparameters and to the range that inputs are divided by.
    """
    if training.series < 2:
        raise ValueError("leaving one series out takes two training series at least")
    moments = [
        collect(
            dynamics,
            training.part(slice(row, row + 1)),
            washout=washout,
        ).moments
        for row in range(training.series)
    ]
    for row in range(training.series):
        others = moments[:row] + moments[row + 1 :]
        yield solve_ridge(reduce(Moments.merge, others), tikhonov)
