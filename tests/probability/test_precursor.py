"""Probabilities straight from what is observed, where the true ones are known."""

from dataclasses import replace

import numpy as np
import pytest

from burstcast.probability.precursor import (
    Precursor,
    PrecursorOptions,
    precursor_features,
)

FAST = PrecursorOptions(trees=60, learning_rate=0.1)


def points(count, seed):
    """Features, true probabilities of two windows, and what happened."""
    generator = np.random.default_rng(seed)
    features = generator.normal(size=(count, 3))
    logits = [2.0 * features[:, 0] - 1.0, features[:, 1] ** 2 - features[:, 2] - 2.0]
    true = 1.0 / (1.0 + np.exp(-np.stack(logits, axis=1)))
    return features, true, generator.random(true.shape) < true


@pytest.mark.parametrize("classifier", ["boosting", "logistic"])
def test_true_probabilities_are_found(classifier):
    features, _, happened = points(20_000, 1)
    fresh, true, _ = points(4_000, 2)
    precursor = Precursor.fit(features, happened, replace(FAST, classifier=classifier))
    error = np.sqrt(np.mean((precursor.probabilities(fresh) - true) ** 2, axis=0))
    assert (error < (0.06 if classifier == "boosting" else 0.02)).all()


def test_linear_features_alone_miss_a_square():
    features, _, happened = points(20_000, 1)
    fresh, true, _ = points(4_000, 2)
    linear = PrecursorOptions("logistic", degree=1)
    error = (Precursor.fit(features, happened, linear).probabilities(fresh) - true).std(axis=0)
    assert error[0] < 0.02 < 0.08 < error[1]


def test_features_are_the_present_and_the_lags():
    washouts = np.arange(24.0).reshape(2, 4, 3)
    found = precursor_features(washouts, (1, 3))
    assert np.array_equal(found[1], [21, 22, 23, 18, 19, 20, 12, 13, 14])
    with pytest.raises(ValueError, match="a lag of 4 steps takes a longer washout than 4"):
        precursor_features(washouts, (4,))


def test_a_precursor_is_restored_to_the_same_bits():
    features, _, happened = points(500, 3)
    for classifier in ("boosting", "logistic"):
        options = replace(FAST, classifier=classifier)
        precursor = Precursor.fit(features, happened, options)
        again = Precursor.restore(precursor.record(), options)
        assert np.array_equal(again.probabilities(features), precursor.probabilities(features))


def test_nothing_to_tell_apart_is_refused():
    features, _, happened = points(100, 5)
    happened[:, 1] = False
    with pytest.raises(ValueError, match=r"none of the 100 .* in prediction window 1"):
        Precursor.fit(features, happened, FAST)
    with pytest.raises(ValueError, match="each of the 100"):
        Precursor.fit(features, ~happened, FAST)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"classifier": "bosting"}, "did you mean 'boosting'"),
        ({"lags": (0,)}, "lags must be"),
        ({"lags": (2, 2)}, "lags must be"),
        ({"degree": 3}, "degree must be 1 or 2"),
        ({"trees": 0}, "trees must be at least 1"),
        ({"leaves": 1}, "leaves must be at least 2"),
        ({"learning_rate": 0.0}, "learning_rate must be positive"),
        ({"penalty": -1.0}, "penalty must be positive"),
    ],
)
def test_options_out_of_bounds(options, message):
    with pytest.raises(ValueError, match=message):
        PrecursorOptions(**options)
