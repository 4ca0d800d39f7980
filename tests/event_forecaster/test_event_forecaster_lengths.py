"""`EventForecaster` with series of unequal lengths, and with records in samples."""

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from test_event_forecaster import SMALL, lorenz
from test_event_forecaster_units import OPTIONS, RHO

from burstcast import EventForecaster
from burstcast.base.resampling import loss_interval
from burstcast.data.dataset import component_scales
from burstcast.data.observation_noise import estimate_noise
from burstcast.data.series_layout import labelled_series
from burstcast.event_forecaster.score_intervals import _one_more, score_intervals
from burstcast.forecasters.analogues import Analogues
from burstcast.forecasters.base import ForecastingCase
from burstcast.forecasters.linear_inverse import LinearInverseModel
from burstcast.forecasters.nvar import NVAR
from burstcast.forecasters.registry import all_kinds, kind_class
from burstcast.forecasts.scores import Outcomes
from burstcast.networks.dynamics import Dynamics
from burstcast.networks.readout import Moments
from burstcast.networks.reservoir import make_reservoir
from burstcast.networks.training import TrainingSeries, collect
from burstcast.systems.lorenz63 import Lorenz63
from burstcast.systems.polynomials.regression import factored_coefficients

pytestmark = pytest.mark.filterwarnings("ignore:signs of a weak forecaster")

LENGTHS = (700, 900, 150, 500, 60, 900)
KINDS = all_kinds()


def cut(series, lengths=LENGTHS):
    return [states[:length] for states, length in zip(series, lengths, strict=False)]


@pytest.fixture(scope="module")
def training():
    return cut(lorenz(6, 900, 1))


@pytest.fixture(scope="module")
def padded_series(training):
    return labelled_series(training).states


def test_analogues_of_equal_series_forget_the_lengths_of_an_earlier_fit():
    """Calibration leaves out the one series of another length."""
    series = cut(lorenz(4, 400, 1), (150, 400, 400, 400))
    case = ForecastingCase(Lorenz63(), 0.01, 2, 55)
    again = Analogues().fit(labelled_series(series).states, case)
    again = again.fit(np.stack(series[1:]), case)
    expected = Analogues().fit(np.stack(series[1:]), case)
    washout = np.stack(series[1:])[:, 50:60].transpose(1, 2, 0)
    assert_array_equal(again.start(washout), expected.start(washout))
    assert again.lengths is None


def test_a_lyapunov_time_of_one_sample_has_default_spacings_of_one():
    given = {"observable": 2, "event_threshold": 35.0, "kind": "analogues", "washout": 5}
    made = [
        EventForecaster(**given, **more).fit(lorenz(6, 400, 1))
        for more in ({"lyapunov_time": 1, "window": 1}, {"window": 1})
    ]
    assert_array_equal(*(each.predict_proba(lorenz(2, 100, 3)) for each in made))


# -- functions that series are given to ------------------------------------------------------------


def test_scales_and_noise_are_of_all_samples(training, padded_series):
    samples = np.concatenate(training)
    assert_array_equal(component_scales(padded_series).range, np.ptp(samples, axis=0))
    deviation = component_scales(padded_series).standard_deviation
    assert_allclose(deviation, samples.std(axis=0), rtol=1e-12)
    noisy = padded_series + np.random.default_rng(1).normal(size=padded_series.shape)
    whole = [states[~np.isnan(states[:, 0])] for states in noisy]
    differences = np.concatenate([np.diff(states, 8, axis=0) for states in whole])
    assert_allclose(
        estimate_noise(noisy), np.sqrt((differences**2).mean(axis=0) / 12870), rtol=1e-12
    )


def test_moments_of_a_network_are_the_sums_of_those_of_its_series(training, padded_series):
    dynamics = Dynamics(make_reservoir(30, 3, 5, 1.0, np.random.default_rng(0)), 0.5, 1.0)
    scale, offset = np.array([40.0, 50.0, 45.0]), np.array([0.0, 1.0, 23.0])
    whole = collect(
        dynamics, TrainingSeries(padded_series, scale, input_offset=offset), washout=70
    ).moments
    longer = [states for states in training if len(states) > 71]
    parts = [TrainingSeries(states[np.newaxis], scale, input_offset=offset) for states in longer]
    total = collect(dynamics, parts[0], washout=70).moments
    for part in parts[1:]:
        total = Moments.merge(total, collect(dynamics, part, washout=70).moments)
    for name, value in vars(total).items():
        assert_allclose(vars(whole)[name], value, rtol=1e-9, atol=1e-9)


def test_maps_are_fitted_to_steps_within_series(training, padded_series):
    now = np.concatenate([states[:-1] for states in training])
    following = np.concatenate([states[1:] for states in training])
    weights = np.linalg.lstsq(np.column_stack([now, np.ones(len(now))]), following)[0]
    model = LinearInverseModel().fit(padded_series, None)
    assert_allclose(model.propagator, weights[:3].T, rtol=1e-9)
    vector = NVAR(lags=1, ridge=1e-9).fit(padded_series, None)
    outputs, _ = vector.advance(vector.start(now.T[np.newaxis]), 1)
    assert np.sqrt(np.mean((outputs[0].T - following) ** 2)) < 0.2
    assert_allclose(vector.mean, np.concatenate(training).mean(axis=0), rtol=1e-12)


def test_analogues_end_with_their_own_series(training, padded_series):
    model = Analogues(neighbours=1).fit(padded_series, None)
    for states in (training[0], training[4]):
        outputs, _ = model.advance(model.start(states[-3:-2].T[np.newaxis]), 3)
        assert_array_equal(outputs[:2, :, 0], states[-2:])
        assert np.isnan(outputs[2]).all()
    again = Analogues(neighbours=1).restore(model.record(), None)
    assert_array_equal(
        again.start(training[2][:5].T[np.newaxis]), model.start(training[2][:5].T[None])
    )


def test_equations_are_learnt_from_windows_within_series(training, padded_series):
    settings = {"noise": np.zeros(3), "interval": 0.02, "degree": 2, "window": 10}
    coefficients = factored_coefficients(padded_series, **settings, significance=4)[0]
    # those of the system, in the order 1, x, y, z, xx, xy, xz, yy, yz, zz
    expected = np.zeros((10, 3))
    expected[1, :2], expected[2, :2], expected[3, 2] = (-10, 28), (10, -1), -8 / 3
    expected[6, 1], expected[5, 2] = -1, 1
    assert_allclose(coefficients, expected, atol=0.02)


# -- forecasters -----------------------------------------------------------------------------------


def unfitted(kind, **changes):
    settings = {**SMALL, "prediction_times": (0.5,), "members": 2, "sampling_stride": 2}
    settings |= {"observable": Lorenz63() if kind_class(kind).needs_equations else 0}
    settings |= {"event_threshold": {"quantile": 0.9}, "options": OPTIONS.get(kind)}
    return EventForecaster(**{**settings, **changes}, kind=kind)


@pytest.mark.parametrize("kind", KINDS)
def test_every_kind_takes_series_of_unequal_lengths(kind, training, tmp_path):
    learns = kind_class(kind).learns_parameters
    forecaster = unfitted(kind).fit(training, parameters=RHO if learns else None)
    assert any(
        "1 of 6 series have no starting point" in warning for warning in forecaster.warnings_
    )
    assert len(repr(forecaster.members_[0])) < 300  # a notebook shows it
    lengths = (700, 800, 300, 45)
    tested = cut(lorenz(4, 800, 2), lengths)
    expected = [forecaster.predict_proba(states[np.newaxis])[0] for states in tested]
    # products of matrices sum in an order that depends on the batch
    assert_allclose(forecaster.predict_proba(tested), expected, rtol=1e-12)
    with pytest.warns(UserWarning, match="1 of 4 series have no starting point"):
        scores = forecaster.scores(tested)
    with pytest.warns(UserWarning, match="1 of 4 series"):
        outcomes = forecaster.outcomes(tested)
    assert {0, 1} <= set(outcomes.series) <= {0, 1, 2}
    alone = [forecaster.outcomes(states[np.newaxis]) for states in tested[:3]]
    for name in ("happened", "probability", "time"):
        parts = [getattr(outcomes, name) for outcomes in alone]
        assert_allclose(getattr(outcomes, name), np.concatenate(parts), rtol=1e-12)
    assert scores["forecasts"] == len(outcomes.happened) > 4
    forecaster.save(tmp_path / "forecaster.nc")
    loaded = EventForecaster.load(tmp_path / "forecaster.nc")
    assert_array_equal(loaded.predict_proba(tested), forecaster.predict_proba(tested))


def test_networks_are_validated_on_the_longest_series(training):
    forecaster = unfitted("esn", calibrate=False).fit(training)
    in_order = sorted(training, key=len, reverse=True)
    again = unfitted("esn", calibrate=False).fit(in_order)
    for chosen, other in zip(forecaster.hyperparameters_, again.hyperparameters_, strict=True):
        assert chosen == pytest.approx(other, rel=1e-2)
    message = "validation_series is 6, but only 5 series have a washout of 27 samples and valid"
    with pytest.raises(ValueError, match=message):
        unfitted("esn", validation_series=6).fit(training)


# -- records in samples ----------------------------------------------------------------------------


@pytest.fixture(scope="module")
def yearly():
    """A short record with cycles of some eleven samples."""
    generator, phase = np.random.default_rng(0), 0.0
    phases = [phase := phase + generator.normal(0.57, 0.07) for _ in range(309)]
    heights = 60 + 20 * np.sin(np.array(phases) / 7)
    noise = generator.normal(scale=4, size=309)
    return np.abs(heights * (1 + np.sin(phases)) + noise)[np.newaxis, :, np.newaxis]


@pytest.mark.parametrize("kind", [kind for kind in KINDS if not kind_class(kind).needs_equations])
def test_every_kind_runs_on_a_short_record_in_samples(kind, yearly):
    if kind_class(kind).learns_parameters:
        pytest.skip("one series has one value of the parameters")
    few = {"members": 2, "neurons": 50, "grid": 2, "bayesian_points": 0}
    few |= {"options": {"neurons": 50}} if kind == "esn_direct" else {}
    if kind == "quadratic_hidden":
        few |= {"options": {"hidden": 1, "rates_per_lt": (0.2, 0.4), "rounds": 1}}
    forecaster = EventForecaster(kind=kind, event_threshold={"quantile": 0.9}, **few)
    scores = forecaster.fit(yearly[:, :220]).scores(yearly[:, 220:])
    assert scores["forecasts"] > 20
    assert 0 < scores["events"] < scores["forecasts"]
    events = scores["events"] / scores["forecasts"]
    assert scores["permanent_f_score"] == pytest.approx(2 * events / (1 + events))


def test_a_forecaster_given_as_an_object_has_durations_in_samples_too(yearly):
    from burstcast.forecasters.precursor import LearntPrecursor

    kind = LearntPrecursor(classifier="logistic")
    (member,) = EventForecaster(kind=kind).fit(yearly).members_
    assert (member.lags_lt, member.start_spacing_lt) == ((1, 2, 3, 4), 1)
    kind = LearntPrecursor(classifier="logistic", lags_lt=(2,))
    (member,) = EventForecaster(kind=kind).fit(yearly).members_
    assert member.lags_lt == (2,)


def test_a_single_series_is_calibrated_in_five_parts(yearly):
    forecaster = EventForecaster(kind="nvar").fit(yearly)
    by_hand = EventForecaster(kind="nvar").fit(np.array_split(yearly[0], 5))
    assert forecaster.alarms_[1.0].record() == by_hand.alarms_[1.0].record()


# -- signs of weakness -----------------------------------------------------------------------------


def findings(forecaster, series):
    return " | ".join(forecaster.fit(series).warnings_)


def test_few_events_and_short_durations_are_told(yearly):
    text = findings(EventForecaster(kind="nvar", event_threshold={"quantile": 0.98}), yearly)
    assert "events in the training series, fewer than 10" in text
    assert "decorrelates" not in text
    slow = np.cumsum(np.random.default_rng(0).normal(size=(1, 2000, 1)), axis=1)
    assert "durations are in samples: a window of 5, where the observable decorrelates within" in (
        findings(EventForecaster(kind="nvar", event_threshold={"quantile": 0.8}), slow)
    )


def test_a_permanent_alarm_that_is_as_good_is_told():
    """The sign of the first component says whether an event is more likely: by little."""
    generator = np.random.default_rng(2)
    state = np.repeat(generator.normal(size=(10, 40, 1)), 10, axis=1)
    event = generator.normal(size=(10, 400, 1)) + 0.15 * np.roll(state, 2, axis=1)
    text = findings(
        EventForecaster(1, kind="precursor", event_threshold={"quantile": 0.85}),
        np.concatenate([state, event], axis=2),
    )
    assert "no better than a permanent alarm" in text or "no better than chance" in text


# -- intervals -------------------------------------------------------------------------------------


@pytest.mark.parametrize("series", [3, 12])
def test_scores_have_intervals_over_series_or_blocks_of_time(series):
    forecaster = unfitted("analogues").fit(lorenz(4, 900, 1))
    tested = lorenz(series, 900, 3)
    plain, intervals = forecaster.scores(tested), forecaster.scores(tested, interval=True)
    assert intervals.keys() == plain.keys()
    counted = ("forecasts", "events", "invalid_fraction")
    for name in ("alarm_f_score", "brier_skill", "base_rate", "permanent_f_score", *counted):
        assert intervals[name].value == pytest.approx(plain[name], abs=1e-12)
        assert intervals[name].low <= plain[name] <= intervals[name].high
    assert intervals["base_rate"].low < intervals["base_rate"].high
    again = forecaster.scores(tested, interval=True)
    assert_array_equal([*again.values()], [*intervals.values()])
    # what the scatter of a sample enlarges has no interval
    assert np.isnan([intervals[name][1:] for name in ("reliability", "calibration_error")]).all()
    assert intervals["alarm_f_score"].high <= 1
    widths = intervals["base_rate"].high - intervals["base_rate"].low
    rates = [forecaster.scores(states[np.newaxis])["base_rate"] for states in tested]
    if series == 12:
        student = 2.201 * np.std(rates, ddof=1) / np.sqrt(12)
        assert widths == pytest.approx(2 * student, rel=0.35)


def test_a_score_without_an_error_has_an_interval_all_the_same():
    """Series whose events all follow a jump to 1: every forecast is right."""
    outcomes = Outcomes(
        np.array([0.0, 1.0]), np.tile([9, 1], (20, 1)), events=np.tile([0, 1], (20, 1))
    )
    scores = score_intervals(outcomes, 0.5, 10, 1, np.zeros(20))
    for name in ("alarm_f_score", "alarm_recall", "brier_skill", "roc_area"):
        value, low, high = scores[name]
        assert value == high == 1
        assert 0.7 < low < 1
    # one further error of 200 forecasts, 3.7 times
    assert scores["invalid_fraction"].high == pytest.approx(-np.log(0.025) / 201)


def test_intervals_of_losses_leave_out_one_block_after_the_other():
    """The base rate, by hand."""
    points, events = (
        np.array([[4, 6], [9, 1], [5, 5], [2, 8]]),
        np.array([[1, 4], [0, 1], [0, 5], [2, 3]]),
    )
    outcomes = Outcomes(np.array([0.2, 0.8]), points, events)
    found = score_intervals(outcomes, 0.5, 10, 1, np.zeros(4))["base_rate"]
    others = [np.delete(events, row, 0).sum() / 30 for row in range(4)]
    assert found.value == 16 / 40
    expected = loss_interval(16 / 40, np.array(others), 17 / 41, 0.95)
    assert (found.low, found.high) == pytest.approx(expected)


def test_what_one_more_outcome_changes_is_the_worst_that_could_happen():
    """An event at the lowest level, or none at the highest."""
    outcomes = Outcomes(np.array([0.1, 0.4, 0.9]), np.array([5, 3, 2]), np.array([1, 1, 2]))
    more = _one_more(outcomes)
    assert more.points.tolist() == [[6, 3, 2], [5, 3, 3]]
    assert more.events.tolist() == [[2, 1, 2], [1, 1, 2]]
