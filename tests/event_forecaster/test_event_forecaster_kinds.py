"""`EventForecaster` with a kind by its name, as a class or as an object, of burstcast or not."""

import dataclasses
import importlib
import sys
from dataclasses import dataclass

import numpy as np
import pytest
import sklearn.base
from numpy.testing import assert_array_equal
from sklearn.model_selection import GridSearchCV, cross_val_score
from test_event_forecaster import SMALL

from burstcast import EventForecaster
from burstcast.data.starting_points import SeriesPoints
from burstcast.event_forecaster.causes import better_window, causes
from burstcast.event_forecaster.components import Components
from burstcast.event_forecaster.events import EventTiming
from burstcast.event_forecaster.scoring import EventScorer
from burstcast.forecasters.base import Forecaster, ForecastingCase, fitted
from burstcast.forecasters.nvar import NVAR
from burstcast.forecasters.quadratic import QuadraticModel
from burstcast.systems.measured import MeasuredSeries

# what extrapolates or persists forecasts events no better than chance
pytestmark = pytest.mark.filterwarnings("ignore:signs of a weak forecaster")

PLAIN = {**SMALL, "options": None}
OWN = """
from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from burstcast.forecasters.base import Forecaster, fitted


@dataclass(frozen=True)
class Extrapolated(Forecaster):
    '''The polynomial through the last samples, within the bounds of the training series.'''

    degree: int = 2
    names: tuple[str, ...] = ("x",)
    low: np.ndarray = fitted()
    high: np.ndarray = fitted()
    samples: int = fitted()
    spread: float = fitted()
    origin: str = fitted()

    def fit(self, training, case):
        low, high = training.min(axis=(0, 1)), training.max(axis=(0, 1))
        others = {"samples": training.shape[1], "spread": training.std(), "origin": "noisy series"}
        return self.with_fitted(low=low, high=high, **others)

    def start(self, washout):
        return np.ascontiguousarray(washout[-self.degree - 1 :])

    def advance(self, memory, steps):
        outputs = []
        for _ in range(steps):
            differences = [np.diff(memory, n, axis=0)[-1] for n in range(self.degree + 1)]
            bounds = self.low[:, np.newaxis], self.high[:, np.newaxis]
            outputs.append(np.clip(sum(differences), *bounds))
            memory = np.concatenate([memory[1:], outputs[-1:]])
        return np.array(outputs), memory


class Other(Extrapolated):
    pass
"""


@pytest.fixture
def own_module(tmp_path, monkeypatch):
    """A module of one's own."""
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setattr(sys, "dont_write_bytecode", True)
    (tmp_path / "own_extrapolation.py").write_text(OWN)
    yield importlib.import_module("own_extrapolation")
    sys.modules.pop("own_extrapolation")


def test_a_name_a_class_and_an_object_are_the_same_forecaster(training, tested, tmp_path):
    ways = [
        {"kind": NVAR(lags=3, ridge=1e-4)},
        {"kind": NVAR, "options": {"lags": 3, "ridge": 1e-4}},
        {"kind": "nvar", "options": {"lags": 3, "ridge": 1e-4}},
    ]
    fitted = [EventForecaster(**{**PLAIN, **way}).fit(training) for way in ways]
    assert fitted[0].kind == NVAR(lags=3, ridge=1e-4)  # it is not the object that is fitted
    (member,) = fitted[0].members_
    alone = NVAR(lags=3, ridge=1e-4).fit(
        np.ascontiguousarray(training), fitted[0]._case(Components(3))
    )
    assert_array_equal(member.weights, alone.weights)
    expected = fitted[0].predict_proba(tested[:, :300])
    scores = fitted[0].scores(tested)
    first, *_ = fitted[0].alarms_
    assert list(scores) == list(fitted[0].alarms_)
    assert scores[first]["roc_area"] > 0.6
    assert scores[first] == fitted[0].scores(tested, first)
    for forecaster in fitted:
        assert_array_equal(forecaster.predict_proba(tested[:, :300]), expected)
        assert forecaster.scores(tested) == scores
        forecaster.save(path := tmp_path / "saved.nc")
        loaded = EventForecaster.load(path)
        assert (loaded.kind, loaded.options) == ("nvar", {"lags": 3, "ridge": 1e-4})
        assert_array_equal(loaded.predict_proba(tested[:, :300]), expected)
    default = EventForecaster(**PLAIN, kind=NVAR).fit(training)
    assert not np.array_equal(default.forecast(tested), fitted[0].forecast(tested))


def test_scikit_learn_clones_scores_and_searches_objects(training):
    forecaster = EventForecaster(**PLAIN, kind=NVAR(lags=3))
    copy = sklearn.base.clone(forecaster)
    assert copy.get_params() == forecaster.get_params()
    assert repr(copy).count("NVAR(lags=3, ridge=1e-06)") == 1
    scorer = EventScorer("neg_brier_score")
    scores = cross_val_score(forecaster, training, cv=2, scoring=scorer, error_score="raise")
    for rows, score in zip(([0, 1], [2, 3]), scores, strict=True):
        by_hand = EventForecaster(**PLAIN, kind=NVAR(lags=3)).fit(np.delete(training, rows, axis=0))
        assert score == scorer(by_hand, training[rows])
    kinds = [NVAR(lags=1, ridge=1e9), NVAR(lags=3), "persistence"]
    search = GridSearchCV(forecaster, {"kind": kinds}, cv=2, scoring=scorer, error_score="raise")
    search.fit(training)
    assert search.best_params_ == {"kind": NVAR(lags=3)}
    assert search.cv_results_["split0_test_score"][1] == scores[0]


def test_a_class_of_ones_own_is_saved_without_its_code(own_module, training, tested, tmp_path):
    path, seen = tmp_path / "own.nc", tested[:, :300]
    kind = own_module.Extrapolated(degree=3, names=("x", "z"))
    fitted = EventForecaster(**PLAIN, kind=kind).fit(training)
    expected = fitted.forecast(seen)
    last = seen[:, -4:].transpose(1, 0, 2)
    cubic = 4 * last[3] - 6 * last[2] + 4 * last[1] - last[0]
    clipped = np.clip(cubic, training.min(axis=(0, 1)), training.max(axis=(0, 1)))
    np.testing.assert_allclose(expected[0, :, 0], clipped, rtol=1e-12)
    by_name = {"kind": "own_extrapolation:Extrapolated", "options": {"degree": 3}}
    assert_array_equal(
        EventForecaster(**{**PLAIN, **by_name}).fit(training).forecast(seen), expected
    )
    # the default record holds arrays, numbers and texts
    record = fitted.members_[0].record()
    spread = pytest.approx(training.std())
    numbers = {"samples": 900, "spread": spread, "origin": "noisy series"}
    assert (record.arrays.keys(), record.attributes) == ({"low", "high"}, numbers)
    assert [type(record.attributes[name]) for name in numbers] == [int, float, str]
    for content in ([1.0, 2.0], {"a": 1.0}, kind):
        message = rf"Extrapolated.origin is {type(content).__name__}, .* or define record and resto"
        with pytest.raises(TypeError, match=message):
            dataclasses.replace(fitted.members_[0], origin=content).record()
    fitted.save(path)
    loaded = EventForecaster.load(path, kind=own_module.Extrapolated)
    assert {name: getattr(loaded.members_[0], name) for name in numbers} == numbers
    assert loaded.options == {"degree": 3, "names": ["x", "z"]}
    assert loaded._kind == kind
    assert_array_equal(loaded.forecast(seen), expected)
    assert_array_equal(loaded.predict_proba(seen), fitted.predict_proba(seen))
    loaded.save(tmp_path / "again.nc")
    assert (tmp_path / "again.nc").read_bytes() == path.read_bytes()
    for same in ("own_extrapolation:Extrapolated", kind):
        assert EventForecaster.load(path, kind=same)._kind == kind
    # the module is not imported on the word of a file
    message = r"own_extrapolation:Extrapolated, which the file has not: give it as load\(path, kind"
    with pytest.raises(ValueError, match=message):
        EventForecaster.load(path)
    message = "is a own_extrapolation:Extrapolated, not a "
    for other in (own_module.Other, NVAR, dict):
        with pytest.raises(ValueError, match=message):
            EventForecaster.load(path, kind=other)


# -- forecasts that are none, and why --------------------------------------------------------------


def roessler(count, samples, interval, substeps=8):
    """Series of Roessler's flow, ``(count, samples, 3)``: events are short spikes of z."""

    def rate(state):
        x, y, z = state
        return np.array([-y - z, x + 0.2 * y, 0.2 + z * (x - 5.7)])

    state, step = np.random.default_rng(2).normal(size=(3, count)), interval / substeps
    series = []
    for number in range(300 + samples):
        for _ in range(substeps):
            first = rate(state)
            second = rate(state + step / 2 * first)
            third = rate(state + step / 2 * second)
            fourth = rate(state + step * third)
            state = state + step / 6 * (first + 2 * second + 2 * third + fourth)
        if number >= 300:
            series.append(state)
    return np.stack(series).transpose(2, 0, 1)


def of_roessler(kind, interval, **changes):
    settings = {"observable": 2, "lyapunov_time": 5.9, "sampling_interval": interval, **changes}
    return EventForecaster(kind=kind, **settings)


def test_equations_are_learnt_from_spikes_and_what_cannot_be_names_the_sampling():
    """The root mean square of differences takes the spikes for noise of 6 %: no skill, no word."""
    series = roessler(12, 800, 0.2)
    learnt = of_roessler("quadratic", 0.2).fit(series[:8])
    scores = learnt.scores(series[8:])
    assert learnt.warnings_ == []
    assert scores["roc_area"] > 0.95
    assert scores["invalid_fraction"] == 0.0
    with pytest.warns(UserWarning, match="likely cause"):
        wrong = of_roessler("nvar", 0.2, options={"ridge": 1e-9}).fit(series[:8])
    scores, text = wrong.scores(series[8:]), " ".join(wrong.warnings_)
    assert scores["invalid_fraction"] > 0.3
    assert "of the forecasts of series that were left out are invalid" in text
    assert "sampling is coarse for the spikes of component 2" in text


def test_a_window_of_one_interval_and_an_unlearnable_step_are_causes():
    series = roessler(8, 500, 0.5)
    with pytest.warns(UserWarning, match="likely causes"):
        wrong = of_roessler("quadratic", 0.5, window=0.3, prediction_times=(1.0,)).fit(series)
    text = " ".join(wrong.warnings_)
    assert "windows of 2 sampling intervals (option window_lt, 0.2)" in text
    assert "one sample ahead its forecast of component" in text
    assert "the prediction window has 4 samples" in text


def test_components_that_turn_within_a_few_samples_are_a_cause():
    """A sine of few samples and one of forty, with noise; a map has no turns.

    Of 2.5 samples, the sine looks like noise, whose estimate must not hide it.
    """
    time = np.arange(400) + np.arange(3)[:, np.newaxis]
    series = np.stack([np.sin(2 * np.pi * time / period) for period in (2.5, 40.0)], axis=-1)
    words = list(
        causes(
            NVAR(),
            EventTiming(40.0, 1.0, (1.0,), 10.0),
            series,
            ("fast", "slow"),
            washout=9,
            events=50,
        )
    )
    assert any("samples in a turn of the trajectory: fast 2.6;" in text for text in words)
    series = np.stack([np.sin(2 * np.pi * time / period) for period in (5.0, 40.0)], axis=-1)
    series = series + 0.02 * np.random.default_rng(0).normal(size=series.shape)
    for unit, told in ((40.0, True), (1.0, False)):
        timing = EventTiming(unit, 1.0, (1.0,), 10.0)
        words = list(causes(NVAR(), timing, series, ("fast", "slow"), washout=9, events=50))
        assert any("samples in a turn of the trajectory: fast 5;" in text for text in words) == told
        assert not any("slow" in text for text in words)


@pytest.mark.parametrize(("noise", "told"), [(None, True), (0.01, False)])
def test_a_sampling_that_hides_the_noise_is_a_cause_where_the_noise_is_estimated(noise, told):
    sine = np.sin(2 * np.pi * np.arange(600.0) / 5)[np.newaxis, :, np.newaxis]
    timing = EventTiming(40.0, 1.0, (1.0,), 10.0)
    words = causes(QuadraticModel(noise=noise), timing, sine, ("u",), washout=9, events=50)
    assert any("too coarse to tell the noise" in text for text in words) == told


def test_a_better_window_of_the_regression_is_named():
    """Who follows the words has a smaller error in series that nobody has learnt from."""
    series = roessler(12, 500, 0.2)
    case = ForecastingCase(MeasuredSeries(("x", "y", "z"), "x"), 0.2, 1, 30)
    series = series + 0.02 * series.std(axis=(0, 1)) * np.random.default_rng(1).normal(
        size=series.shape
    )
    points = SeriesPoints(np.repeat(np.arange(8), 20), np.tile(np.arange(20, 460, 22), 8))
    short = QuadraticModel(window_lt=0.07)
    (text,) = better_window(short, case, series[:8], points)
    assert "windows of 8 sampling intervals" in text
    assert "of those over 2: try options={'window_lt': 0.267}" in text
    errors = []
    for model in (short, QuadraticModel(window_lt=0.267)):
        fitted = model.fit(series[:8], case)
        forecast, _ = fitted.advance(fitted.start(series[8:, 100:101].transpose(1, 2, 0)), 30)
        errors.append(np.square(forecast - series[8:, 101:131].transpose(1, 2, 0)).mean())
    assert errors[1] < 0.7 * errors[0]
    assert list(better_window(QuadraticModel(window_lt=0.267), case, series[:8], points)) == []


def test_windows_are_judged_by_series_that_their_equations_have_not_seen(monkeypatch):
    learnt, shared = [], []
    fit, start = QuadraticModel.fit, QuadraticModel.start

    def noted_fit(self, training, case):
        learnt.append({*training.ravel().tolist()})
        return fit(self, training, case)

    def noted_start(self, washout):
        shared.append(learnt[-1] & {*washout.ravel().tolist()})
        return start(self, washout)

    monkeypatch.setattr(QuadraticModel, "fit", noted_fit)
    monkeypatch.setattr(QuadraticModel, "start", noted_start)
    case = ForecastingCase(MeasuredSeries(("x", "y", "z"), "x"), 0.2, 1, 30)
    points = SeriesPoints(np.repeat(np.arange(4), 5), np.tile(np.arange(20, 120, 22), 4))
    [*better_window(QuadraticModel(window_lt=0.267), case, roessler(4, 200, 0.2), points)]
    assert (len(learnt), len(shared)) == (8, 8)  # of each half, for four windows
    assert not any(shared)


@dataclass(frozen=True)
class Fickle(Forecaster):
    """Persistence, unless it has learnt from eight series."""

    growth: np.ndarray = fitted()

    def fit(self, training, case):
        return self.with_fitted(growth=np.array([1.0 if len(training) < 8 else 3.0]))

    def start(self, washout):
        return np.abs(washout[-1]) + 1.0

    def advance(self, memory, steps):
        outputs = memory * self.growth ** np.arange(1, steps + 1)[:, np.newaxis, np.newaxis]
        return outputs, outputs[-1]


def test_the_model_that_is_kept_is_judged_not_its_refits_alone(training):
    series = np.concatenate([training, training[:, ::-1]])
    with pytest.warns(UserWarning, match="kept models"):
        forecaster = EventForecaster(**{**PLAIN, "kind": Fickle()}).fit(series)
    text = " ".join(forecaster.warnings_)
    assert "100.0% of the forecasts of the kept models in training series are invalid" in text
    assert "left out are invalid" not in text


def test_where_nothing_is_to_be_seen_no_cause_is_made_up():
    noise = np.random.default_rng(5).normal(size=(6, 400, 2))
    settings = {"window": 20.0, "washout": 10.0, "prediction_times": (30.0,)}
    with pytest.warns(UserWarning, match="no cause is seen"):
        forecaster = EventForecaster(0, {"quantile": 0.9}, kind="analogues", **settings).fit(noise)
    assert forecaster.unskilled_times_ == [30.0]
