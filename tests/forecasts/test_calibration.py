"""Calibrations, logistic readouts and probabilities of points that were not learnt from."""

import json

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from sklearn.calibration import _SigmoidCalibration
from sklearn.ensemble import HistGradientBoostingClassifier
from sklearn.isotonic import IsotonicRegression

from burstcast.forecasters._event_classifier import LabelledPoints
from burstcast.forecasters._logistic_readout import event_probability, fit_logistic
from burstcast.forecasters.analogues import Analogues
from burstcast.forecasters.base import ForecastingCase
from burstcast.forecasters.linear_inverse import LinearInverseModel
from burstcast.forecasters.persistence import Persistence
from burstcast.forecasters.precursor import LearntPrecursor
from burstcast.forecasts import probabilities
from burstcast.forecasts.alarms import UNCALIBRATED, AlarmRule, isotonic, logistic
from burstcast.forecasts.probabilities import out_of_sample_forecasts, out_of_sample_probabilities
from burstcast.forecasts.scores import Outcomes, resampled_scores
from burstcast.forecasts.windows import window_forecasts
from burstcast.systems.lorenz63 import Lorenz63
from burstcast.systems.measured import MeasuredSeries
from helpers_library import count_by_series, samples


@given(
    samples(), st.just(0.0) | st.floats(0, 50), st.lists(st.floats(-1, 2), min_size=1, max_size=20)
)
def test_the_calibration_is_that_of_scikit_learn(sample, prior, asked):
    """A prior counts as forecasts that came true."""
    whole = count_by_series(*sample).total()
    levels = whole.levels
    outcome = np.concatenate([np.ones(len(levels)), np.zeros(len(levels)), levels])
    prior_weights = np.full(len(levels), prior)
    weights = np.concatenate([whole.events, whole.points - whole.events, prior_weights])
    values, asked = np.concatenate([levels] * 3), np.concatenate([levels, asked])
    oracle = IsotonicRegression(out_of_bounds="clip").fit(values, outcome, sample_weight=weights)
    np.testing.assert_allclose(isotonic(whole, prior)(asked), oracle.predict(asked), atol=1e-10)
    np.testing.assert_array_equal(UNCALIBRATED(levels), levels)


def test_what_cannot_be_learnt_from():
    whole = count_by_series(np.array([0.5]), np.array([True]), np.array([0])).total()
    for prior in (-1, np.inf, np.nan):
        with pytest.raises(ValueError, match="0 forecasts or more"):
            isotonic(whole, prior)
    training = np.random.default_rng(0).standard_normal((1, 30, 3))
    with pytest.raises(ValueError, match="two training series"):
        list(LinearInverseModel().fit(training, CASE).leave_one_out(training, CASE, 5))
    points = labelled(series=1)
    with pytest.raises(ValueError, match="two training series and two folds at least, not 1 and 9"):
        out_of_sample_probabilities(precursor(9), points, LABELLED_CASE, *asked(points))


def test_values_that_fall_are_refused_and_unknown_ones_do_not_hide_that():
    whole = Outcomes(np.array([0.0, 0.5, 1.0]), np.array([3, 2, 1]), np.array([1, 1, 1]))
    assert whole.at(np.array([0.2, np.nan, 0.2])).points.tolist() == [4]
    for values in ([0.5, 0.4, 0.6], [0.5, np.nan, 0.4]):
        with pytest.raises(ValueError, match="would change the order"):
            whole.at(np.array(values))


def test_without_any_forecast_no_probability_is_known():
    none = count_by_series(np.zeros(0), np.zeros(0, dtype=bool), np.zeros(0, dtype=int)).total()
    rule = AlarmRule.chosen(none, isotonic(none, 30))
    restored = AlarmRule.restore(json.loads(json.dumps(rule.record())))
    for each in (rule, restored):
        assert np.isnan(each.calibration(np.array([0.0, 0.5, 1.0]))).all()
    # forecasts of the test series then do not count: all scores are undefined
    test = count_by_series(np.array([0.5, 0.7]), np.array([True, False]), np.array([0, 1]))
    scored = test.at(restored.calibration(test.levels))
    assert scored.points.shape[1] == 0
    weights = np.ones((3, len(scored.points)), dtype=np.int64)
    for name, score in resampled_scores(scored, weights, restored.threshold, 11).items():
        assert np.isnan(score.value), name


# -- of probabilities that are all different -------------------------------------------------------
def drawn(slope, points=2000, seed=1):
    """Probabilities whose log-odds are those of the truth, times a slope, plus a half."""
    generator = np.random.default_rng(seed)
    odds = generator.normal(-2.0, 1.5, size=points)
    happened = generator.random(points) < 1 / (1 + np.exp(-odds))
    given = 1 / (1 + np.exp(-(slope * odds + 0.5)))
    return given, happened, np.zeros(points, dtype=int)


@pytest.mark.parametrize("slope", [0.5, 1.0, 3.0])
def test_logistic_calibration_is_that_of_platt(slope):
    given, happened, _ = sample = drawn(slope)
    result = logistic(count_by_series(*sample).total())
    odds = np.log(given) - np.log1p(-given)
    oracle = _SigmoidCalibration().fit(odds, happened.astype(float))
    # between its knots the calibration is linear
    np.testing.assert_allclose(result(given), oracle.predict(odds), atol=5e-4)
    assert (np.diff(result(np.sort(given))) > 0).all()


def test_logistic_calibration_where_nothing_is_told_or_everything():
    given, happened, rows = drawn(1.0, 300)
    reversed_ = count_by_series(1 - given, happened, rows).total()
    np.testing.assert_allclose(logistic(reversed_)(given), happened.mean(), atol=0.01)
    apart = count_by_series(np.where(happened, 0.9, 0.1), happened, rows).total()
    count = int(happened.sum())
    ends = [1 / (302 - count), (count + 1) / (count + 2)]
    np.testing.assert_allclose(logistic(apart)(np.array([0.1, 0.9])), ends, rtol=2e-3)
    none = count_by_series(*(values[:0] for values in (given, happened, rows))).total()
    assert np.isnan(logistic(none)(given)).all()


# -- logistic regression of several events ---------------------------------------------------------


@pytest.mark.parametrize("penalty", [0.1, 5.0])
def test_fewer_points_than_features_have_the_same_minimum(penalty):
    """Doubled points count twice: with as many as features, the fit is in features themselves."""
    generator = np.random.default_rng(7)
    features = generator.normal(size=(60, 100)) @ np.diag(np.geomspace(1, 1e-3, 100)) + 2.0
    features[:, 99] = 4.0  # constant
    happened = generator.random((60, 2)) < 1 / (1 + np.exp(2.0 - 2 * features[:, :2]))
    weights = fit_logistic(features, happened, penalty)
    doubled = [np.concatenate([values, values]) for values in (features, happened)]
    expected = fit_logistic(*doubled, 2 * penalty)
    fresh = generator.normal(size=(500, 100)) * features.std(axis=0) + 2.0
    result = event_probability(weights, fresh)
    assert np.ptp(result) > 0.3
    np.testing.assert_allclose(result, event_probability(expected, fresh), rtol=0, atol=1e-4)


def test_events_that_are_told_apart_stay_finite_and_a_constant_feature_is_no_trouble():
    features = np.random.default_rng(5).normal(size=(60, 6))
    features[:, 5] = 4.0
    happened = features[:, :1] > 0
    weights = fit_logistic(features, happened, 1e-3)
    assert np.isfinite(weights).all()
    assert weights[5] == 0
    assert ((event_probability(weights, features) > 0.5) == happened).all()


def test_rounding_of_features_stays_rounding_of_weights():
    """At the minimum the loss is flat: a rise by rounding halves no step."""
    for seed in range(12):
        generator = np.random.default_rng(seed)
        features, noise = generator.normal(size=(200, 10)), generator.normal(size=(200, 1))
        happened = features[:, :1] + noise > 0.5
        moved = features + 1e-13 * generator.normal(size=features.shape)
        weights, again = (fit_logistic(given, happened, 1.0) for given in (features, moved))
        np.testing.assert_allclose(again, weights, rtol=0, atol=1e-11)


# -- without what the series has taught ------------------------------------------------------------

CASE = ForecastingCase(Lorenz63(), 0.01, 5, 20)
BOUNDARIES = (2, 5, 9)


@pytest.mark.parametrize(
    "kind", [Analogues(neighbours=3), LinearInverseModel()], ids=["members", "single"]
)
def test_each_point_is_forecast_by_what_has_not_seen_its_series(kind):
    """By a single forecast, and by the members of an ensemble."""

    def observable(states):
        return states[0]

    generator = np.random.default_rng(0)
    training = generator.standard_normal((4, 40, 3)).cumsum(axis=1)
    washouts = generator.standard_normal((6, 4, 3))
    series = np.array([2, 0, 3, 2, 0, 3])  # none in series 1, and not in order
    points = observable, washouts, series, BOUNDARIES
    result = out_of_sample_forecasts(kind.fit(training, CASE), training, CASE, 4, *points)
    assert len(result.members) == (3 if kind.provides_ensemble else 1)
    for row in (0, 2, 3):
        anew = kind.fit(np.delete(training, row, axis=0), CASE)
        expected = window_forecasts(anew, observable, washouts[series == row], BOUNDARIES)
        for name, values in vars(expected).items():
            np.testing.assert_array_equal(getattr(result, name)[series == row], values)


LABELLED_CASE = ForecastingCase(Lorenz63(), 0.01, 1, 10)


def precursor(folds):
    return LearntPrecursor(lags_lt=(0.2,), folds=folds)


def labelled(series=4, each=80):
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
    features, asked = (np.hstack([some[:, 3], some[:, 1]]) for some in (points.washouts, washouts))
    size = {"max_iter": 150, "max_leaf_nodes": 12, "learning_rate": 0.08}
    columns = []
    for happened in points.happened[learnt].T:
        classifier = HistGradientBoostingClassifier(**size, early_stopping=False, random_state=0)
        columns.append(classifier.fit(features[learnt], happened).predict_proba(asked)[:, 1])
    return np.stack(columns, axis=1)


@pytest.mark.parametrize(
    ("folds", "parts"),
    [(10, [[0], [1], [2], [3]]), (4, [[0], [1], [2], [3]]), (2, [[0, 2], [1, 3]])],
)
def test_each_fold_is_forecast_by_what_has_learnt_from_the_others(folds, parts):
    points = labelled()
    washouts, series = asked(points)
    result = out_of_sample_probabilities(precursor(folds), points, LABELLED_CASE, washouts, series)
    for part in parts:
        here = np.isin(series, part)
        np.testing.assert_array_equal(result[here], by_hand(points, washouts[here], part))


def test_without_an_event_in_the_other_series_none_is_forecast():
    points = labelled()
    washouts, series = asked(points)
    points.happened[points.series != 2, 1] = False
    result = out_of_sample_probabilities(precursor(4), points, LABELLED_CASE, washouts, series)
    assert (result[series == 2, 1] == 0).all()
    assert (result[series != 2, 1] > 0).all()
    assert (result[:, 0] > 0).all()


# -- announcements ---------------------------------------------------------------------------------


def test_a_calibration_by_an_ensemble_is_announced_if_it_takes_long(monkeypatch):
    """Sixteen of eighty points took a second and a half: all take some seven."""
    clock = iter([10.0, 11.5, 0.0, 0.9])
    monkeypatch.setattr(probabilities.time, "process_time", lambda: next(clock))
    training = np.cumsum(np.random.default_rng(0).normal(size=(3, 90, 2)), axis=1)
    case = ForecastingCase(MeasuredSeries(("x", "y"), "x"), 1.0, 1, 10)
    kind = Analogues(neighbours=6).fit(training, case)
    washouts = np.repeat(training[:1, :4], 80, axis=0)
    arguments = kind, case.system.observable, washouts, (2, 4)
    (text,) = probabilities.announcement(*arguments)
    assert text == (
        "calibration begins: 80 starting points, each forecast by an ensemble of 6 members, take "
        "some 8 s of processor time or less"
    )
    assert list(probabilities.announcement(*arguments)) == []  # of five seconds or less
    single = Persistence().fit(training, case)
    assert list(probabilities.announcement(single, *arguments[1:])) == []
    assert list(probabilities.announcement(kind, arguments[1], washouts[:0], (2, 4))) == []
