"""Single Shot and Recycle Validation of one point of the hyperparameter space.

Source: section "Validation" and the appendix "Training and validation sets" of the paper; Racca &
Magri, "Robust optimization and validation of echo state networks for learning chaotic dynamics",
Neural Networks 142 (2021). One open loop over the training series serves both strategies: the
moments of the Single Shot Validation are a snapshot of those of the Recycle Validation, taken one
validation interval before the series end.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from burstcast.arrays import FloatArray
from burstcast.esn.dynamics import Dynamics
from burstcast.esn.readout import Readout, solve_ridge
from burstcast.esn.training import TrainingSeries, collect
from burstcast.tuning.plan import ValidationPlan

STRATEGIES = ("SSV", "RV")

DIVERGED_ERROR = 1e12
"""Mean square error that a diverged forecast counts as: far beyond any other, yet finite."""


@dataclass(frozen=True)
class Validation:
    """Outcome of one strategy at one point of the search and one Tikhonov parameter.

    Attributes
    ----------
    strategy
        "SSV" or "RV".
    tikhonov
        beta.
    objective
        log10 of the mean square error of the observable, averaged over the intervals.
    solver
        How the ridge regression was solved.
    reciprocal_condition
        Estimate of the reciprocal condition number of its matrix.
    """

    strategy: str
    tikhonov: float
    objective: float
    solver: str
    reciprocal_condition: float


def validate(
    dynamics: Dynamics,
    training: TrainingSeries,
    observable: Callable[[FloatArray], FloatArray],
    plan: ValidationPlan,
    tikhonov: Sequence[float],
    strategies: Sequence[str] = STRATEGIES,
) -> list[Validation]:
    """Train one network and validate it by each strategy with each Tikhonov parameter.

    Parameters
    ----------
    dynamics
        Reservoir at the point of the search.
    training
        Observed training series.
    observable
        From states ``(dimension, ...)`` to the observable ``(...)``.
    plan
        The validation intervals.
    tikhonov
        Values of beta.
    strategies
        Any of `STRATEGIES`.

    Raises
    ------
    ValueError
        If a strategy is unknown or the plan does not fit the series.
    """
    unknown = set(strategies) - set(STRATEGIES)
    if unknown:
        raise ValueError(f"unknown validation strategies {sorted(unknown)}; known: {STRATEGIES}")
    plan.check(training.series, training.length)
    cut = plan.single_shot_start(training.length)
    recycle_starts = plan.recycle_starts() if "RV" in strategies else []
    collected = collect(
        dynamics,
        training,
        washout=plan.washout,
        # moments of all steps before the cut; Single Shot Validation alone needs no others
        snapshot=cut if "SSV" in strategies else None,
        last=None if "RV" in strategies else cut,
        keep=[*recycle_starts, *([cut] if "SSV" in strategies else [])],
    )
    results = []
    for strategy in strategies:
        if strategy == "SSV":
            moments, starts, series = collected.snapshot, [cut], 1
        else:
            moments, starts, series = collected.moments, recycle_starts, plan.recycle_series
        assert moments is not None
        states = np.concatenate([collected.states[start][:, :series] for start in starts], axis=1)
        truth = np.concatenate(
            [
                observable(
                    training.observed[:series, start : start + plan.interval].transpose(2, 1, 0)
                )
                for start in starts
            ],
            axis=1,
        )
        for beta in tikhonov:
            readout = solve_ridge(moments, beta)
            results.append(
                Validation(
                    strategy=strategy,
                    tikhonov=beta,
                    objective=_objective(dynamics, training, observable, readout, states, truth),
                    solver=readout.solver,
                    reciprocal_condition=readout.reciprocal_condition,
                )
            )
    return results


def best(validations: Sequence[Validation], strategy: str) -> Validation:
    """Validation of a strategy with the smallest objective; the first of equals."""
    return min(
        (validation for validation in validations if validation.strategy == strategy),
        key=lambda validation: validation.objective,
    )


def _objective(
    dynamics: Dynamics,
    training: TrainingSeries,
    observable: Callable[[FloatArray], FloatArray],
    readout: Readout,
    states: FloatArray,
    truth: FloatArray,
) -> float:
    """Mean over the intervals of log10 of the mean square error of the observable."""
    outputs, _ = dynamics.closed_loop(
        readout.weights, training.input_range, states, steps=truth.shape[0]
    )
    with np.errstate(over="ignore", invalid="ignore"):
        error = np.mean((observable(outputs.transpose(1, 0, 2)) - truth) ** 2, axis=0)
    # not a number compares as False: a forecast that is lost counts as the largest error
    error = np.where(error < DIVERGED_ERROR, error, DIVERGED_ERROR)
    return float(np.mean(np.log10(error)))
