"""Logistic regression of several events against a direct minimisation by SciPy."""

import numpy as np
import pytest
from scipy.optimize import minimize

from burstcast.probability.logistic_readout import event_probability, fit_logistic


def drawn(points=400):
    generator = np.random.default_rng(5)
    features = generator.normal(size=(points, 6)) * [1, 10, 0.1, 1, 1, 1] + [0, 3, 0, -2, 0, 0]
    odds = np.stack([features[:, 0] - 2.0, 0.3 * features[:, 1] - features[:, 3] - 4.0], axis=1)
    return features, generator.random(odds.shape) < 1 / (1 + np.exp(-odds))


@pytest.mark.parametrize("penalty", [0.1, 5.0])
def test_weights_minimise_the_penalised_loss(penalty):
    features, happened = drawn()
    weights = fit_logistic(features, happened, penalty)
    scale = features.std(axis=0)
    for event in range(2):

        def loss(flat, event=event):
            odds = features @ flat[:-1] + flat[-1]
            signs = np.where(happened[:, event], 1.0, -1.0)
            # the penalty is on weights of features of unit variance
            return (
                np.log1p(np.exp(-signs * odds)).sum()
                + penalty / 2 * ((flat[:-1] * scale) ** 2).sum()
            )

        found = minimize(loss, np.zeros(7), method="BFGS", options={"gtol": 1e-7})
        assert loss(weights[:, event]) <= found.fun + 1e-6
        np.testing.assert_allclose(
            weights[:, event] * [*scale, 1], found.x * [*scale, 1], atol=2e-3
        )


def test_probabilities_are_those_of_the_odds():
    weights = np.array([[1.0, 0.0], [2.0, -1.0], [0.5, 3.0]])
    found = event_probability(weights, np.array([[0.2, -0.3]]))
    np.testing.assert_allclose(found, 1 / (1 + np.exp([[-(0.2 - 0.6 + 0.5), -(0.3 + 3.0)]])))


def test_events_that_are_told_apart_stay_finite_and_a_constant_feature_is_no_trouble():
    features, _ = drawn(60)
    features[:, 5] = 4.0
    happened = features[:, :1] > 0
    weights = fit_logistic(features, happened, 1e-3)
    assert np.isfinite(weights).all()
    assert weights[5] == 0
    assert ((event_probability(weights, features) > 0.5) == happened).all()
