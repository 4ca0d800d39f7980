"""Training series under several values of a parameter, and under random actuation."""

from itertools import pairwise

import numpy as np
import pytest

from burstcast.data.scheduled_series import (
    RandomActuation,
    ScheduledSeries,
    TrainingSet,
    joined,
    scheduled_variables,
    simulated_series,
)
from burstcast.systems.integration import integrate
from burstcast.systems.mfe import MoehlisFaisstEckhardt
from burstcast.systems.parameters import SystemParameters, integrate_scheduled

MFE = MoehlisFaisstEckhardt(400.0)
REYNOLDS = SystemParameters.of(MFE, ["reynolds"])


def stretch_lengths(acting):
    """Lengths of the stretches on and off that neither begin nor end a series."""
    lengths = {True: [], False: []}
    for row in acting:
        edges = np.flatnonzero(row[1:] != row[:-1]) + 1
        for start, stop in pairwise(edges):
            lengths[bool(row[start])].append(stop - start)
    return np.array(lengths[True]), np.array(lengths[False])


def test_stretches_have_their_mean_lengths_in_whole_intervals():
    acting = RandomActuation(15, 3.0, 9.0).draw(40, 15 * 2000, np.random.default_rng(1))
    on, off = (found / 15 for found in stretch_lengths(acting))
    assert (on == on.astype(int)).all()
    assert on.mean() == pytest.approx(3.0, abs=5 * 2.5 / np.sqrt(len(on)))
    assert off.mean() == pytest.approx(9.0, abs=5 * 8.5 / np.sqrt(len(off)))
    # geometric: a stretch of one interval has the probability 1 / mean
    assert (on == 1).mean() == pytest.approx(1 / 3, abs=0.02)
    assert acting.mean() == pytest.approx(0.25, abs=0.01)
    many = RandomActuation(15, 3.0, 9.0).draw(4000, 15, np.random.default_rng(2))
    assert many[:, 0].mean() == pytest.approx(0.25, abs=0.03)


def test_more_series_begin_with_the_same_ones():
    actuation = RandomActuation(4, 2.0, 3.0)
    few = actuation.draw(3, 50, np.random.default_rng(7))
    more = actuation.draw(8, 50, np.random.default_rng(7))
    assert few.shape == (3, 50)
    assert np.array_equal(more[:3], few)


def test_series_are_those_of_integration_and_the_first_that_do_not_laminarise():
    start = np.array([1, 0, 0.07066, -0.07076, 0, 0, 0, 0, 0])[:, np.newaxis]
    perturbed = start + 0.01 * np.random.default_rng(2).random((9, 12))
    perturbed = integrate(MFE, perturbed, 0.25, 2400, 2400)[-1]
    perturbed[:, [1, 4]] = 0.0
    perturbed[0, [1, 4]] = 1.0  # laminar from the first
    acting = RandomActuation(15, 3.0, 9.0).draw(12, 300, np.random.default_rng(3))
    schedules = np.where(acting, 2000.0, 400.0)[:, :, np.newaxis]
    settings = {"time_step": 0.25, "sampling_stride": 4, "laminarisation_threshold": 0.48}
    found, rows = simulated_series(REYNOLDS, MFE, perturbed, schedules, 5, **settings)
    together = integrate_scheduled(REYNOLDS, schedules.transpose(1, 2, 0), perturbed, 0.25, 4)
    every = integrate_scheduled(
        REYNOLDS, np.repeat(schedules.transpose(1, 2, 0), 4, axis=0), perturbed, 0.25
    )
    quiet = (MFE.observable(every.transpose(1, 0, 2)) <= 0.48).all(axis=0)
    assert rows.tolist() == np.flatnonzero(quiet)[:5].tolist()
    assert 1 not in rows
    assert np.array_equal(found.states, together[:, :, rows].transpose(2, 0, 1))
    assert np.array_equal(found.schedules, schedules[rows])
    # as many as are left are enough, one more is not
    left = int(quiet.sum())
    _, rows = simulated_series(REYNOLDS, MFE, perturbed, schedules, left, **settings)
    assert rows.tolist() == np.flatnonzero(quiet).tolist()
    with pytest.raises(ValueError, match=rf"^{left} of 12 flows .* but {left + 1} are wanted"):
        simulated_series(REYNOLDS, MFE, perturbed, schedules, left + 1, **settings)
    with pytest.raises(ValueError, match=r"but 12 are wanted: give more initial states"):
        simulated_series(REYNOLDS, MFE, perturbed, schedules, 12, **settings)


def test_series_of_several_cases_are_joined_with_their_values():
    start = 0.1 * np.random.default_rng(1).normal(size=(9, 2))
    parts = [
        ScheduledSeries.constant(
            integrate(MoehlisFaisstEckhardt(value), start, 0.25, 40, 4).transpose(2, 0, 1), [value]
        )
        for value in (400.0, 1000.0)
    ]
    together = joined(parts)
    assert together.states.shape == (4, 11, 9)
    assert together.schedules[:, :, 0].tolist() == [[400.0] * 10] * 2 + [[1000.0] * 10] * 2
    for row in range(4):
        values = together.schedules[row][:, :, np.newaxis]
        expected = integrate_scheduled(REYNOLDS, values, start[:, [row % 2]], 0.25, 4)
        assert np.array_equal(together.states[row], expected[:, :, 0])


def test_what_does_not_fit_is_refused():
    states = np.zeros((2, 10, 3))
    with pytest.raises(ValueError, match=r"shape \(2, 9, parameters\)"):
        ScheduledSeries(states, np.ones((2, 10, 1)))
    one, two = (ScheduledSeries.constant(states[:, :length], [1.0]) for length in (10, 9))
    with pytest.raises(ValueError, match="the same length, components and parameters"):
        joined([one, two])
    with pytest.raises(ValueError, match=r"mean_on must be 1 at least, not 0\.5"):
        RandomActuation(5, 0.5, 3.0)


def test_series_of_several_cases_take_turns():
    """Case 0 has two series, case 1 three; the numbers say which is which."""

    def part(case, count):
        numbers = np.array([10.0 * case + one for one in range(count)])
        states = np.tile(numbers[:, np.newaxis, np.newaxis], (1, 4, 2))
        true = ScheduledSeries.constant(states, [float(case)])
        return {name: one.data for name, one in scheduled_variables(true, states + 0.5).items()}

    parts = [part(0, 2), part(1, 3)]
    found = TrainingSet.of_parts(parts, own=1)
    assert found.true.states[:, 0, 0].tolist() == [0, 10, 1, 11, 12]
    assert found.observed.states[:, 3, 1].tolist() == [0.5, 10.5, 1.5, 11.5, 12.5]
    assert found.schedules[:, 2, 0].tolist() == [0, 1, 0, 1, 1]
    assert found.own_rows == [1, 3, 4]
    assert TrainingSet.of_parts(parts, own=0).own_rows == [0, 2]
    assert TrainingSet.of_parts(parts, own=None).own_rows == []
