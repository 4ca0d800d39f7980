"""Washouts that a model can have made, and ensembles that are reliable."""

import warnings

import numpy as np
import pytest
from scipy.signal import lfilter
from test_event_forecaster import lorenz

from burstcast import EventForecaster
from burstcast.event_forecaster.consistency import (
    ConsistencyTest,
    hindcast_errors,
    rank_histogram,
    spread_and_error,
    starts_from_half,
)
from burstcast.forecasters.persistence import Persistence
from helpers_library import MadeUpForecaster

ANGLE = 0.3
TURN = np.array([[np.cos(ANGLE), -np.sin(ANGLE)], [np.sin(ANGLE), np.cos(ANGLE)]])
NOISE = np.array([0.1, 0.2])


class Rotation(MadeUpForecaster):
    """Turns the last state by an angle a step."""

    def start(self, washout):
        return washout[-1]

    def advance(self, memory, steps):
        outputs = []
        for _ in range(steps):
            memory = TURN @ memory
            outputs.append(memory)
        return np.array(outputs), memory


def circles(points, steps, turn=TURN, seed=0):
    state = np.random.default_rng(seed).normal(size=(points, 2))
    washouts = []
    for _ in range(steps):
        state = state @ turn.T
        washouts.append(state)
    return np.stack(washouts, axis=1)


def with_noise(washouts, seed=1, correlation=0.0):
    drawn = np.random.default_rng(seed).normal(size=washouts.shape)
    factor = np.exp(-1 / correlation) if correlation else 0.0
    drawn[:, 1:] *= np.sqrt(1 - factor**2)
    return washouts + NOISE * lfilter([1.0], [1.0, -factor], drawn, axis=1)


@pytest.fixture(scope="module")
def test_of_circles():
    return ConsistencyTest.of(hindcast_errors(Rotation(), with_noise(circles(400, 12), seed=5)))


def share_inconsistent(test, washouts):
    return (test.p_values(Rotation(), washouts) <= 0.05).mean()


def test_hindcasts_continue_the_first_half_of_a_washout():
    washouts = with_noise(circles(3, 7))
    expected = np.empty((3, 4, 2))
    for point, washout in enumerate(washouts):
        for lead in range(4):
            forecast = np.linalg.matrix_power(TURN, lead + 1) @ washout[2]
            expected[point, lead] = forecast - washout[3 + lead]
    np.testing.assert_allclose(hindcast_errors(Rotation(), washouts), expected, atol=1e-12)


def test_a_right_model_raises_false_alarms_as_often_as_is_said(test_of_circles):
    """In 4000 washouts of other states and noise: 0.05, with a standard error of the test's own."""
    washouts = with_noise(circles(4000, 12, seed=7), seed=8)
    p_values = test_of_circles.p_values(Rotation(), washouts)
    assert 0.03 < (p_values <= 0.05).mean() < 0.08
    assert abs(np.median(p_values) - 0.5) < 0.05
    # scatter of the errors at the first lead: of an observation, and of the turned state
    expected = np.sqrt(NOISE**2 + (TURN**2) @ NOISE**2)
    np.testing.assert_allclose(test_of_circles.scale[0], expected, rtol=0.1)


def test_a_model_that_errs_raises_no_more_of_them():
    """Its own error is in the hindcasts, too."""
    flow = np.array([[np.cos(0.35), -np.sin(0.35)], [np.sin(0.35), np.cos(0.35)]])
    reference = with_noise(circles(800, 12, flow, seed=3), seed=4)
    test = ConsistencyTest.of(hindcast_errors(Rotation(), reference))
    own = with_noise(circles(4000, 12, flow, seed=7), seed=8)
    assert 0.03 < share_inconsistent(test, own) < 0.08
    assert share_inconsistent(test, with_noise(circles(500, 12, TURN @ TURN, seed=9))) > 0.6


@pytest.mark.parametrize("way", ["another flow", "another gain", "coloured noise", "more noise"])
def test_what_the_model_cannot_have_made_is_found(test_of_circles, way):
    truth = circles(500, 12, seed=9)
    washouts = {
        "another flow": with_noise(circles(500, 12, TURN @ TURN, seed=9)),
        "another gain": with_noise(truth) * [1.0, 2.5],
        "coloured noise": with_noise(truth, correlation=30.0),
        "more noise": truth + 3 * (with_noise(truth) - truth),
    }[way]
    assert share_inconsistent(test_of_circles, washouts) > 0.6


def test_lost_hindcasts_are_inconsistent_and_short_washouts_have_no_test(test_of_circles):
    washouts = with_noise(circles(2, 12))
    washouts[1, 5] = np.inf
    p_values = test_of_circles.p_values(Rotation(), washouts)
    assert p_values[0] > 0
    assert p_values[1] == 0.0
    assert ConsistencyTest.of(hindcast_errors(Rotation(), circles(20, 12))) is None
    assert ConsistencyTest.of(np.zeros((90, 6, 2))) is None  # an exact model without noise
    again = ConsistencyTest.restore(test_of_circles.record())
    np.testing.assert_array_equal(again.p_values(Rotation(), washouts), p_values)
    with pytest.raises(ValueError, match="none"):
        ConsistencyTest.restore({**test_of_circles.record(), "centre": [0.0]})


class NeedsEight(Rotation):
    """Takes eight observations to start, as filters and past values do."""

    def start(self, washout):
        if len(washout) < 8:
            raise ValueError("too short")
        return super().start(washout)


@pytest.mark.parametrize(("steps", "has_one"), [(5, False), (12, False), (16, True)])
def test_kinds_that_need_more_than_half_of_a_washout_have_no_test(steps, has_one):
    series = with_noise(circles(8, 200))
    washouts, rows = series[:, :steps], np.arange(8)
    assert starts_from_half(NeedsEight(), washouts) is has_one
    assert starts_from_half(Rotation(), washouts) is (steps > 5)
    if not has_one:
        assert ConsistencyTest.left_out(NeedsEight(), series, None, washouts, rows) is None


def test_a_reliable_ensemble_has_a_level_histogram_and_a_spread_like_its_error():
    drawn = np.random.default_rng(2).normal(size=(10, 20_000))
    members, truth = drawn[:9], drawn[9]
    counts = rank_histogram(members, truth)
    np.testing.assert_allclose(counts / 2000, 1.0, atol=0.1)
    spread, error = spread_and_error(members, truth)
    assert spread == pytest.approx(error, rel=0.02)
    assert error == pytest.approx(np.sqrt(10 / 9), rel=0.02)
    # too narrow: the truth lies outside too often
    counts = rank_histogram(0.3 * members, truth)
    assert counts[0] + counts[-1] > 10_000
    spread, error = spread_and_error(0.3 * members, truth)
    assert spread < 0.4 * error
    members[0, :10_000] = np.nan
    assert rank_histogram(members, truth).sum() == 10_000
    assert np.isnan(spread_and_error(members[:1], truth)).all()


@pytest.mark.parametrize(
    ("kind", "changes"),
    [("esn", {"neurons": 40, "members": 1, "searches": 1}), ("analogues", {}), ("nvar", {})],
)
def test_the_rate_of_false_alarms_holds_for_imperfect_kinds(kind, changes):
    """A small network errs by much; analogues would find their own training series."""
    generator = np.random.default_rng(3)
    series = lorenz(16, 900, 1)
    series = series + 0.01 * series.std(axis=(0, 1)) * generator.normal(size=series.shape)
    forecaster = EventForecaster(
        *(2, 40.0),
        kind=kind,
        **{"lyapunov_time": 1.1, "sampling_interval": 0.02, "washout": 0.5, "calibrate": False},
        **{"prediction_times": (0.5,), "start_spacing": 0.25, **changes},
    )
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        table = forecaster.fit(series[:8]).scores_by_consistency(series[8:])
        # a third less of the flow
        wrong = forecaster.scores_by_consistency(0.7 * series[8:])
    assert table["inconsistent"]["share"] < 0.11
    assert wrong["inconsistent"]["share"] > 0.5


def test_an_event_forecaster_knows_inconsistent_washouts(tmp_path):
    """Of Lorenz's flow: its own series, and the same with another gain."""
    generator = np.random.default_rng(3)

    def noisy(series):
        return series + 0.01 * series.std(axis=(0, 1)) * generator.normal(size=series.shape)

    training, tested = noisy(lorenz(8, 900, 1)), noisy(lorenz(8, 900, 2))
    settings = {"lyapunov_time": 1.1, "sampling_interval": 0.02, "washout": 0.5}
    forecaster = EventForecaster(
        2, 40.0, kind="quadratic_filtered", prediction_times=(0.5,), **settings
    ).fit(training)
    table = forecaster.scores_by_consistency(tested)
    assert table["inconsistent"]["share"] < 0.15
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        total = forecaster.scores(tested)
        forecaster.predict_proba(tested)
        forecaster.predict_proba(0.8 * tested[:1])  # one washout may be odd by chance
    assert sum(part["forecasts"] for part in table.values()) == total["forecasts"]
    assert sum(part["events"] for part in table.values()) == total["events"]
    assert sum(part["share"] for part in table.values()) == pytest.approx(1.0)
    with (
        pytest.warns(UserWarning, match="no event follows any of the"),
        pytest.warns(UserWarning, match="washouts are unlike those of the training series"),
    ):
        forecaster.scores(0.8 * tested)
    with pytest.warns(UserWarning, match="washouts are unlike those of the training series"):
        forecaster.predict_proba(0.8 * tested)
    wrong = forecaster.scores_by_consistency(0.8 * tested)
    assert wrong["inconsistent"]["share"] > 0.8
    seen = tested[:, :400]
    assert forecaster.consistent(seen).mean() >= 0.7
    assert forecaster.consistent(0.8 * seen).mean() < 0.3
    forecaster.save(path := tmp_path / "saved.nc")
    again = EventForecaster.load(path)
    np.testing.assert_array_equal(again.consistent(seen), forecaster.consistent(seen))
    scores = forecaster.ensemble_scores(tested)
    assert scores["rank_histogram"].sum() >= total["forecasts"]  # events under way count, too
    assert scores["rank_histogram"].shape == (41,)
    assert 0.2 < scores["spread"] / scores["error"] < 5
    alone = EventForecaster(
        2, 40.0, kind=Persistence(), prediction_times=(0.5,), calibrate=False, **settings
    ).fit(training)
    with pytest.raises(ValueError, match="single forecast has no spread"):
        alone.ensemble_scores(tested)
    classifier = EventForecaster(
        2, 40.0, kind="precursor", prediction_times=(0.5,), calibrate=False, **settings
    ).fit(training)
    with pytest.raises(ValueError, match="no test of consistency"):
        classifier.consistent(seen)
