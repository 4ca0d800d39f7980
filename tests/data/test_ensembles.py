"""Ensembles: what is kept, scales, noise, starting points, thresholds and delay coordinates."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as npst

from burstcast import random_streams
from burstcast.data import dataset
from burstcast.data.delay_coordinates import delay_coordinates, delayed_name
from burstcast.data.ensemble_files import ensemble_variables
from burstcast.data.event_threshold import threshold_at
from burstcast.data.observation_noise import estimate_noise, observation_noise
from burstcast.data.starting_points import (
    SeriesPoints,
    crossing_points,
    horizon_events,
    segments,
    starting_points,
    steps_before_events,
)
from burstcast.forecasters._options import options_of_kind
from burstcast.forecasters.analogues import Analogues
from burstcast.forecasters.base import ForecastingCase
from burstcast.systems.integration import integrate
from burstcast.systems.lorenz63 import Lorenz63
from burstcast.systems.measured import MeasuredSeries
from burstcast_workflow.harness.settings import cases_of_thresholds, with_thresholds

# -- made and observed -----------------------------------------------------------------------------

STEP = 0.01
START = np.array([1, 0, 0.07066, -0.07076, 0, 0, 0, 0, 0])
SYSTEM = Lorenz63()
STARTS = np.array([[1.0, 1.0, 20.0]] * 12).T + 5 * np.random.default_rng(3).random((3, 12))


def textbook_step(state):
    """One Runge-Kutta step of one trajectory."""
    k1 = SYSTEM.right_hand_side(state)
    k2 = SYSTEM.right_hand_side(state + STEP / 2 * k1)
    k3 = SYSTEM.right_hand_side(state + STEP / 2 * k2)
    k4 = SYSTEM.right_hand_side(state + STEP * k3)
    return state + STEP / 6 * (k1 + 2 * k2 + 2 * k3 + k4)


def ensemble(starts=STARTS, **changes):
    """Kept series of a small ensemble, by batches."""
    lengths = {"sampling_stride": 6, "transient_steps": 100, "kept_steps": 300}
    arguments = {"time_step": STEP, **lengths, "laminarisation_threshold": 41.0, **changes}
    return list(dataset.generate_ensemble(SYSTEM, starts, **arguments))


def test_initial_states_are_the_papers():
    states = dataset.initial_states(START, 3, 0.01, 500, np.random.default_rng(5))
    assert states.shape == (9, 500)
    perturbation = states - START[:, None]
    assert not np.delete(perturbation, 3, axis=0).any()
    epsilon = perturbation[3] / 0.01
    assert epsilon.min() > 0
    assert epsilon.max() < 1
    assert np.histogram(epsilon, bins=5, range=(0, 1))[0].min() > 60


def test_a_longer_ensemble_begins_with_the_shorter_one():
    states = [
        dataset.initial_states(START, 3, 0.01, series, np.random.default_rng(5))
        for series in (3, 7)
    ]
    np.testing.assert_array_equal(states[0], states[1][:, :3])


def test_what_has_no_ensemble_and_no_scale():
    class Undefined(type(SYSTEM)):
        def observable(self, state):
            return state[0] * np.nan

    arguments = {"time_step": STEP, "sampling_stride": 6, "transient_steps": 0, "kept_steps": 6}
    made = dataset.generate_ensemble(Undefined(), STARTS, **arguments, laminarisation_threshold=1.0)
    with pytest.raises(FloatingPointError, match=r"observable of 12 series is not a number"):
        list(made)
    with pytest.raises(FloatingPointError, match="time step"):
        ensemble(time_step=1.0)
    states = np.random.default_rng(1).normal(size=(3, 50, 4))
    states[:, :, 2] = 0.5
    with pytest.raises(ValueError, match="component 2 is constant"):
        dataset.component_scales(states)


def test_kept_series_are_those_of_single_trajectories_that_do_not_laminarise():
    expected, index = [], []
    for number in range(12):
        state, samples, largest = STARTS[:, number], [], 0.0
        for step in range(100 + 300 + 1):
            if step >= 100:  # after the transient
                largest = max(largest, state[2])
                if (step - 100) % 6 == 0:
                    samples.append(state)
            state = textbook_step(state)
        if largest <= 41.0:
            expected.append(samples)
            index.append(number)
    assert 0 < len(index) < 12, "the threshold must decide something"
    (kept,) = ensemble()
    assert kept.index.tolist() == index
    assert kept.states.shape == (len(index), 51, 3)
    np.testing.assert_allclose(kept.states, expected, rtol=0, atol=1e-10)


def test_a_burst_between_two_samples_is_seen():
    (sampled,) = ensemble(laminarisation_threshold=None)
    (fine,) = ensemble(laminarisation_threshold=None, sampling_stride=1)
    largest = fine.states[:, :, 2].max(axis=1)
    largest_sampled = sampled.states[:, :, 2].max(axis=1)
    row = int(np.argmax(largest - largest_sampled))
    between = (largest[row] + largest_sampled[row]) / 2
    assert largest_sampled[row] < between < largest[row]
    (kept,) = ensemble(laminarisation_threshold=between)
    # no sample tells when: it is given all steps
    assert row not in kept.index
    assert kept.lifetimes[row] == 50
    assert kept.index.tolist() == np.flatnonzero(largest <= between).tolist()


def test_a_burst_in_the_transient_is_not_seen():
    starts = STARTS + np.array([[0.0], [0.0], [40.0]])
    assert (starts[2] > 41).all()
    (fine,) = ensemble(starts, laminarisation_threshold=None, sampling_stride=1)
    (kept,) = ensemble(starts)
    assert kept.index.tolist() == np.flatnonzero(fine.states[:, :, 2].max(axis=1) <= 41).tolist()
    assert len(kept.index) > 0


def test_the_threshold_itself_is_not_exceeded_and_without_one_every_series_is_kept():
    (fine,) = ensemble(laminarisation_threshold=None, sampling_stride=1)
    largest = fine.states[:, :, 2].max(axis=1)
    (kept,) = ensemble(laminarisation_threshold=float(np.sort(largest)[5]))
    assert len(kept.index) == 6
    assert ensemble(laminarisation_threshold=None)[0].index.tolist() == [*range(12)]


def test_lifetimes_are_those_of_all_series():
    (whole,) = ensemble(laminarisation_threshold=None)
    (kept,) = ensemble()
    assert len(kept.lifetimes) == 12
    for number, series in enumerate(whole.states):
        above = np.flatnonzero(series[:, 2] > 41.0)
        assert kept.lifetimes[number] == (above[0] if above.size else 50)
    assert (whole.lifetimes == 50).all()


def test_batches_change_nothing(monkeypatch):
    (whole,) = ensemble()
    monkeypatch.setattr(dataset, "SERIES_PER_BATCH", 5)
    parts = ensemble()
    assert len(parts) == 3
    np.testing.assert_array_equal(np.concatenate([part.index for part in parts]), whole.index)
    np.testing.assert_array_equal(np.concatenate([part.states for part in parts]), whole.states)
    lifetimes = np.concatenate([part.lifetimes for part in parts])
    np.testing.assert_array_equal(lifetimes, whole.lifetimes)


# -- scales and noise ------------------------------------------------------------------------------
def test_scales_are_componentwise_over_all_series():
    states = np.random.default_rng(1).normal(size=(3, 50, 4)) * [1, 2, 3, 4] + 7
    scales = dataset.component_scales(states)
    for component in range(4):
        values = [value for series in states for value in series[:, component]]
        assert scales.range[component] == max(values) - min(values)
        mean = sum(values) / len(values)
        variance = sum((value - mean) ** 2 for value in values) / len(values)
        np.testing.assert_allclose(scales.standard_deviation[component], np.sqrt(variance))


def observed(states, first, noise=0.01, root_seed=2022, name="Re400"):
    scales = dataset.Scales(np.array([1.0, 10.0]), np.array([4.0, 40.0]))
    return dataset.observed_series(states, first, noise, scales, root_seed, name)


@pytest.mark.parametrize(
    ("first", "noise", "root_seed", "name"),
    [(0, 0.01, 2022, "Re400"), (7, 0.1, 2022, "Re600"), (3, 0.5, 1, "Re400"), (2, 0.0, 2022, "a")],
)
def test_each_series_has_the_noise_of_its_own_stream(first, noise, root_seed, name):
    """Gaussian, of the given share of the scales: by case and number, whatever else there is."""
    states = np.random.default_rng(2).normal(size=(3, 20, 2))
    before, found = states.copy(), observed(states, first, noise, root_seed, name)
    np.testing.assert_array_equal(states, before)
    for row in range(3):
        stream = random_streams.stream(root_seed, "noise", name, first + row)
        expected = states[row] + noise * np.array([1.0, 10.0]) * stream.standard_normal((20, 2))
        np.testing.assert_allclose(found[row], expected, rtol=0, atol=1e-14)
    scales = dataset.Scales(np.array([1.0, 10.0]), np.ones(2))
    again = dataset.observe(states, first, noise, scales, root_seed, "noise", name)
    np.testing.assert_array_equal(found, again)


def test_inputs_are_divided_by_the_range_of_all_series_or_of_the_first():
    states = np.array([[[0.0, 1.0], [2.0, 5.0]], [[-3.0, 2.0], [1.0, 2.0]]])
    assert dataset.network_input_range(states).tolist() == [5.0, 4.0]
    assert dataset.network_input_range(states, "first").tolist() == [2.0, 4.0]
    with pytest.raises(ValueError, match="component 1 is constant"):
        dataset.network_input_range(states[::-1], "first")


def test_times_and_shares_of_an_ensemble():
    states = np.random.default_rng(1).normal(size=(3, 5, 2))
    lifetimes = np.array([4, 2, 4, 4])
    variables, summary = ensemble_variables(
        states, states[:, :, 0], "u", np.array([0, 2, 3]), lifetimes, 0.5
    )
    np.testing.assert_array_equal(variables["time"].data, [0.0, 0.5, 1.0, 1.5, 2.0])
    assert variables["state"].data is states
    assert summary == {
        "series_generated": 4,
        "series_kept": 3,
        "laminarised_fraction": 0.25,
        "mean_observable": states[:, :, 0].mean(),
    }


# -- estimated noise -------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def series():
    start = np.random.default_rng(3).normal(size=(3, 4)) + np.array([[1.0], [1.0], [25.0]])
    return integrate(Lorenz63(), start, 0.01, 2 * 3000, stride=2)[501:].transpose(2, 0, 1)


@pytest.mark.parametrize("noise", [0.001, 0.01, 0.1])
def test_the_noise_of_a_chaotic_system_is_found(noise, series):
    added = noise * series.std(axis=(0, 1)) * np.array([1.0, 2.0, 0.5])
    observed = series + added * np.random.default_rng(5).standard_normal(series.shape)
    np.testing.assert_allclose(estimate_noise(observed), added, rtol=0.05)


def test_what_needs_no_estimate_of_noise_and_what_has_none(series):
    time = np.linspace(-1, 1, 60)[:, np.newaxis]
    smooth = np.concatenate([time**7 - time, 2 - time**4], axis=1)[np.newaxis]
    assert (estimate_noise(smooth) < 1e-14).all()
    np.testing.assert_allclose(observation_noise(series, 0.25), 0.25 * series.std(axis=(0, 1)))
    np.testing.assert_array_equal(observation_noise(series, None), estimate_noise(series))
    with pytest.raises(ValueError, match="series of 8 samples"):
        estimate_noise(np.zeros((3, 8, 2)))


# -- starting points -------------------------------------------------------------------------------


@given(
    st.integers(1, 3), st.integers(1, 60), st.integers(1, 9), st.integers(1, 9), st.integers(1, 20)
)
def test_starting_points_are_as_many_as_leave_room(series, length, spacing, washout, longest):
    expected = []
    step = washout - 1
    while step + longest < length:  # the last forecast step is in the series
        expected.append(step)
        step += spacing
    if not expected:
        with pytest.raises(ValueError, match=r"leave no room for a washout"):
            starting_points(series, length, spacing, washout, longest)
        return
    points = starting_points(series, length, spacing, washout, longest)
    pairs = list(zip(points.series.tolist(), points.step.tolist(), strict=True))
    assert pairs == [(row, step) for row in range(series) for step in expected]
    assert len(points) == len(pairs)


def test_starting_points_of_the_paper_and_steps_before_events():
    points = starting_points(150, 4001, 61, 30, 366)
    assert points.step[0] == 29  # the washout: inputs 0 to 29
    assert (np.diff(points.step[:60]) == 61).all()
    assert points.step.max() + 366 <= 4000
    assert points.step.max() + 61 + 366 > 4000
    assert steps_before_events(45, 40, 5) == 44
    with pytest.raises(ValueError, match="44 samples leave no room for a washout of 5 steps and a"):
        steps_before_events(44, 40, 5)


@given(npst.arrays(np.float64, (3, 12), elements=st.sampled_from([0.0, 0.09, 0.1, 0.2])))
def test_crossings_are_rises_to_the_threshold(observable):
    expected = [
        (row, step)
        for row in range(3)
        for step in range(1, 12)
        if observable[row, step - 1] < 0.1 <= observable[row, step]
    ]
    found = crossing_points(observable, 0.1)
    assert list(zip(found.series.tolist(), found.step.tolist(), strict=True)) == expected


def test_horizon_events_are_the_first_that_leave_room():
    crossings = SeriesPoints(np.array([0, 0, 1, 1, 2, 3]), np.array([9, 50, 10, 90, 11, 70]))
    events = horizon_events(crossings, 0, 10, 4)
    assert events.series.tolist() == [0, 1, 1, 2]
    assert events.step.tolist() == [50, 10, 90, 11]
    assert len(horizon_events(crossings, 0, 91, 4)) == 0
    assert len(horizon_events(crossings, 0, 0, 500)) == 6
    unseen = horizon_events(crossings, 1, 10, 2)
    assert (unseen.series.tolist(), unseen.step.tolist()) == ([1, 1], [10, 90])


@given(st.data(), st.integers(0, 4), st.integers(0, 4))
def test_segments_are_cut_out(data, before, after):
    series = np.arange(3 * 12 * 2).reshape(3, 12, 2).astype(float)
    rows = data.draw(st.lists(st.integers(0, 2), max_size=5))
    steps = [data.draw(st.integers(before, 11 - after)) for _ in rows]
    points = SeriesPoints(np.array(rows, dtype=np.int64), np.array(steps, dtype=np.int64))
    found = segments(series, points, before, after)
    assert found.shape == (len(rows), before + 1 + after, 2)
    for number, (row, step) in enumerate(zip(rows, steps, strict=True)):
        np.testing.assert_array_equal(found[number], series[row, step - before : step + after + 1])
    two_dimensional = segments(series[..., 0], points, before, after)
    np.testing.assert_array_equal(two_dimensional, found[..., 0])


@pytest.mark.parametrize(("step", "before", "after"), [(2, 3, 0), (9, 0, 1)])
def test_segments_beyond_the_series_are_refused(step, before, after):
    # a negative index would silently take the end of the series
    points = SeriesPoints(np.array([0, 0]), np.array([5, step]))
    with pytest.raises(IndexError, match="beyond its series"):
        segments(np.zeros((1, 10)), points, before, after)


# -- thresholds as quantiles -----------------------------------------------------------------------


@given(st.lists(st.floats(-1e6, 1e6), min_size=2, unique=True), st.floats(0.01, 0.99))
def test_the_share_below_is_the_quantile(values, quantile):
    observable = np.array(values).reshape(1, -1)
    try:
        threshold = threshold_at(quantile, observable)
    except ValueError:  # neighbouring floats
        return
    below = (observable < threshold).sum()
    assert abs(below - quantile * (len(values) - 1)) <= 1 + 1e-9 * len(values)


def test_known_quantiles():
    assert threshold_at(0.95, np.arange(101.0)) == 95.0
    assert threshold_at(0.5, -np.arange(5.0)) == -2.0


@pytest.mark.parametrize(
    ("quantile", "observable", "message"),
    [
        (1.0, np.arange(3.0), "between 0 and 1"),
        (0.5, np.array([]), "finite samples"),
        (0.5, np.array([1.0, np.nan]), "finite samples"),
        (0.5, np.array([0.0, 1.0, 1.0, 1.0]), r"no sample is above the quantile 0\.5"),
    ],
)
def test_what_has_no_threshold(quantile, observable, message):
    with pytest.raises(ValueError, match=message):
        threshold_at(quantile, observable)


def test_values_replace_quantiles_wherever_they_are():
    unknown = {"case": "a", "quantile": 0.9}
    thresholds = {"b": {**unknown, "case": "b"}, "c": 3.0}
    cases = [
        {"identity": {"case": case}, "settings": {"case.event_threshold": threshold}}
        for case, threshold in thresholds.items()
    ]
    settings = {"case.event_threshold": unknown, "cases": cases, "quantile": 0.5}
    assert list(cases_of_thresholds(settings)) == ["a", "b"]
    known = with_thresholds(settings, {"a": 1.5, "b": 2.5}.get)
    assert known["case.event_threshold"] == 1.5
    found = [record["settings"]["case.event_threshold"] for record in known["cases"]]
    assert found == [2.5, 3.0]
    assert (known["quantile"], list(cases_of_thresholds(known))) == (0.5, [])


# -- delay coordinates -----------------------------------------------------------------------------


@given(
    samples=st.integers(8, 30),
    delays=st.lists(st.integers(1, 7), max_size=4, unique=True),
    seed=st.integers(0, 99),
)
def test_value_by_value(samples, delays, seed):
    series = np.random.default_rng(seed).normal(size=(3, samples, 2))
    found = delay_coordinates(series, delays)
    longest = max(delays, default=0)
    assert found.shape == (3, samples - longest, 2 * (1 + len(delays)))
    for row in range(3):
        for step in range(samples - longest):
            now = step + longest
            expected = [series[row, now - back, i] for back in [0, *delays] for i in range(2)]
            assert found[row, step].tolist() == expected


def test_mistakes():
    series = np.zeros((2, 5, 1))
    with pytest.raises(ValueError, match=r"whole numbers above 0, not \[2, 0\]"):
        delay_coordinates(series, [2, 0])
    with pytest.raises(ValueError, match="reach back by 5 steps, but a series has 5 samples"):
        delay_coordinates(series, [5])
    assert delay_coordinates(series, [4]).shape == (2, 1, 2)


def error_of_analogues(x, delays):
    """Median error of x, half a Lyapunov time ahead, in series that were not learnt from."""
    series, lead, longest = delay_coordinates(x, delays), 27, max(delays, default=0)
    space = MeasuredSeries(["x", *(delayed_name("x", delay) for delay in delays)], "x")
    case = ForecastingCase(space, 0.005, 4, 55, options_of_kind("analogues"))
    forecaster = Analogues.fit(series[:8], case)
    now = np.arange(100, 900, 20)  # of the whole series
    seen = series[8:, now - longest].reshape(-1, series.shape[2])
    forecast, _ = forecaster.advance(forecaster.start(seen.T[np.newaxis]), lead)
    return float(np.median(np.abs(forecast[-1, 0] - x[8:, now + lead, 0].ravel())))


def test_the_past_of_one_component_tells_of_the_others():
    """Analogues have no memory: x of Lorenz's system alone does not tell where it goes."""
    start = np.array([[1.0, 1.0, 20.0]] * 12).T
    start += np.random.default_rng(3).uniform(-5, 5, start.shape)
    states = integrate(Lorenz63(), start, 0.01, 3000, stride=2)[500:].transpose(2, 0, 1)
    x = states[..., :1]
    alone, with_past = error_of_analogues(x, []), error_of_analogues(x, [4, 8])
    assert with_past < 0.25 * alone
    assert with_past < 0.1 * x.std()
