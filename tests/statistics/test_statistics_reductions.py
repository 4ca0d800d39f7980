"""Reductions of series, velocity profiles from moments, and the measures between them."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from burstcast.statistics import reductions
from burstcast.statistics.densities import (
    histogram,
    kantorovich_metric,
    mean_logarithmic_error,
)
from burstcast.statistics.measures import Measures, compare, nearest, sampling_floor
from burstcast.statistics.profiles import (
    equally_spaced_profiles,
    midplane_mean_square,
    normalised_root_mean_square_error,
    velocity_profiles,
)
from burstcast.statistics.reductions import SeriesAccumulator, reduce_series
from burstcast.systems.flow_grid import make_flow_grid
from burstcast.systems.lorenz63 import Lorenz63
from burstcast.systems.mfe import MoehlisFaisstEckhardt
from burstcast.systems.mfe_modes import flow_modes

EDGES = np.linspace(0.5, 8.0, 21)
ALL = slice(None)


def energy(state):
    return 0.5 * np.square(state).sum(axis=0)


def random_series(series=7, time=150, dimension=9, seed=0):
    return np.random.default_rng(seed).normal(0.2, 1.0, (series, time, dimension))


def same(first, second):
    return all(
        np.array_equal(getattr(first, name), getattr(second, name))
        for name in ("edges", "counts", "sums", "product_sums")
    )


def test_merged_reductions_are_those_of_all_values():
    series = random_series()
    found = reduce_series([series], energy, EDGES).merged(ALL)
    flat = series.reshape(-1, 9)
    np.testing.assert_array_equal(found.histogram.counts, np.histogram(energy(flat.T), EDGES)[0])
    assert found.histogram.below + found.histogram.inside + found.histogram.above == len(flat)
    assert found.moments.count == len(flat)
    np.testing.assert_allclose(found.moments.mean, flat.mean(axis=0), atol=1e-14)
    np.testing.assert_allclose(found.moments.mean_product, flat.T @ flat / len(flat), atol=1e-13)


def test_chosen_series_alone_are_merged():
    series = random_series()
    whole = reduce_series([series], energy, EDGES)
    rows = np.array([1, 4])
    alone = reduce_series([series[rows]], energy, EDGES)
    assert len(whole) == 7
    for chosen in (rows, np.isin(np.arange(7), rows)):
        found = whole.merged(chosen)
        expected = alone.merged(ALL)
        np.testing.assert_array_equal(found.histogram.counts, expected.histogram.counts)
        np.testing.assert_array_equal(found.moments.mean_product, expected.moments.mean_product)


def test_no_series_have_no_moments():
    found = reduce_series([random_series()], energy, EDGES).merged(np.zeros(7, dtype=bool))
    assert found.moments.count == 0
    assert found.histogram.inside == 0
    assert np.isnan(found.moments.mean).all()


@given(st.lists(st.integers(0, 6), unique=True), st.integers(1, 200))
def test_reductions_do_not_depend_on_how_series_are_cut_up(cuts, block):
    series = random_series()
    whole = reduce_series([series], energy, EDGES)
    blocks = [part for part in np.split(series, sorted(cuts)) if len(part)]
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(reductions, "STEPS_PER_BLOCK", block)
        assert same(reduce_series(blocks, energy, EDGES), whole)


@given(st.lists(st.integers(1, 149), unique=True))
def test_series_may_be_added_in_pieces_of_time(cuts):
    series = random_series()
    whole = reduce_series([series], energy, EDGES)
    accumulator = SeriesAccumulator(7, 9, EDGES)
    states = series.transpose(1, 2, 0)
    for piece in np.split(states, sorted(cuts)):
        # rows in another order: each goes to its own series
        rows = np.array([3, 0, 1, 2, 6, 5, 4])
        part = piece[..., rows]
        accumulator.add(rows, part, energy(part.transpose(1, 0, 2)))
    assert same(accumulator.reductions(), whole)


def test_reductions_already_taken_do_not_change():
    series = random_series()
    accumulator = SeriesAccumulator(7, 9, EDGES)
    states = series.transpose(1, 2, 0)
    accumulator.add(np.arange(7), states, energy(states.transpose(1, 0, 2)))
    taken = accumulator.reductions()
    accumulator.add(np.arange(7), states, energy(states.transpose(1, 0, 2)))
    assert same(taken, reduce_series([series], energy, EDGES))


def test_what_cannot_be_reduced_is_refused():
    series = random_series()
    series[2, 5, 1] = np.nan
    with pytest.raises(ValueError, match="not finite"):
        reduce_series([series], energy, EDGES)
    with pytest.raises(ValueError, match="no series"):
        reduce_series([], energy, EDGES)


def test_profiles_and_midplane_are_the_averages_of_the_fields():
    system = MoehlisFaisstEckhardt(400.0, length_x=5.0, length_z=3.0)
    modes = flow_modes(system)
    series = random_series(2, 20)
    moments = reduce_series([series], system.observable, EDGES).merged(ALL).moments
    x, z = np.arange(16) * 5.0 / 16, np.arange(12) * 3.0 / 12
    y = np.linspace(-1, 1, 9)
    grid = np.meshgrid(x, y, z, indexing="ij", sparse=True)
    u, v, _ = modes.velocity(series.reshape(-1, 9).T, *grid)
    found = velocity_profiles(equally_spaced_profiles(system, 9), moments)
    average = (0, 1, 3)
    np.testing.assert_allclose(found.u, u.mean(axis=average), atol=1e-12)
    np.testing.assert_allclose(found.uu, (u * u).mean(axis=average), atol=1e-12)
    np.testing.assert_allclose(found.uv, (u * v).mean(axis=average), atol=1e-12)
    plane = np.square(u[:, :, 4]).mean(axis=0)
    np.testing.assert_allclose(midplane_mean_square(modes, moments, x, z), plane, atol=1e-12)


def test_the_grid_of_a_flow_is_its_whole_domain():
    grid = make_flow_grid(MoehlisFaisstEckhardt(400.0, length_x=5.0, length_z=3.0), (3, 5, 7))
    for found, ends, count in ((grid.x, (0, 5), 3), (grid.y, (-1, 1), 5), (grid.z, (0, 3), 7)):
        np.testing.assert_array_equal(found, np.linspace(*ends, count))


def test_a_system_without_velocities_has_no_modes():
    assert flow_modes(Lorenz63()) is None
    assert equally_spaced_profiles(Lorenz63(), 9) is None
    with pytest.raises(ValueError, match="the system Lorenz63 has no velocity field"):
        make_flow_grid(Lorenz63(), (4, 3, 4))


def test_normalised_error_by_hand():
    reference, candidate = np.array([0.0, 2.0, 4.0]), np.array([1.0, 2.0, 2.0])
    assert normalised_root_mean_square_error(reference, candidate) == pytest.approx(
        np.sqrt(5 / 3) / 4
    )
    assert normalised_root_mean_square_error(reference, reference) == 0
    with pytest.raises(ValueError, match="constant"):
        normalised_root_mean_square_error(np.ones(3), candidate)
    with pytest.raises(ValueError, match="compared"):
        normalised_root_mean_square_error(reference, candidate[:2])


MATRICES = flow_modes(MoehlisFaisstEckhardt(400.0)).profile_matrices(np.linspace(-1, 1, 21))


def test_comparison_measures_each_thing_against_the_reference():
    whole = reduce_series([random_series(20)], energy, EDGES)
    reference, candidate = whole.merged(ALL), whole.merged(np.arange(3))
    found = compare(reference, candidate, MATRICES)
    assert found.kantorovich == kantorovich_metric(reference.histogram, candidate.histogram)
    assert found.mean_log_error == mean_logarithmic_error(reference.histogram, candidate.histogram)
    true = velocity_profiles(MATRICES, reference.moments)
    others = velocity_profiles(MATRICES, candidate.moments)
    for name, error in (("u", found.nrmse_u), ("uu", found.nrmse_uu), ("uv", found.nrmse_uv)):
        profile = getattr(true, name)
        # the range of the reference, not of the candidate
        assert error == pytest.approx(
            np.sqrt(np.mean((getattr(others, name) - profile) ** 2)) / np.ptp(profile)
        )


def test_comparison_with_itself_finds_nothing_and_without_series_nothing_defined():
    # bins that are all filled: an empty one counts in the mean logarithmic error
    edges = np.linspace(2.0, 7.0, 11)
    whole = reduce_series([random_series()], energy, edges)
    assert compare(whole.merged(ALL), whole.merged(ALL), MATRICES) == Measures(0, 0, 0, 0, 0)
    none = compare(whole.merged(ALL), whole.merged(np.array([], dtype=int)), MATRICES)
    assert np.isnan(list(vars(none).values())).all()
    without = compare(whole.merged(ALL), whole.merged(np.arange(2)), None)
    assert np.isnan([without.nrmse_u, without.nrmse_uu, without.nrmse_uv]).all()
    assert without.kantorovich > 0


def test_the_nearest_candidate_is_that_of_the_smallest_kantorovich_metric():
    whole = reduce_series([random_series()], energy, np.linspace(2.0, 7.0, 11))
    none = whole.merged(np.array([], dtype=int))
    parts = [whole.merged(np.arange(number)) for number in (1, 3)]
    distances = [compare(whole.merged(ALL), part, None).kantorovich for part in parts]
    assert nearest(whole.merged(ALL), [none, *parts]) == 1 + int(np.argmin(distances))
    assert nearest(whole.merged(ALL), [none, *parts, whole.merged(ALL)]) == 3
    assert nearest(whole.merged(ALL), [none]) is None
    assert nearest(whole.merged(ALL), []) is None


def test_floor_is_the_distance_of_disjoint_parts():
    series = random_series(10)
    whole = reduce_series([series], energy, EDGES)
    floor = sampling_floor(whole, MATRICES, 5, np.random.default_rng(3), sample=3)
    draws = np.random.default_rng(3)
    for measures in floor:
        order = draws.permutation(10)
        sample, rest = (histogram(energy(series[rows].T), EDGES) for rows in (order[:3], order[3:]))
        assert measures.kantorovich == pytest.approx(kantorovich_metric(rest, sample))
    assert len({measures.kantorovich for measures in floor}) == 5


def test_floor_sinks_as_the_root_of_the_sample_size():
    few, many = (
        np.mean(
            [
                measures.kantorovich
                for measures in sampling_floor(
                    reduce_series([random_series(size, 100)], energy, EDGES),
                    None,
                    40,
                    np.random.default_rng(4),
                )
            ]
        )
        for size in (16, 256)
    )
    assert 3 < few / many < 5.3


def test_floor_needs_two_parts():
    whole = reduce_series([random_series(3)], energy, EDGES)
    for size in (0, 3):
        with pytest.raises(ValueError, match="split"):
            sampling_floor(whole, None, 1, np.random.default_rng(0), sample=size)
    with pytest.raises(ValueError, match="split"):
        sampling_floor(
            reduce_series([random_series(1)], energy, EDGES), None, 1, np.random.default_rng(0)
        )
