"""Lifetimes of the series of an ensemble, and of those that belong to its training series."""

import numpy as np

from burstcast.statistics.survival import Lifetimes

KEPT = np.array([1, 2, 5, 6, 9])
STEPS = np.array([3, 50, 50, 7, 9, 50, 50, 20, 30, 50, 11])


def of_training(kept, training, steps=STEPS):
    return Lifetimes.of_ensemble(steps, kept, 50).of_training(kept, training)


def test_those_of_training_end_with_its_last_series():
    found = of_training(KEPT, 3)
    assert found.steps.tolist() == [3, 50, 50, 7, 9, 50]
    assert found.escaped.tolist() == [True, False, False, True, True, False]
    assert found.length == 50


def test_nothing_of_later_series_enters():
    later = np.where(np.arange(11) > 5, 1, STEPS)
    np.testing.assert_array_equal(
        of_training(KEPT, 3).steps, of_training(KEPT, 3, steps=later).steps
    )


def test_other_series_of_the_ensemble_may_be_the_first():
    # trained on the fourth and the fifth
    found = of_training(KEPT[[3, 4, 2, 0, 1]], 2)
    assert found.steps.tolist() == [50, 20, 30, 50]
    assert found.escaped.tolist() == [False, True, True, False]
