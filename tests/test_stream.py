"""Observations one at a time: the probabilities of the batch, and what a gap does."""

import math
import time

import numpy as np
import pytest

import burstcast
from test_event_forecaster import lorenz

INTERVAL = 0.02


SERIES = lorenz(1, 300, 5)[0]


@pytest.fixture(scope="module")
def fitted():
    forecaster = burstcast.EventForecaster(
        event_threshold=12.0,
        prediction_times=(0.5, 1.0),
        lyapunov_time=1 / 0.9056,
        sampling_interval=INTERVAL,
        members=2,
        neurons=60,
        grid=2,
        bayesian_points=1,
    )
    return forecaster.fit(lorenz(4, 900, 1))


@pytest.fixture
def forecaster(fitted, tmp_path):
    """A copy of its own, which has seen nothing."""
    fitted.save(tmp_path / "fresh.nc")
    return burstcast.EventForecaster.load(tmp_path / "fresh.nc")


def test_each_sample_has_the_probability_of_the_batch(forecaster):
    washout = forecaster._samples("washout")
    found = {0.5: [], 1.0: []}
    for sample in SERIES[:120]:
        forecaster.update(sample)
        for lead, values in found.items():
            values.append(forecaster.probability(lead))
    for lead, values in found.items():
        assert np.isnan(values[: washout - 1]).all()
        windows = np.stack([SERIES[end - washout : end] for end in range(washout, 121)])
        expected = forecaster.predict_proba(windows, lead)[:, 1]
        assert np.array_equal(values[washout - 1 :], expected)
        assert len(set(values)) > 3
    assert forecaster.probability() == found[0.5][-1]


def test_a_clock_that_jitters_and_counts_since_1970(forecaster):
    for number in range(forecaster._samples("washout")):
        forecaster.update(SERIES[number], 1.7e9 + INTERVAL * (number + 0.05 * (number % 2)))
    assert not math.isnan(forecaster.probability())


@pytest.mark.parametrize("gap", ["time", "value"])
def test_a_gap_begins_the_washout_again_and_says_so(forecaster, gap):
    washout = forecaster._samples("washout")
    for number in range(washout):
        forecaster.update(SERIES[number], number * INTERVAL)
    assert not math.isnan(forecaster.probability())
    if gap == "time":
        first = washout + 3
        with pytest.warns(UserWarning, match="no observation came between the times"):
            forecaster.update(SERIES[first], first * INTERVAL)
    else:
        first = washout + 1
        with pytest.warns(UserWarning, match="an observation is not finite"):
            forecaster.update([0.0, np.nan, 1.0])
        assert math.isnan(forecaster.probability())
        forecaster.update(SERIES[first])
    assert math.isnan(forecaster.probability())
    for number in range(first + 1, first + washout):
        forecaster.update(SERIES[number], number * INTERVAL)
    expected = forecaster.predict_proba(SERIES[np.newaxis, first : first + washout])[0, 1]
    assert forecaster.probability() == expected


def test_the_observations_are_saved_and_restored(forecaster, tmp_path):
    for number, sample in enumerate(SERIES[:40]):
        forecaster.update(sample, number * INTERVAL)
    forecaster.save(tmp_path / "watching.nc")
    again = burstcast.EventForecaster.load(tmp_path / "watching.nc")
    for number, sample in enumerate(SERIES[40:60], start=40):
        assert again.probability() == forecaster.probability()
        forecaster.update(sample, number * INTERVAL)
        again.update(sample, number * INTERVAL)
    assert again.probability() == forecaster.probability()


@pytest.mark.parametrize(
    ("observation", "when", "message"),
    [
        (np.zeros(2), None, r"has the shape \(3,\).*this one has \(2,\)"),
        (np.zeros((1, 3)), None, r"this one has \(1, 3\)"),
        (np.zeros(3), 0.98, "at time 0.98 cannot follow one at time 1"),
        (np.zeros(3), 1.01, "the sampling interval is 0.02"),
        (np.zeros(3), math.nan, "the time of an observation must be a finite number, not nan"),
        (np.zeros(3), math.inf, "must be a finite number, not inf"),
    ],
)
def test_what_does_not_follow_is_refused(forecaster, observation, when, message):
    forecaster.update(SERIES[0], 1.0)
    with pytest.raises(ValueError, match=message):
        forecaster.update(observation, when)
    forecaster.update(SERIES[1], 1.02)  # what was refused has left nothing behind


def test_nothing_is_watched_before_the_fit(fitted):
    with pytest.raises(RuntimeError, match="not fitted yet"):
        burstcast.EventForecaster().update(np.zeros(3))
    assert math.isnan(fitted.probability())


def test_a_fit_forgets_the_observations(forecaster):
    for sample in SERIES[:40]:
        forecaster.update(sample)
    forecaster.set_params(calibrate=False).fit(lorenz(4, 900, 1))
    assert math.isnan(forecaster.probability())


def test_taking_a_sample_is_fast(forecaster):
    """An update keeps the sample, whatever the networks; less than a millisecond is allowed."""
    start = time.process_time()
    for number in range(2000):
        forecaster.update(SERIES[number % 300])
    assert (time.process_time() - start) / 2000 < 1e-3


@pytest.mark.long
def test_ten_networks_of_1000_neurons():
    """A sample takes less than a millisecond, and probabilities have the bits of the batch."""
    forecaster = burstcast.EventForecaster(
        event_threshold=12.0,
        prediction_times=(0.5,),
        lyapunov_time=1 / 0.9056,
        sampling_interval=INTERVAL,
        members=10,
        neurons=1000,
        grid=2,
        bayesian_points=1,
        calibrate=False,
    ).fit(lorenz(4, 900, 1))
    washout = forecaster._samples("washout")
    taken, found = [], []
    for number, sample in enumerate(SERIES[:100]):
        start = time.process_time()
        forecaster.update(sample)
        taken.append(time.process_time() - start)
        if number >= 90:
            found.append(forecaster.probability())
    assert len(forecaster.members_) == 10
    assert np.median(taken) < 1e-3
    windows = np.stack([SERIES[end - washout : end] for end in range(91, 101)])
    assert found == forecaster.predict_proba(windows)[:, 1].tolist()
