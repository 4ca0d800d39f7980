"""`burstcast.EventForecaster` with classifiers, and scores for scikit-learn's model selection."""

import dataclasses
import warnings

import numpy as np
import pytest
from numpy.testing import assert_array_equal
from sklearn.metrics import brier_score_loss, log_loss, make_scorer, roc_auc_score
from sklearn.model_selection import cross_val_score
from test_event_forecaster import LYAPUNOV_TIME, SMALL, lorenz

import burstcast
from burstcast.event_forecaster.scoring import EventScorer
from burstcast.forecasters._event_classifier import LabelledPoints
from burstcast.forecasters.base import ForecastingCase
from burstcast.forecasters.registry import make_kind
from burstcast.forecasts.points import observed_points
from burstcast.systems.lorenz63 import Lorenz63

OPTIONS = {
    "precursor": {"classifier": "logistic", "lags_lt": [0.1], "folds": 3},
    "esn_direct": {"neurons": 60, "input_scaling": [1], "penalty": [1], "backend": "scipy"},
}


def settings(kind):
    return {**SMALL, "observable": Lorenz63(), "event_threshold": {"quantile": 0.9}} | {
        "kind": kind,
        "options": OPTIONS[kind],
    }


@pytest.fixture(scope="module")
def training():
    return lorenz(6, 900, 1)


@pytest.fixture(scope="module", params=sorted(OPTIONS))
def fitted(request, training):
    return burstcast.EventForecaster(**settings(request.param)).fit(training)


def test_a_classifier_is_the_librarys(fitted, training, tested):
    """Points .1 Lyapunov times apart, labelled by hand, to the library's own function."""
    system, unit = Lorenz63(), int(LYAPUNOV_TIME / 0.02)
    spans = [(int(t * LYAPUNOV_TIME / 0.02), int((t + 1) * LYAPUNOV_TIME / 0.02)) for t in (0.5, 1)]
    bounds = tuple(sorted({step for span in spans for step in span}))
    value = system.observable(training.transpose(2, 0, 1))
    washout = int(0.5 * LYAPUNOV_TIME / 0.02)
    where = {"spacing": unit // 10, "washout": washout, "boundaries": bounds}
    points = observed_points(training, value, system.observable, **where)
    threshold, rows = np.quantile(value, 0.9), points.points.series
    happened = [
        [
            value[row, now + a] < threshold <= value[row, now + a : now + b + 1].max()
            for a, b in spans
        ]
        for row, now in zip(rows, points.points.step, strict=True)
    ]
    quiet = points.seen.max(axis=1) < threshold
    case = ForecastingCase(system, 0.02, 1, unit, random_seed=0)
    labelled = LabelledPoints(points.washouts[quiet], np.array(happened)[quiet], rows[quiet])
    expected = make_kind(fitted.kind, fitted.options).fit(labelled, case)
    for column, time in enumerate((0.5, 1.0)):
        raw = expected.probabilities(tested[:, 300 - washout : 300])[:, column]
        probabilities = fitted.predict_proba(tested[:, :300], time)[:, 1]
        assert_array_equal(probabilities, fitted.alarms_[time].calibration(raw))
    assert fitted.scores(tested, next(iter(fitted.alarms_)))["roc_area"] > 0.5


def test_probabilities_are_calibrated_by_what_has_not_seen_the_series(fitted, training):
    plain = burstcast.EventForecaster(**settings(fitted.kind), calibrate=False).fit(training)
    raw = plain.predict_proba(training[:, :300], 0.5)[:, 1]
    rule = fitted.alarms_[0.5]
    assert_array_equal(fitted.predict_proba(training[:, :300])[:, 1], rule.calibration(raw))
    assert len(rule.calibration.values) > 100  # a logistic map, not one of shares of votes
    assert (np.diff(rule.calibration.probabilities) >= 0).all()


def test_what_a_classifier_cannot_do_is_said(fitted, training, tested):
    with pytest.raises(ValueError, match="probabilities of events without a trajectory"):
        fitted.forecast(tested)
    with pytest.raises(ValueError, match=f"kind {fitted.kind} do not know the parameters"):
        fitted.predict_proba(tested, parameters=3.0)
    rare = {"event_threshold": float(Lorenz63().observable(training.T).max())}
    for changes, message in (
        ({"options": {"fold": 3}}, r"no option 'fold' \(did you mean 'folds'\?\)"),
        (rare, "a classifier needs both kinds of points"),
    ):
        with pytest.raises(ValueError, match=message):
            burstcast.EventForecaster(**settings(fitted.kind) | changes).fit(training)


# -- scores ----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("scoring", "expected"),
    [
        ("neg_brier_score", lambda y, p: -brier_score_loss(y, p)),
        ("neg_log_loss", lambda y, p: -log_loss(y, np.stack([1 - p, p], axis=1))),
        ("roc_auc", roc_auc_score),
        (make_scorer(roc_auc_score, response_method="predict_proba"), roc_auc_score),
        (lambda y, p: float(p[y].mean() - p[~y].mean()), lambda y, p: p[y].mean() - p[~y].mean()),
    ],
)
def test_scorers_of_scikit_learn_and_own_ones(scoring, expected, fitted, tested):
    happened, probability = fitted.outcomes(tested, 1.0)[:2]
    assert 0 < happened.sum() < len(happened)
    assert EventScorer(scoring, 1.0)(fitted, tested) == pytest.approx(
        expected(happened, probability)
    )


def test_a_score_of_alarms_and_a_score_by_name(fitted, tested):
    happened, probability = fitted.outcomes(tested)[:2]
    alarm = probability >= fitted.alarms_[0.5].threshold
    accuracy = float((alarm == happened).mean())
    assert EventScorer("accuracy")(fitted, tested) == pytest.approx(accuracy)
    for name in ("brier_skill", "alarm_f_score"):
        assert (
            EventScorer(name)(fitted, tested)
            == fitted.scores(tested, next(iter(fitted.alarms_)))[name]
        )


def test_outcomes_are_those_of_the_scores(fitted, tested):
    happened, probability = fitted.outcomes(tested)[:2]
    scores = fitted.scores(tested, next(iter(fitted.alarms_)))
    assert (len(happened), happened.sum()) == (scores["forecasts"], scores["events"])
    assert scores["roc_area"] == pytest.approx(roc_auc_score(happened, probability))


def test_a_plain_scorer_takes_whether_an_event_follows_the_last_sample(training):
    """scikit-learn's own: the targets beside the series."""
    now, (first, last) = 700, (int(t * LYAPUNOV_TIME / 0.02) for t in (0.5, 1.5))
    value = Lorenz63().observable(training.transpose(2, 0, 1))
    ahead = value[:, now + first - 1 : now + last]
    happened = (ahead[:, 0] < 36) & (ahead.max(axis=1) >= 36)
    forecaster = burstcast.EventForecaster(**settings("precursor") | {"event_threshold": 36.0})
    scores = cross_val_score(
        forecaster, training[:, :now], happened, cv=2, scoring="neg_brier_score"
    )
    assert np.isfinite(scores).all()


# -- warnings --------------------------------------------------------------------------------------


def test_a_cross_validation_warns_once():
    noise = np.random.default_rng(0).standard_normal((8, 500, 1))
    forecaster = burstcast.EventForecaster(
        **{**SMALL, "members": 1, "neurons": 30, "event_threshold": 1.25}
    )
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        cross_val_score(forecaster, noise, cv=4)
    (message,) = [str(each.message) for each in caught if "weak forecaster" in str(each.message)]
    assert "prediction time 0.5: " in message
    assert "prediction time 1: votes do not tell the" in message
    assert "no better than chance" in message
    again = forecaster.fit(noise)
    assert len(again.warnings_) >= 2
    assert all(dataclasses.is_dataclass(each) for each in again.members_)
    # another forecaster has a warning of its own
    with pytest.warns(UserWarning, match="weak forecaster"):
        forecaster.set_params(neurons=31).fit(noise)
