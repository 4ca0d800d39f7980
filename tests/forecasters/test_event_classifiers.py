"""Kinds that give probabilities of events without a trajectory."""

from itertools import product

import numpy as np
import pytest
from sklearn.linear_model import LogisticRegression
from sklearn.metrics import average_precision_score
from sklearn.preprocessing import PolynomialFeatures, scale

from burstcast.forecasters._event_classifier import EventClassifier, LabelledPoints
from burstcast.forecasters._logistic_readout import event_probability, fit_logistic
from burstcast.forecasters.base import ForecastingCase
from burstcast.forecasters.precursor import lag_steps
from burstcast.forecasters.registry import (
    as_forecaster,
    available_kinds,
    kind_class,
    make_kind,
    trajectory_kinds,
)
from burstcast.networks.dynamics import Dynamics
from burstcast.networks.reservoir import ReservoirSeed
from burstcast.systems.lorenz63 import Lorenz63

KINDS = sorted(set(available_kinds()) - set(trajectory_kinds()))

SMALL = {"neurons": 40, "connectivity": 6, "spectral_radius": [0.8], "input_scaling": [5.0]}


CASE = ForecastingCase(Lorenz63(), 0.01, 1, 10, random_seed=7)


def direct(**options):
    return make_kind("esn_direct", SMALL | {"backend": "scipy"} | options)


def labelled(points=600):
    """Points whose event is a function of the present and of two steps before."""
    washouts = np.random.default_rng(1).normal(size=(points, 5, 3))
    happened = np.stack([washouts[:, -1, 0] > 1, washouts[:, -1, 1] * washouts[:, -3, 2] > 0.5])
    return LabelledPoints(washouts, happened.T, np.arange(points) // 100)


def test_kinds_say_that_they_have_no_trajectories():
    assert KINDS == ["esn_direct", "precursor"]
    for kind in KINDS:
        assert isinstance(make_kind(kind, {}), EventClassifier)
        assert not hasattr(kind_class(kind), "linearises")
        with pytest.raises(ValueError, match=f"{kind} gives probabilities .* without a trajectory"):
            as_forecaster(make_kind(kind, {}))
    for kind in trajectory_kinds():
        assert kind_class(kind) is type(as_forecaster(make_kind(kind, {})))


def test_a_logistic_precursor_is_that_of_scikit_learn_on_features_cut_by_hand():
    points = labelled()
    precursor = make_kind("precursor", {"classifier": "logistic", "lags_lt": [0.2]})
    probabilities = precursor.fit(points, CASE).probabilities(points.washouts)
    features = np.hstack([points.washouts[:, 4], points.washouts[:, 2]])
    products = scale(PolynomialFeatures(2, include_bias=False).fit_transform(scale(features)))
    for window in range(2):
        oracle = LogisticRegression(C=1, max_iter=1000).fit(products, points.happened[:, window])
        np.testing.assert_allclose(probabilities[:, window], oracle.predict_proba(products)[:, 1])


@pytest.mark.parametrize("offset", ["mean", "none"])
def test_a_reservoir_is_read_out_by_the_logistic_regression_of_scikit_learn(offset):
    points = labelled()
    fitted = direct(penalty=[2.0], input_offset=offset).fit(points, CASE)
    fresh = np.random.default_rng(2).normal(size=(50, 5, 3))
    dynamics = Dynamics(ReservoirSeed(7, 40, 0, 6, 1.0).reservoir(3), 0.8, 5.0, "scipy")
    centre = points.washouts.mean(axis=(0, 1)) if offset == "mean" else 0.0

    def states(washouts):
        normalised = (washouts - centre) / np.ptp(points.washouts, axis=(0, 1))
        return dynamics.open_loop(np.ascontiguousarray(normalised.transpose(1, 2, 0))).T

    learnt = states(points.washouts)
    mean, deviation = learnt.mean(axis=0), learnt.std(axis=0)
    probabilities = fitted.probabilities(fresh)
    for window in range(2):
        oracle = LogisticRegression(C=0.5, tol=1e-10, max_iter=10_000)
        oracle.fit((learnt - mean) / deviation, points.happened[:, window])
        expected = oracle.predict_proba((states(fresh) - mean) / deviation)[:, 1]
        np.testing.assert_allclose(probabilities[:, window], expected, atol=1e-5)


def test_hyperparameters_are_those_that_rank_the_events_of_held_out_series_best():
    points = labelled()
    grid = list(product([0.3, 0.9], [0.5, 5.0], [1.0, 100.0]))
    held_out, scores = np.isin(points.series, [0, 3]), []
    for radius, scaling, penalty in grid:
        single = {"spectral_radius": [radius], "input_scaling": [scaling], "penalty": [penalty]}
        fitted = direct(**single).fit(points, CASE)
        # states of a fitted reservoir after washouts
        inputs = (points.washouts / fitted.input_scale).transpose(1, 2, 0)
        states = fitted.dynamics.open_loop(np.ascontiguousarray(inputs), None).T
        weights = fit_logistic(states[~held_out], points.happened[~held_out], penalty)
        chance = event_probability(weights, states[held_out])
        happened = points.happened[held_out]
        scores.append(
            np.mean([average_precision_score(*of) for of in zip(happened.T, chance.T, strict=True)])
        )
    best = grid[int(np.argmax(scores))]
    assert best != grid[0]
    many = {"spectral_radius": [0.3, 0.9], "input_scaling": [0.5, 5.0], "penalty": [1.0, 100.0]}
    fitted = direct(**many).fit(points, CASE)
    dynamics = fitted.dynamics
    assert (dynamics.spectral_radius, dynamics.input_scaling, fitted.chosen_penalty) == best
    # and calibration takes them as they are
    options = fitted.tuned().options
    names = ("spectral_radius", "input_scaling", "penalty")
    assert tuple(options[name] for name in names) == tuple((value,) for value in best)
    assert options["neurons"] == 40


def test_lags_are_steps_within_the_washout():
    assert lag_steps([0.1, 0.25], 60, 16) == (6, 15)
    for arguments, message in (
        (([0.1, 0.25], 60, 15), r"has 0.25, a lag of 15 steps, but washout_lt holds .* 14"),
        (([0.1, 0.11], 60), r"lags_lt is \[0.1, 0.11\], of which several are the same"),
        (([0.01], 60), "shorter than one step"),
    ):
        with pytest.raises(ValueError, match=message):
            lag_steps(*arguments)


def test_points_say_in_which_window_there_is_nothing_to_learn():
    points = labelled(50)
    points.check([1, 2])
    points.happened[:, 1] = False
    with pytest.raises(ValueError, match=r"follows 0 of the 50 .* begins 2 Lyapunov times later"):
        points.check([1, 2])
    points.happened[:, 0] = True
    with pytest.raises(ValueError, match=r"follows 50 of the 50 .* begins 0.5 Lyapunov times"):
        points.check([0.5, 1])
