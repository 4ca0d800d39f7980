"""Probabilities of training points by classifiers that have not learnt from their series."""

from dataclasses import replace

import numpy as np
import pytest
from sklearn.ensemble import HistGradientBoostingClassifier

from burstcast.forecasters._event_classifier import LabelledPoints
from burstcast.forecasters._options import options_of_kind
from burstcast.forecasters.base import ForecastingCase
from burstcast.forecasters.precursor import LearntPrecursor
from burstcast.probability.out_of_sample_classifiers import out_of_sample_probabilities
from burstcast.systems.lorenz63 import Lorenz63

OPTIONS = options_of_kind("precursor") | {"trees": 20, "lags_lt": [0.2]}
CASE = ForecastingCase(Lorenz63(), 0.01, 1, 10, OPTIONS)


def labelled(series=4, each=150):
    generator = np.random.default_rng(3)
    washouts = generator.normal(size=(series * each, 4, 3))
    chance = generator.random((series * each, 2))
    happened = washouts[:, -1, :2] + washouts[:, 1, 1:] + 0.3 * chance > 1.0
    return LabelledPoints(washouts, happened, np.repeat(np.arange(series), each))


def asked(points):
    """Other points in the same series."""
    generator = np.random.default_rng(4)
    return generator.normal(size=(40, 4, 3)), np.repeat(np.unique(points.series), 10)


def by_hand(points, washouts, left_out):
    """Probabilities of scikit-learn's classifier on features cut by hand."""
    learnt = ~np.isin(points.series, left_out)

    def cut(some):
        return np.hstack([some[:, 3], some[:, 1]])

    columns = []
    for window in range(2):
        classifier = HistGradientBoostingClassifier(
            max_iter=20, max_leaf_nodes=12, learning_rate=0.08, early_stopping=False, random_state=0
        ).fit(cut(points.washouts[learnt]), points.happened[learnt, window])
        columns.append(classifier.predict_proba(cut(washouts))[:, 1])
    return np.stack(columns, axis=1)


@pytest.mark.parametrize(
    ("folds", "parts"),
    [(10, [[0], [1], [2], [3]]), (4, [[0], [1], [2], [3]]), (2, [[0, 2], [1, 3]])],
)
def test_each_fold_is_forecast_by_what_has_learnt_from_the_others(folds, parts):
    points = labelled()
    washouts, series = asked(points)
    found = out_of_sample_probabilities(LearntPrecursor, points, CASE, folds, washouts, series)
    for part in parts:
        here = np.isin(series, part)
        np.testing.assert_array_equal(found[here], by_hand(points, washouts[here], part))


def test_a_series_does_not_teach_its_own_probabilities():
    points = labelled()
    washouts, series = asked(points)
    happened = points.happened.copy()
    happened[points.series == 1] = ~happened[points.series == 1]
    one, other = (
        out_of_sample_probabilities(LearntPrecursor, some, CASE, 4, washouts, series)
        for some in (points, replace(points, happened=happened))
    )
    np.testing.assert_array_equal(one[series == 1], other[series == 1])
    assert not np.array_equal(one[series == 0], other[series == 0])


def test_without_an_event_in_the_other_series_none_is_forecast():
    points = labelled()
    washouts, series = asked(points)
    points.happened[points.series != 2, 1] = False
    found = out_of_sample_probabilities(LearntPrecursor, points, CASE, 4, washouts, series)
    assert (found[series == 2, 1] == 0).all()
    assert (found[series != 2, 1] > 0).all()
    assert (found[:, 0] > 0).all()


def test_one_series_is_too_few():
    points = labelled(series=1)
    with pytest.raises(ValueError, match="two training series and two folds at least, not 1 and 9"):
        out_of_sample_probabilities(LearntPrecursor, points, CASE, 9, *asked(points))
