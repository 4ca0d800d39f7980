"""Ensembles: what is kept, scales, noise, starting points, thresholds and delay coordinates."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from burstcast.base import random_streams
from burstcast.data import dataset
from burstcast.data.delay_coordinates import delay_coordinates, delayed_name
from burstcast.data.ensemble_files import ensemble_variables
from burstcast.data.event_threshold import threshold_at
from burstcast.data.observation_noise import (
    coarse_sampling,
    estimate_noise,
    observation_noise,
    spiky_components,
)
from burstcast.data.starting_points import (
    SeriesPoints,
    crossing_points,
    horizon_events,
    segments,
    starting_points,
    steps_before_events,
)
from burstcast.systems.integration import integrate
from burstcast.systems.lorenz63 import Lorenz63
from helpers_library import lorenz_series

# -- made and observed -----------------------------------------------------------------------------

STEP = 0.01
START = np.array([1, 0, 0.07066, -0.07076, 0, 0, 0, 0, 0])
SYSTEM = Lorenz63()
STARTS = np.array([[1.0, 1.0, 20.0]] * 12).T + 5 * np.random.default_rng(3).random((3, 12))


def ensemble(starts=STARTS, system=SYSTEM, **changes):
    """Kept series of a small ensemble, by batches."""
    lengths = {"sampling_stride": 6, "transient_steps": 100, "kept_steps": 300}
    arguments = {"time_step": STEP, **lengths, "laminarisation_threshold": 41.0, **changes}
    return list(dataset.generate_ensemble(system, starts, **arguments))


def test_initial_states_are_the_papers_and_more_of_them_begin_with_the_same():
    states = dataset.initial_states(START, 3, 0.01, 500, np.random.default_rng(5))
    assert states.shape == (9, 500)
    perturbation = states - START[:, None]
    assert not np.delete(perturbation, 3, axis=0).any()
    epsilon = perturbation[3] / 0.01
    assert epsilon.min() > 0
    assert epsilon.max() < 1
    assert np.histogram(epsilon, bins=5, range=(0, 1))[0].min() > 60
    fewer = dataset.initial_states(START, 3, 0.01, 7, np.random.default_rng(5))
    np.testing.assert_array_equal(fewer, states[:, :7])


@pytest.mark.parametrize("raised", [0.0, 40.0])  # a burst in the transient is not seen
def test_generate_ensemble_keeps_single_trajectories_that_do_not_laminarise(raised):
    starts = STARTS + np.array([[0.0], [0.0], [raised]])
    course = integrate(SYSTEM, starts, STEP, 100 + 300)[100:]  # after the transient
    largest, sampled = course[:, 2].max(axis=0), course[::6, 2]
    between = (largest + sampled.max(axis=0)) / 2
    hidden = (between > largest.min()) & (between < largest - 1e-6)
    assert hidden.sum() > 3
    for threshold in (41.0, *between[hidden]):
        (kept,) = ensemble(starts, laminarisation_threshold=threshold)
        index = np.flatnonzero(largest <= threshold)
        assert kept.index.tolist() == index.tolist()
        assert 0 < len(index) < 12, "the threshold must decide something"
        expected = course[::6, :, index].transpose(2, 0, 1)
        np.testing.assert_allclose(kept.states, expected, rtol=0, atol=1e-10)
        # no sample tells of a burst between two of them: such a series is given all steps
        above = sampled > threshold
        assert kept.lifetimes.tolist() == np.where(above.any(0), above.argmax(0), 50).tolist()


def test_the_threshold_itself_is_not_exceeded_and_without_one_every_series_is_kept():
    (fine,) = ensemble(laminarisation_threshold=None, sampling_stride=1)
    largest = fine.states[:, :, 2].max(axis=1)
    (kept,) = ensemble(laminarisation_threshold=float(np.sort(largest)[5]))
    assert len(kept.index) == 6
    (every,) = ensemble(laminarisation_threshold=None)
    assert every.index.tolist() == [*range(12)]
    assert (every.lifetimes == 50).all()


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
    before, noisy = states.copy(), observed(states, first, noise, root_seed, name)
    np.testing.assert_array_equal(states, before)
    for row in range(3):
        stream = random_streams.stream(root_seed, "noise", name, first + row)
        expected = states[row] + noise * np.array([1.0, 10.0]) * stream.standard_normal((20, 2))
        np.testing.assert_allclose(noisy[row], expected, rtol=0, atol=1e-14)
    scales = dataset.Scales(np.array([1.0, 10.0]), np.ones(2))
    again = dataset.add_observation_noise(states, first, noise, scales, root_seed, "noise", name)
    np.testing.assert_array_equal(noisy, again)


def test_inputs_are_divided_by_the_range_of_all_series_or_of_the_first():
    states = np.array([[[0.0, 1.0], [2.0, 5.0]], [[-3.0, 2.0], [1.0, 2.0]]])
    assert dataset.network_input_range(states).tolist() == [5.0, 4.0]
    assert dataset.network_input_range(states, "first").tolist() == [2.0, 4.0]
    with pytest.raises(ValueError, match="component 1 is constant"):
        dataset.network_input_range(states[::-1], "first")


def test_times_and_shares_of_an_ensemble():
    states = np.random.default_rng(1).normal(size=(3, 5, 2))
    kept, lifetimes = np.array([0, 2, 3]), np.array([4, 2, 4, 4])
    variables, summary = ensemble_variables(states, states[..., 0], "u", kept, lifetimes, 0.5)
    np.testing.assert_array_equal(variables["time"].data, [0.0, 0.5, 1.0, 1.5, 2.0])
    assert variables["state"].data is states
    expected = {"series_generated": 4, "series_kept": 3, "laminarised_fraction": 0.25}
    assert summary == expected | {"mean_observable": states[..., 0].mean()}


# -- estimated noise -------------------------------------------------------------------------------


def test_noise_is_estimated_or_given():
    """Of a chaotic system, and of polynomials, which have none."""
    series = lorenz_series(4, 501, 3001)
    for noise in (0.001, 0.01, 0.1):
        added = noise * series.std(axis=(0, 1)) * np.array([1.0, 2.0, 0.5])
        observed = series + added * np.random.default_rng(5).standard_normal(series.shape)
        np.testing.assert_allclose(estimate_noise(observed), added, rtol=0.05)
    time = np.linspace(-1, 1, 60)[:, np.newaxis]
    smooth = np.concatenate([time**7 - time, 2 - time**4], axis=1)[np.newaxis]
    assert (estimate_noise(smooth) < 1e-14).all()
    np.testing.assert_allclose(observation_noise(series, 0.25), 0.25 * series.std(axis=(0, 1)))
    np.testing.assert_array_equal(observation_noise(series, None), estimate_noise(series))


def spikes(samples, seed=0):
    """A pulse of four samples in every 50, of varying height, on a slow wave."""
    time, draws = np.arange(samples), np.random.default_rng(seed).uniform(1, 3, samples // 50 + 1)
    pulses = draws[time // 50] * np.exp(-(((time % 50 - 25) / 1.5) ** 2))
    return (np.sin(2 * np.pi * time / 200) + 5 * pulses)[np.newaxis, :, np.newaxis]


def test_spikes_of_a_trajectory_are_no_noise():
    """The root mean square of the differences counts them, as noise of a tenth of the signal."""
    series, drawn = spikes(5000), np.random.default_rng(1).standard_normal((1, 5000, 1))
    spread = series.std()
    differences = np.diff(series, n=8, axis=1)
    assert np.sqrt(np.square(differences).mean() / 12870) > 0.03 * spread
    assert estimate_noise(series).item() < 1e-4 * spread
    noisy = estimate_noise(series + 0.02 * spread * drawn).item()
    assert 0.018 * spread < noisy < 0.028 * spread
    assert spiky_components(series, ["u"]) == ["u"]
    assert spiky_components(0.1 * drawn, ["u"]) == []
    assert not list(coarse_sampling(series, ["u"]))


def test_gaussian_noise_is_the_root_mean_square_bit_for_bit():
    """The median, which scatters more, is taken only where the two contradict each other."""
    noise = np.random.default_rng(2).standard_normal((3, 1000, 2))
    expected = np.sqrt(np.square(np.diff(noise, n=8, axis=1)).reshape(-1, 2).mean(axis=0) / 12870)
    np.testing.assert_array_equal(estimate_noise(noise), expected)


def test_a_sensor_that_stands_still_most_of_the_time_keeps_its_noise():
    rng = np.random.default_rng(3)
    moving = np.repeat(rng.random(40) < 0.3, 100)
    series = np.where(moving, rng.standard_normal(4000), 0.0)[np.newaxis, :, np.newaxis]
    assert 0.4 < estimate_noise(series).item() < 1.2
    assert estimate_noise(np.zeros((2, 20, 1))).item() == 0.0


def test_a_sampling_too_coarse_for_the_noise_is_told():
    """A sine of four samples a period, and noise that is correlated in time; not white noise."""
    time = np.arange(4000)
    sine = np.sin(2 * np.pi * (time + 0.3) / 4.05)[np.newaxis, :, np.newaxis]
    (text,) = coarse_sampling(sine, ["u"])
    assert "sampling is too coarse" in text
    assert "u 0.13 or 0.035" in text
    white = np.random.default_rng(4).standard_normal((1, 4000, 1))
    assert not list(coarse_sampling(white, ["u"]))
    assert not list(coarse_sampling(lorenz_series(2, 501, 2001), "xyz"))
    # a moving average over four samples: no high frequencies are left but by its side lobes
    smooth = white[:, :-3] + 3 * white[:, 1:-2] + 3 * white[:, 2:-1] + white[:, 3:]
    (text,) = coarse_sampling(smooth, ["u"])
    assert "contradict" in text


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


def test_horizon_events_are_the_first_that_leave_room():
    observable = np.zeros((4, 95))
    observable[[0, 0, 1, 1, 2, 3], [9, 50, 10, 90, 11, 70]] = 0.1
    crossings = crossing_points(observable, 0.1)
    events = horizon_events(crossings, 0, 10, 4)
    assert events.series.tolist() == [0, 1, 1, 2]
    assert events.step.tolist() == [50, 10, 90, 11]
    assert steps_before_events(45, 40, 5) == 44
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
    cut = segments(series, points, before, after)
    assert cut.shape == (len(rows), before + 1 + after, 2)
    for number, (row, step) in enumerate(zip(rows, steps, strict=True)):
        np.testing.assert_array_equal(cut[number], series[row, step - before : step + after + 1])
    two_dimensional = segments(series[..., 0], points, before, after)
    np.testing.assert_array_equal(two_dimensional, cut[..., 0])


# -- thresholds as quantiles -----------------------------------------------------------------------


@given(st.lists(st.integers(-9, 9), min_size=2, unique=True), st.floats(0.01, 0.99))
def test_threshold_at_a_quantile_lies_in_proportion_between_two_samples(values, quantile):
    place = quantile * (len(values) - 1)
    below, above = sorted(values)[int(place)], sorted(values)[int(place) + 1]
    expected = below + (place - int(place)) * (above - below)
    threshold_found = threshold_at(quantile, np.array(values, float).reshape(1, -1))
    assert threshold_found == pytest.approx(expected, abs=1e-9)


CONSTANT = np.array([[[0.0, 1.0, 0.5], [1.0, 0.0, 0.5]]])


class Undefined(Lorenz63):
    def observable(self, state):
        return state[0] * np.nan


def cut_out(step, before, after):
    # a negative index would silently take the end of the series
    points = SeriesPoints(np.array([0, 0]), np.array([5, step]))
    return segments(np.zeros((1, 10)), points, before, after)


@pytest.mark.parametrize(
    ("made", "error", "message"),
    [
        (lambda: ensemble(system=Undefined()), FloatingPointError, "observable of 12 series is no"),
        (lambda: ensemble(time_step=1.0), FloatingPointError, "time step"),
        (lambda: dataset.component_scales(CONSTANT), ValueError, "component 2 is constant"),
        (lambda: estimate_noise(np.zeros((3, 8, 2))), ValueError, "series of 8 samples"),
        (lambda: steps_before_events(44, 40, 5), ValueError, "44 samples leave no room for a was"),
        (lambda: cut_out(2, 3, 0), IndexError, "beyond its series"),
        (lambda: cut_out(9, 0, 1), IndexError, "beyond its series"),
        (lambda: threshold_at(1.0, np.arange(3.0)), ValueError, "between 0 and 1"),
        (lambda: threshold_at(0.5, np.array([])), ValueError, "finite samples"),
        (lambda: threshold_at(0.5, np.array([1.0, np.nan])), ValueError, "finite samples"),
        (
            lambda: threshold_at(0.5, np.array([0.0, 1.0, 1.0, 1.0])),
            *(ValueError, r"no sample is above the quantile 0\.5"),
        ),
        (
            lambda: delay_coordinates(np.zeros((2, 5, 1)), [2, 0]),
            *(ValueError, r"whole numbers above 0, not \[2, 0\]"),
        ),
        (
            lambda: delay_coordinates(np.zeros((2, 5, 1)), [5]),
            *(ValueError, "reach back by 5 steps, but a series has 5 samples"),
        ),
    ],
)
def test_what_makes_no_sense_is_refused(made, error, message):
    with pytest.raises(error, match=message):
        made()


# -- delay coordinates -----------------------------------------------------------------------------


@given(
    samples=st.integers(8, 30),
    delays=st.lists(st.integers(1, 7), max_size=4, unique=True),
    seed=st.integers(0, 99),
)
def test_delay_coordinates_value_by_value(samples, delays, seed):
    assert delayed_name("x", 5) == "x(t-5)"
    series = np.random.default_rng(seed).normal(size=(3, samples, 2))
    delayed = delay_coordinates(series, delays)
    longest = max(delays, default=0)
    assert delayed.shape == (3, samples - longest, 2 * (1 + len(delays)))
    for row in range(3):
        for step in range(samples - longest):
            now = step + longest
            expected = [series[row, now - back, i] for back in [0, *delays] for i in range(2)]
            assert delayed[row, step].tolist() == expected
