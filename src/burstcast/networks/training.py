"""The open loop over the training series, gathered into what training and validation need.

Source: section "Echo State Networks" of the paper. All series are driven side by side, and the
states are summed up panel by panel as they come: they are never all in memory.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import reduce
from typing import Any, Self

import numpy as np

from burstcast.base.arrays import FloatArray, IntArray
from burstcast.base.left_out import LeftOut, rows_left_out
from burstcast.base.series_lengths import series_lengths
from burstcast.networks.dynamics import COLUMNS_PER_PANEL, Dynamics
from burstcast.networks.network import EchoStateNetwork
from burstcast.networks.readout import Moments, MomentsAccumulator, Readout, solve_ridge

_AT_A_TIME = 8
"""Series that are driven side by side: a vector of the processor, whose panels take little room."""


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
    input_offset
        What is subtracted from inputs and targets, ``(dimension,)``; None: nothing. The ridge
        regression penalises the bias of the readout, too, which would have to make up for it.
    inputs
        What drives the reservoir in training, where that is not ``observed``, of the same shape.
    knowledge
        Fields of the trained forecaster that say how the series depend on parameters.
    """

    observed: FloatArray
    input_range: FloatArray
    input_offset: FloatArray | None = None
    inputs: FloatArray | None = field(default=None, kw_only=True)
    knowledge: Mapping[str, Any] = field(default_factory=dict, kw_only=True)

    def longest_first(self) -> Self:
        """Series of unequal lengths in the order of these, others in their own."""
        lengths = series_lengths(self.observed)
        return self if lengths is None else self.part(np.argsort(-lengths, kind="stable"))

    def part(self, rows: slice | IntArray) -> Self:
        """Some of the series."""
        inputs = None if self.inputs is None else self.inputs[rows]
        return replace(self, observed=self.observed[rows], inputs=inputs)

    def feature_count(self, dynamics: Dynamics) -> int:
        """Number of features that the readout of a network multiplies."""
        return dynamics.reservoir.neurons

    def features(self, dynamics: Dynamics, states: FloatArray, first: int, stop: int) -> FloatArray:
        """Features of states ``(neurons, steps * series)`` from step ``first`` up to ``stop``.

        The states are overwritten.
        """
        return dynamics.features(states, overwrite=True)

    def closed_loop(
        self,
        network: EchoStateNetwork,
        states: FloatArray,
        rows: slice,
        starts: Sequence[int],
        steps: int,
    ) -> FloatArray:
        """Forecasts of some series from some steps on, ``(steps, dimension, starts * series)``.

        ``states``: Reservoir states before these steps, ``(neurons, starts * series)``.
        """
        return network.forecast(states, steps)[0]

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
    """Drive a reservoir by the training series, up to and including the step ``last``.

    ``washout``: Number of inputs before the first state that counts. ``snapshots``, ``keep``: Steps
    before which moments, and at which states, are wanted.
    """
    end = training.length - 1 if last is None else last
    wanted = sorted(set(keep))
    if washout < 1:
        raise ValueError(f"the washout must have at least one step, not {washout}")
    inside = all(washout <= step <= end for step in wanted)
    inside = inside and all(washout < step <= end for step in snapshots)
    if not inside or not washout < end <= training.length - 1:
        raise ValueError("the steps asked for lie outside of the training series")
    # inputs 0 .. end - 1 lead to the states at steps 1 .. end
    inputs, lengths = _inputs(training, end)
    offset = training.input_offset
    features = training.feature_count(dynamics)
    accumulator = MomentsAccumulator(features, training.dimension)
    taken: dict[int, Moments] = {}
    states: dict[int, FloatArray] = {}
    breakpoints = [step - 1 for step in (washout, *snapshots)]
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
        columns = training.features(dynamics, panel.columns, first, stop)
        targets = targets.reshape(len(targets), -1)
        if lengths is not None:
            there = (np.arange(first, stop)[:, np.newaxis] < lengths).reshape(-1)
            columns, targets = np.ascontiguousarray(columns[:, there]), targets[:, there]
        accumulator.add(columns, targets, overwrite=True)
    return Collected(moments=accumulator.moments(), snapshots=taken, states=states)


def train(
    dynamics: Dynamics, training: TrainingSeries, *, washout: int, tikhonov: float
) -> Readout:
    """Readout of a network trained on the whole of the series (paper, ridge regression).

    Examples
    --------
    >>> series = np.sin(np.linspace(0, 50, 1000)).reshape(1, 1000, 1)
    >>> from burstcast.networks.reservoir import make_reservoir
    >>> reservoir = make_reservoir(50, 1, 10, 0.1, np.random.default_rng(0))
    >>> dynamics = Dynamics(reservoir, spectral_radius=0.5, input_scaling=1.0)
    >>> training = TrainingSeries(series, np.array([2.0]))
    >>> train(dynamics, training, washout=100, tikhonov=1e-9).weights.shape
    (51, 1)
    """
    return solve_ridge(collect(dynamics, training, washout=washout).moments, tikhonov)


def train_leaving_one_out(
    dynamics: Dynamics,
    training: TrainingSeries,
    *,
    washout: int,
    tikhonov: float,
    left_out: Sequence[LeftOut] | None = None,
) -> Iterator[Readout]:
    """Readouts trained on all series but those left out, each series in turn by default.

    Moments are sums over the series: one open loop serves all readouts.
    """
    left_out_rows = rows_left_out(training.series, left_out)
    moments = [*_moments_of_each(dynamics, training, washout)]
    before: list[Moments] = []  # the sum of the first ``summed`` series
    summed = 0
    for rows in left_out_rows:
        first = min(rows)
        if summed > first:
            before, summed = [], 0
        if summed < first:
            before = [reduce(Moments.merge, [*before, *moments[summed:first]])]
            summed = first
        after = [each for row, each in enumerate(moments) if row > first and row not in rows]
        yield solve_ridge(reduce(Moments.merge, [*before, *after]), tikhonov)


def _moments_of_each(
    dynamics: Dynamics, training: TrainingSeries, washout: int
) -> Iterator[Moments]:
    """Moments of each series alone, bit for bit those of `collect`; some are driven at a time."""
    inputs, lengths = _inputs(training, training.length - 1)
    size = training.feature_count(dynamics), training.dimension
    for start in range(0, training.series, _AT_A_TIME):
        rows = range(start, min(start + _AT_A_TIME, training.series))
        sums = [MomentsAccumulator(*size) for _ in rows]
        panels = dynamics.state_panels(
            inputs[..., rows.start : rows.stop],
            breakpoints=[washout - 1],
            columns_per_panel=COLUMNS_PER_PANEL * len(rows),  # as many of each as in `collect`
        )
        for panel in panels:
            first, stop = panel.start + 1, panel.stop + 1
            if first < washout:
                continue
            for place, row in enumerate(rows):
                part = training.part(slice(row, row + 1))
                columns = np.ascontiguousarray(panel.states[:, :, place])
                columns = part.features(dynamics, columns, first, stop)
                targets = part.observed[0, first:stop].T
                if training.input_offset is not None:
                    targets = targets - training.input_offset[:, np.newaxis]
                if lengths is not None and lengths[row] < training.length:
                    there = np.arange(first, stop) < lengths[row]
                    columns, targets = np.ascontiguousarray(columns[:, there]), targets[:, there]
                sums[place].add(columns, targets, overwrite=True)
        yield from (each.moments() for each in sums)


def _inputs(training: TrainingSeries, end: int) -> tuple[FloatArray, IntArray | None]:
    """Inputs ``(steps, dimension, series)`` before the step ``end``; lengths, where they differ."""
    driving = training.observed if training.inputs is None else training.inputs
    # a copy always: for a single series the transpose is contiguous as it is
    inputs = np.array(driving[:, :end].transpose(1, 2, 0), order="C")
    if training.input_offset is not None:
        inputs -= training.input_offset[:, np.newaxis]
    inputs /= training.input_range[:, np.newaxis]
    lengths = series_lengths(training.observed)
    if lengths is not None:
        inputs[np.isnan(inputs)] = 0.0  # series that have ended are driven on, and do not count
    return inputs, lengths
