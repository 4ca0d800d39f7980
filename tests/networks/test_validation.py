"""Validation strategies: their folds, and their objectives against plain closed loops."""

from dataclasses import replace
from itertools import product

import numpy as np
import pytest

from burstcast.networks.dynamics import Dynamics
from burstcast.networks.hyperparameters import HyperparameterPoint
from burstcast.networks.network import EchoStateNetwork
from burstcast.networks.network_search import best
from burstcast.networks.reservoir import make_reservoir
from burstcast.networks.scan import Evaluation
from burstcast.networks.training import TrainingSeries, train
from burstcast.networks.validation import DIVERGED_ERROR, Validation, validate
from burstcast.networks.validation_strategies import base, registry
from burstcast.networks.validation_strategies.base import ValidationPlan, use_of_series
from burstcast.networks.validation_strategies.recycle import RecycleValidation
from burstcast.networks.validation_strategies.registry import (
    available_strategies,
    make_strategy,
    strategy_module,
)
from burstcast.networks.validation_strategies.single_shot import SingleShotValidation
from burstcast.systems.integration import integrate
from burstcast.systems.lorenz63 import Lorenz63

NEURONS, DIMENSION = 40, 3
SERIES, LENGTH = 4, 260
PLAN = ValidationPlan(washout=15, interval=24, series=3, intervals=5)


def chaotic_series():
    """Noisy series of the Lorenz system."""
    generator = np.random.default_rng(6)
    start = np.array([1.0, 1.0, 20.0])[:, np.newaxis] + generator.random((3, SERIES))
    states = integrate(Lorenz63(), start, 0.01, 5 * (LENGTH + 40), stride=5)[41:]
    series = np.ascontiguousarray(states.transpose(2, 0, 1)) / 20
    return series + 0.005 * generator.normal(size=series.shape)


OBSERVED = chaotic_series()
RANGE = np.ptp(OBSERVED, axis=(0, 1))
TRAINING = TrainingSeries(OBSERVED, RANGE)
DYNAMICS = Dynamics(
    make_reservoir(NEURONS, DIMENSION, 6, 0.1, np.random.default_rng(2)), 0.6, 0.9, "scipy"
)


def observable(states):
    return 0.5 * (states**2).sum(axis=0)


def plain_objective(strategy, tikhonov, plan):
    """One series and one interval at a time, by a network that is trained for it."""
    alone, length = strategy == "SSV", OBSERVED.shape[1]
    cut = length - plan.interval if alone else length
    known = TrainingSeries(OBSERVED[:, :cut], RANGE)
    readout = train(DYNAMICS, known, washout=plan.washout, tikhonov=tikhonov)
    network = EchoStateNetwork(DYNAMICS, readout, RANGE)
    starts = plan.washout + plan.interval * np.arange(plan.intervals)
    errors = []
    for row, start in product(range(1 if alone else plan.series), [cut] if alone else starts):
        states = network.washout(OBSERVED[row, :start, :, np.newaxis])
        outputs = network.forecast(states, plan.interval)[0][:, :, 0]
        truth = OBSERVED[row, start : start + plan.interval]
        errors.append(np.log10(np.mean((observable(outputs.T) - observable(truth.T)) ** 2)))
    return np.mean(errors)


def validations(tikhonov=(1e-6,), strategies=("SSV", "RV"), plan=PLAN, training=TRAINING):
    made = [make_strategy(name) for name in strategies]
    return validate(DYNAMICS, training, observable, plan, tikhonov, made)


ALL = ("SSV", "RV")


# of which the last interval reaches the very end
TO_THE_END = ValidationPlan(20, 30, 2, 8)


# without regularisation rounding counts for more
@pytest.mark.parametrize(("tikhonov", "tolerance"), [(1e-6, 1e-6), (1e-12, 1e-3)])
@pytest.mark.parametrize(("strategy", "plan"), [("SSV", PLAN), ("RV", PLAN), ("RV", TO_THE_END)])
def test_objectives_are_those_of_plain_closed_loops(strategy, plan, tikhonov, tolerance):
    expected = plain_objective(strategy, tikhonov, plan)
    assert TO_THE_END.starts(LENGTH)[-1] + TO_THE_END.interval == LENGTH
    for strategies in (ALL, (strategy,)):
        made = validations((tikhonov,), strategies, plan)
        result = {result.strategy: result for result in made}
        assert result[strategy].objective == pytest.approx(expected, abs=tolerance)


def test_each_strategy_alone_is_what_it_is_in_the_shared_loop():
    beta = (1e-6, 1e-9)
    shared = validations(beta)
    assert [(result.strategy, result.tikhonov) for result in shared] == [*product(ALL, beta)]
    assert validations(beta, ["SSV"]) == shared[:2]
    assert validations(beta, ["RV", "SSV"]) == shared[2:] + shared[:2]
    one, other = make_strategy("RV"), make_strategy("SSV")
    beside = validate(DYNAMICS, TRAINING, observable, PLAN, beta, [one], [other])
    assert beside == shared[2:]
    # without the snapshot the panels are others, and so is the rounding
    for alone, together in zip(validations(beta, ["RV"]), shared[2:], strict=True):
        assert alone.objective == pytest.approx(together.objective, abs=1e-6)


@pytest.mark.parametrize(
    ("strategy", "plan", "message"),
    [
        ("RV", ValidationPlan(15, 24, 5, 5), "5 series .* there are only 4"),
        ("RV", ValidationPlan(15, 24, 3, 11), "11 validation intervals .* only 10"),
        ("SSV", ValidationPlan(100, 160, 1, 1), "leave nothing to train on"),
        ("SSV", replace(PLAN, single_shot_lead=245), "leave nothing to train on"),
    ],
)
def test_plans_that_do_not_fit_are_refused(strategy, plan, message):
    with pytest.raises(ValueError, match=message):
        validations(strategies=[strategy], plan=plan)
    ValidationPlan(15, LENGTH - 15, 1, None).check_intervals(1, LENGTH)  # one fits


def test_lost_forecasts_count_as_a_large_error_and_stay_finite(monkeypatch):
    def lost(self, weights, input_range, states, steps):
        outputs = np.full((steps, DIMENSION, states.shape[1]), 1.0)
        outputs[:, :, 0] = np.nan
        outputs[:, :, 1] = 1e200
        return outputs, states

    monkeypatch.setattr(Dynamics, "closed_loop", lost)
    (result,) = validations(strategies=["RV"])
    starts = PLAN.starts(10**6)
    truth = [
        [0.5 * (step**2).sum() for step in OBSERVED[series, start : start + PLAN.interval]]
        for start in starts
        for series in range(PLAN.series)
    ]
    logs = np.log10(((1.5 - np.array(truth)) ** 2).mean(axis=1))
    logs[:2] = np.log10(DIVERGED_ERROR)
    assert result.objective == pytest.approx(logs.mean(), rel=1e-12)


@pytest.mark.parametrize("last", [LENGTH, 200])
def test_errors_of_networks_with_an_offset_have_no_unit(monkeypatch, last):
    """A bound in units of the observable would take all forecasts for diverged ones."""

    def validation(observed, offset):
        scale = np.ptp(observed[:-1], axis=(0, 1))
        training = TrainingSeries(observed, scale, input_offset=offset)
        strategies = [make_strategy("RV")]
        return validate(DYNAMICS, training, lambda states: states[0], PLAN, [1e-3], strategies)[0]

    observed, mean = OBSERVED.copy(), OBSERVED.mean(axis=(0, 1))
    observed[-1, last:] = np.nan  # a shorter series
    moved = 1e8 * observed
    expected = np.array(validation(observed - mean, None).log_errors)
    expected -= np.log10(np.nanvar(observed[..., 0]))
    result = validation(moved, 1e8 * mean)
    np.testing.assert_allclose(result.log_errors, expected, rtol=0, atol=1e-6)

    def lost(self, weights, input_range, states, steps):
        return np.full((steps, DIMENSION, states.shape[1]), 1e99), states

    monkeypatch.setattr(Dynamics, "closed_loop", lost)
    assert validation(moved, 1e8 * mean).objective == np.log10(DIVERGED_ERROR)


def test_the_best_is_the_first_of_the_smallest():
    results = []
    for tikhonov, error in ((1e-6, -2.0), (1e-9, -3.0), (1e-12, -3.0)):
        validation = Validation("RV", tikhonov, (error,), "cholesky", 1e-9)
        results.append(Evaluation(0, "grid", HyperparameterPoint(1.0, 1.0), validation))
    assert best(results) is results[1]


# -- how strategies are found, and their folds -----------------------------------------------------

SMALL = ValidationPlan(washout=5, interval=10, series=2, intervals=3)


def test_strategies_are_found_by_their_names(monkeypatch):
    assert available_strategies() == ["RV", "SSV"]
    assert isinstance(make_strategy("RV"), RecycleValidation)
    assert strategy_module("RV") == "burstcast.networks.validation_strategies.recycle"
    with pytest.raises(ValueError, match=r"unknown validation strategy 'SV' .*mean 'SSV'.* RV, SS"):
        make_strategy("SV")
    assert base.ValidationStrategy not in registry._classes().values()
    monkeypatch.setattr(SingleShotValidation, "name", "RV")
    with pytest.raises(TypeError, match="both define 'RV'"):
        available_strategies()


def test_use_of_a_series():
    assert use_of_series(make_strategy("SSV").folds(SMALL, 4, 40), 0) == (30, [30])
    assert use_of_series(make_strategy("SSV").folds(SMALL, 4, 40), 1) == (30, [])
    assert use_of_series(make_strategy("RV").folds(SMALL, 4, 40), 1) == (40, [5, 15, 25])
    assert use_of_series([], 1) == (0, [])  # neither trained on nor validated


def test_the_single_shot_may_start_within_the_training_data():
    (fold,) = make_strategy("SSV").folds(SMALL, 4, 40)
    (authors,) = make_strategy("SSV").folds(replace(SMALL, single_shot_lead=1), 4, 40)
    assert (fold.starts, authors.starts) == ((30,), (29,))
    assert fold.trained == authors.trained
