"""Validation of one point of the hyperparameter space, by any strategy.

Source: section "Validation" and the appendix "Training and validation sets" of the paper. One open
loop over the training series serves all strategies that train on all series alike.
"""

import functools
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from burstcast.base.arrays import FloatArray
from burstcast.base.series_lengths import samples_of, series_lengths
from burstcast.networks.dynamics import Dynamics
from burstcast.networks.hyperparameters import HyperparameterPoint
from burstcast.networks.network import EchoStateNetwork
from burstcast.networks.readout import Moments, Readout, ReadoutKind, solve_ridge
from burstcast.networks.reservoir import Reservoir
from burstcast.networks.training import Collected, TrainingSeries, collect
from burstcast.networks.validation_strategies.base import Fold, ValidationPlan, ValidationStrategy

DIVERGED_ERROR = 1e12
"""Mean square error that a diverged forecast counts as: far beyond any other, yet finite.

Of networks whose inputs have an offset, errors are relative to the variance of the observable in
the training series, so that this bound is the same in any unit; of others they are in units of the
observable, as in the paper.
"""


@dataclass(frozen=True)
class Validation:
    """Outcome of one strategy at one point of the search and one Tikhonov parameter."""

    strategy: str  #: name of the strategy
    tikhonov: float
    #: log10 of the mean square error of the observable in each interval, in the order of the
    #: strategy's folds; relative to its variance where inputs have an offset (`DIVERGED_ERROR`)
    log_errors: tuple[float, ...]
    #: solver, reciprocal_condition: how the ridge regression was solved, and the estimate of the
    #: reciprocal condition number of its matrix: of the fold where it is the smallest
    solver: str
    reciprocal_condition: float

    @property
    def objective(self) -> float:
        """Mean of the intervals' errors, which the search minimises."""
        return float(np.mean(self.log_errors))


def validate(
    dynamics: Dynamics,
    training: TrainingSeries,
    observable: Callable[[FloatArray], FloatArray],
    plan: ValidationPlan,
    tikhonov: Sequence[float],
    strategies: Sequence[ValidationStrategy],
    alongside: Sequence[ValidationStrategy] = (),
) -> list[Validation]:
    """Train one network and validate it by each strategy with each Tikhonov parameter.

    ``alongside``: Strategies whose sums are taken as well, so that those of the others are bit for
    bit what they are in a scan for all.
    """
    folds = [
        strategy.folds(plan, training.series, training.length)
        for strategy in (*strategies, *alongside)
    ]
    loops = _open_loops(dynamics, training, plan.washout, [fold for some in folds for fold in some])
    unit = 1.0
    if training.input_offset is not None:
        states, unequal = training.observed, series_lengths(training.observed) is not None
        samples = samples_of(states).T if unequal else states.transpose(2, 0, 1)
        unit = float(np.var(observable(samples)))
    results = []
    for strategy, of_strategy in zip(strategies, folds[: len(strategies)], strict=True):
        readouts: list[list[Readout]] = [[] for _ in tikhonov]
        errors: list[list[FloatArray]] = [[] for _ in tikhonov]
        for fold in of_strategy:
            moments = loops.moments(fold)
            states = loops.states(fold)
            truth = _truth(training, observable, fold, plan.interval)
            rows = slice(fold.series.start, fold.series.stop)
            if np.isnan(truth).any():
                raise ValueError("a validation interval reaches beyond the end of its series")
            for number, beta in enumerate(tikhonov):
                readout = solve_ridge(moments, beta)
                readouts[number].append(readout)
                network = EchoStateNetwork(
                    dynamics, readout, training.input_range, training.input_offset
                )
                outputs = training.closed_loop(network, states, rows, fold.starts, plan.interval)
                errors[number].append(_log_errors(outputs, observable, truth, unit))
        for number, beta in enumerate(tikhonov):
            worst = min(readouts[number], key=lambda readout: readout.reciprocal_condition)
            results.append(
                Validation(
                    strategy=strategy.name,
                    tikhonov=beta,
                    log_errors=tuple(np.concatenate(errors[number]).tolist()),
                    solver=worst.solver,
                    reciprocal_condition=worst.reciprocal_condition,
                )
            )
    return results


@dataclass(frozen=True)
class PointValidator:
    """Validates points of the search of one reservoir."""

    reservoir: Reservoir  #: the random matrices
    training: TrainingSeries
    observable: Callable[[FloatArray], FloatArray]
    plan: ValidationPlan
    tikhonov: Sequence[float]
    backend: Literal["compiled", "scipy"]  #: implementation of the dynamics (`Dynamics`)
    readout: ReadoutKind = "linear"  #: what the output weights multiply
    #: strategies whose sums are taken as well (see `validate`)
    alongside: Sequence[ValidationStrategy] = ()

    def __call__(
        self, point: HyperparameterPoint, strategies: Sequence[ValidationStrategy]
    ) -> list[Validation]:
        """Validate a point by each strategy with each Tikhonov parameter (see `validate`)."""
        return validate(
            self.dynamics(point),
            self.training,
            self.observable,
            self.plan,
            self.tikhonov,
            strategies,
            self.alongside,
        )

    def dynamics(self, point: HyperparameterPoint) -> Dynamics:
        """Reservoir at a point of the search."""
        return Dynamics(
            self.reservoir,
            point.spectral_radius,
            point.input_scaling,
            self.backend,
            point.leak_rate,
            self.readout,
        )


@dataclass(frozen=True)
class _OpenLoops:
    """Results of the open loops over parts of the training series, by their rows."""

    length: int
    by_rows: dict[range, Collected]

    def moments(self, fold: Fold) -> Moments:
        """Moments of all that a fold is trained on."""
        parts = []
        for block in fold.trained:
            collected = self.by_rows[block.series]
            whole = block.stop == self.length
            parts.append(collected.moments if whole else collected.snapshots[block.stop])
        return functools.reduce(Moments.merge, parts)

    def states(self, fold: Fold) -> FloatArray:
        """States ``(neurons, intervals)`` from which the closed loops of a fold start."""
        rows = _within(self.by_rows, fold.series)
        columns = slice(fold.series.start - rows.start, fold.series.stop - rows.start)
        states = self.by_rows[rows].states
        return np.concatenate([states[start][:, columns] for start in fold.starts], axis=1)


def _open_loops(
    dynamics: Dynamics, training: TrainingSeries, washout: int, folds: Sequence[Fold]
) -> _OpenLoops:
    """Drive the reservoir by all that the folds need, each block of series once."""
    needs: dict[range, tuple[set[int], set[int]]] = {}
    for fold in folds:
        for block in fold.trained:
            needs.setdefault(block.series, (set(), set()))[0].add(block.stop)
    for fold in folds:
        rows = _within(needs, fold.series)
        needs.setdefault(rows, (set(), set()))[1].update(fold.starts)
    by_rows = {}
    for rows, (stops, starts) in needs.items():
        last = max(stops | starts)
        by_rows[rows] = collect(
            dynamics,
            training.part(slice(rows.start, rows.stop)),
            washout=washout,
            # moments of all the steps are there anyway
            snapshots=sorted(stops - {training.length}),
            last=last if last < training.length else None,
            keep=sorted(starts),
        )
    return _OpenLoops(training.length, by_rows)


def _within(driven: Iterable[range], rows: range) -> range:
    """Block of series that contains some rows; if there is none, these rows themselves."""
    for block in driven:
        if block.start <= rows.start and rows.stop <= block.stop:
            return block
    return rows


def _truth(
    training: TrainingSeries,
    observable: Callable[[FloatArray], FloatArray],
    fold: Fold,
    interval: int,
) -> FloatArray:
    """Observed observable of a fold's intervals, ``(interval, intervals)``."""
    rows = slice(fold.series.start, fold.series.stop)
    return np.concatenate(
        [
            observable(training.observed[rows, start : start + interval].transpose(2, 1, 0))
            for start in fold.starts
        ],
        axis=1,
    )


def _log_errors(
    outputs: FloatArray,
    observable: Callable[[FloatArray], FloatArray],
    truth: FloatArray,
    unit: float,
) -> FloatArray:
    """log10 of the mean square error of the observable over each interval, ``(intervals,)``.

    ``outputs``: Forecasts, ``(steps, dimension, intervals)``. ``unit``: What the errors are divided
    by.
    """
    with np.errstate(over="ignore", invalid="ignore"):
        error = np.mean((observable(outputs.transpose(1, 0, 2)) - truth) ** 2, axis=0)
        error = error / unit
    # a comparison with NaN is False: a forecast that is lost counts as the largest error
    error = np.where(error < DIVERGED_ERROR, error, DIVERGED_ERROR)
    return np.asarray(np.log10(error))
