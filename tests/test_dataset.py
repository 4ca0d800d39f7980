import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from burstcast import random_streams
from burstcast.data import dataset
from burstcast.systems.lorenz63 import Lorenz63

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
    arguments = {
        "time_step": STEP,
        "sampling_stride": 6,
        "transient_steps": 100,
        "kept_steps": 300,
        "laminarisation_threshold": 41.0,
        **changes,
    }
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


def test_an_observable_that_is_not_a_number_is_an_error():
    class Undefined(type(SYSTEM)):
        def observable(self, state):
            return state[0] * np.nan

    arguments = {"time_step": STEP, "sampling_stride": 6, "transient_steps": 0, "kept_steps": 6}
    made = dataset.generate_ensemble(Undefined(), STARTS, **arguments, laminarisation_threshold=1.0)
    with pytest.raises(FloatingPointError, match=r"observable of 12 series is not a number"):
        list(made)


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


def test_the_threshold_itself_is_not_exceeded():
    (fine,) = ensemble(laminarisation_threshold=None, sampling_stride=1)
    largest = fine.states[:, :, 2].max(axis=1)
    (kept,) = ensemble(laminarisation_threshold=float(np.sort(largest)[5]))
    assert len(kept.index) == 6


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


def test_without_threshold_every_series_is_kept():
    assert ensemble(laminarisation_threshold=None)[0].index.tolist() == [*range(12)]


def test_a_system_that_leaves_the_numbers_stops():
    with pytest.raises(FloatingPointError, match="time step"):
        ensemble(time_step=1.0)


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


def test_a_constant_component_is_named():
    states = np.random.default_rng(1).normal(size=(3, 50, 4))
    states[:, :, 2] = 0.5
    with pytest.raises(ValueError, match="component 2 is constant"):
        dataset.component_scales(states)


def observed(states, first, noise=0.01, root_seed=2022, name="Re400"):
    scales = dataset.Scales(np.array([1.0, 10.0]), np.array([4.0, 40.0]))
    return dataset.observed_series(states, first, noise, scales, root_seed, name)


@given(st.integers(0, 6), st.integers(1, 6))
def test_noise_of_a_series_depends_on_its_number_alone(first, count):
    states = np.random.default_rng(2).normal(size=(12, 20, 2))
    part = observed(states[first : first + count], first)
    np.testing.assert_array_equal(part, observed(states, 0)[first : first + count])


def test_noise_depends_on_nothing_that_another_series_changes():
    states = np.random.default_rng(2).normal(size=(3, 20, 2))
    other = states.copy()
    other[0] += 100
    np.testing.assert_array_equal(observed(states, 0)[1:], observed(other, 0)[1:])


def test_noise_is_gaussian_of_the_papers_size():
    states = np.zeros((4, 5000, 2))
    noise = observed(states, 0)
    np.testing.assert_allclose(noise.std(axis=(0, 1)), [0.01, 0.1], rtol=0.02)
    np.testing.assert_allclose(noise.mean(axis=(0, 1)), 0, atol=0.003)
    standard = noise / [0.01, 0.1]
    assert abs((standard**4).mean() - 3) < 0.15
    # independent in time and of the other component
    assert abs((standard[:, 1:] * standard[:, :-1]).mean()) < 0.03
    assert abs((standard[..., 0] * standard[..., 1]).mean()) < 0.03


def test_noise_is_added_to_the_series_and_leaves_it_alone():
    states = np.random.default_rng(2).normal(size=(3, 20, 2))
    before = states.copy()
    noise = observed(np.zeros_like(states), 0)
    np.testing.assert_allclose(observed(states, 0), states + noise, rtol=1e-15)
    np.testing.assert_array_equal(states, before)
    np.testing.assert_array_equal(observed(states, 0, noise=0.0), states)


def test_other_cases_and_seeds_have_other_noise():
    states = np.zeros((1, 20, 2))
    reference = observed(states, 0)
    assert not np.array_equal(reference, observed(states, 0, name="Re600"))
    assert not np.array_equal(reference, observed(states, 0, root_seed=1))
    assert not np.array_equal(reference, observed(states, 1))


def test_noise_comes_from_the_stream_of_that_name():
    states = np.zeros((2, 20, 2))
    numbers = random_streams.stream(2022, "noise", "Re400", 8).standard_normal((20, 2))
    np.testing.assert_array_equal(observed(states, 7)[1], 0.01 * np.array([1.0, 10.0]) * numbers)


def test_the_series_of_a_case_have_one_noise_by_its_name():
    states, scales = np.zeros((2, 5, 2)), dataset.Scales(np.array([1.0, 10.0]), np.ones(2))
    np.testing.assert_array_equal(
        observed(states, 3), dataset.observe(states, 3, 0.01, scales, 2022, "noise", "Re400")
    )


def test_inputs_are_divided_by_the_range_of_all_series_or_of_the_first():
    states = np.array([[[0.0, 1.0], [2.0, 5.0]], [[-3.0, 2.0], [1.0, 2.0]]])
    assert dataset.network_input_range(states).tolist() == [5.0, 4.0]
    assert dataset.network_input_range(states, "first").tolist() == [2.0, 4.0]
    with pytest.raises(ValueError, match="component 1 is constant"):
        dataset.network_input_range(states[::-1], "first")
