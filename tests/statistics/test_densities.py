"""Histograms, distances of densities, reductions of series and profiles, with their intervals."""

import dataclasses
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import trapezoid
from scipy.stats import binom, wasserstein_distance

from burstcast.files.netcdf import read_netcdf, write_netcdf
from burstcast.statistics import reductions
from burstcast.statistics.densities import (
    Histogram,
    bin_edges,
    density_interval,
    histogram,
    kantorovich_metric,
    mean_density,
    mean_logarithmic_error,
)
from burstcast.statistics.intervals import resampled_measures
from burstcast.statistics.measures import Measures, compare, nearest, sampling_floor
from burstcast.statistics.profiles import (
    equally_spaced_profiles,
    midplane_mean_square,
    normalised_root_mean_square_error,
    velocity_profiles,
)
from burstcast.statistics.reductions import SeriesAccumulator, reduce_series
from burstcast.statistics.resampling import bootstrap_weights, percentile_interval
from burstcast.statistics.statistics_files import (
    reduction_variables,
    reductions_from,
    statistics_variables,
)
from burstcast.systems.flow_grid import make_flow_grid
from burstcast.systems.lorenz63 import Lorenz63
from burstcast.systems.mfe import MoehlisFaisstEckhardt
from burstcast.systems.mfe_modes import flow_modes

EDGES = np.linspace(0.0, 1.0, 5)
bin_counts = st.lists(st.integers(0, 30), min_size=4, max_size=4).filter(any)
samples = st.lists(st.floats(-2, 3, allow_subnormal=False), min_size=1, max_size=40)


def filled(counts, below=0, above=0):
    return Histogram(EDGES, np.array(counts, dtype=np.int64), below, above)


@given(samples)
def test_counts_are_numpys(values):
    # the edges themselves are where implementations differ
    values = np.concatenate([values, EDGES, [np.nextafter(1.0, 2.0), np.nextafter(0.0, -1.0)]])
    found = histogram(values, EDGES)
    np.testing.assert_array_equal(found.counts, np.histogram(values, EDGES)[0])
    assert found.below == (values < 0).sum()
    assert found.above == (values > 1).sum()
    assert found.below + found.inside + found.above == len(values)


def test_density_is_normalised_over_the_values_inside_and_of_nothing_undefined():
    found = Histogram(np.array([0.0, 1.0, 3.0]), np.array([1, 3]), below=7, above=2)
    np.testing.assert_allclose(found.density, [0.25, 0.375])
    np.testing.assert_allclose(found.cumulative, [0, 0.25, 1])
    empty = filled([0, 0, 0, 0], above=3)
    assert np.isnan(empty.density).all()
    assert np.isnan(kantorovich_metric(empty, filled([1, 0, 0, 0])))
    assert np.isnan(mean_logarithmic_error(filled([1, 0, 0, 0]), empty))
    np.testing.assert_allclose(bin_edges(0.0, 0.5, 5), [0, 0.1, 0.2, 0.3, 0.4, 0.5])


@given(bin_counts)
def test_cumulative_is_the_integral_of_the_density(counts):
    found = filled(counts, below=3)
    np.testing.assert_allclose(
        found.cumulative[1:], np.cumsum(found.density * np.diff(EDGES)), atol=1e-14
    )
    assert found.cumulative[0] == 0
    assert found.cumulative[-1] == 1


@given(bin_counts, bin_counts)
def test_kantorovich_metric_is_the_integral_of_the_difference(first, second):
    first, second = filled(first), filled(second)
    grid = np.linspace(0, 1, 40001)
    difference = np.interp(grid, EDGES, first.cumulative) - np.interp(
        grid, EDGES, second.cumulative
    )
    expected = trapezoid(np.abs(difference), grid)
    assert kantorovich_metric(first, second) == pytest.approx(expected, abs=1e-8)
    assert kantorovich_metric(first, first) == 0


@settings(max_examples=30)
@given(bin_counts, bin_counts)
def test_kantorovich_metric_is_scipys_for_evenly_filled_bins(first, second):
    def evenly(counts, per_value=200):
        within = (np.arange(per_value) + 0.5) / per_value / 4
        return np.concatenate(
            [np.tile(edge + within, n) for edge, n in zip(EDGES, counts, strict=False)]
        )

    expected = wasserstein_distance(evenly(first), evenly(second))
    assert kantorovich_metric(filled(first), filled(second)) == pytest.approx(expected, abs=2e-3)


def test_bins_of_the_paper_resolve_the_kantorovich_metric():
    # values as skewed as the kinetic energy; within a bin, binning may move a value by its width
    generator = np.random.default_rng(1)
    edges = np.linspace(0.015, 0.47, 201)
    first = 0.016 + 0.05 * generator.beta(0.8, 6, 40_000) / 0.12
    second = 0.016 + 0.05 * generator.beta(0.9, 6, 40_000) / 0.12
    assert first.max() < 0.47
    assert second.max() < 0.47
    exact = wasserstein_distance(first, second)
    binned = kantorovich_metric(histogram(first, edges), histogram(second, edges))
    assert binned == pytest.approx(exact, rel=0.01)


def test_mean_logarithmic_error_by_hand():
    first, second = filled([10, 80, 10, 0]), filled([1, 8, 1, 0])
    # the densities are equal; the bin that is empty in both counts one
    assert mean_logarithmic_error(first, second) == pytest.approx(0.25)
    # empty in one only: two bins of four
    first, second = filled([50, 0, 50, 0]), filled([50, 50, 0, 0])
    assert mean_logarithmic_error(first, second) == pytest.approx((0 + 1 + 1 + 1) / 4)
    # an error beyond one is not cut off
    first, second = filled([1, 0, 0, 999]), filled([500, 0, 0, 500])
    expected = (math.log10(500) + 1 + 1 + math.log10(999 / 500)) / 4
    assert mean_logarithmic_error(first, second) == pytest.approx(expected)


@given(bin_counts, bin_counts, st.integers(1, 5))
def test_mean_logarithmic_error_is_symmetric_and_knows_no_sample_size(first, second, factor):
    one = mean_logarithmic_error(filled(first), filled(second))
    assert one == pytest.approx(mean_logarithmic_error(filled(second), filled(first)))
    assert one == pytest.approx(
        mean_logarithmic_error(filled(first), filled([factor * count for count in second]))
    )


def test_values_outside_the_range_change_no_distance():
    first, second = [1, 2, 3, 4], [4, 3, 2, 1]
    outside = filled(first, below=100, above=50)
    assert kantorovich_metric(outside, filled(second)) == kantorovich_metric(
        filled(first), filled(second)
    )
    assert mean_logarithmic_error(outside, filled(second)) == mean_logarithmic_error(
        filled(first), filled(second)
    )


def test_mean_density_weighs_each_histogram_alike():
    first, second, empty = filled([1, 0, 0, 0]), filled([0, 0, 30, 10]), filled([0, 0, 0, 0])
    expected = 0.5 * (first.density + second.density)
    assert mean_density([first, second]) == pytest.approx(expected)
    # nothing is known from a histogram without values
    assert mean_density([empty, first, second]) == pytest.approx(expected)
    assert np.isnan(mean_density([empty])).all()


def interval(counts, rows, resamples=4000, confidence=0.95):
    how = {"resamples": resamples, "confidence": confidence}
    generator = np.random.default_rng(0)
    counts = [np.asarray(own, np.int64).reshape(-1, 4) for own in counts]
    rows = [np.asarray(own, np.int64) for own in rows]
    return density_interval(EDGES, counts, rows, generator=generator, **how)


def test_interval_of_a_density_is_that_of_shares_of_flows():
    """Flows that lie in one bin each: the share of one kind is binomial."""
    flows = np.repeat([[10, 0, 0, 0], [0, 0, 0, 10]], [30, 70], axis=0)
    low, high = interval([flows], [np.arange(100)])
    share = binom.ppf([0.025, 0.975], 100, 0.3) / 100 / np.diff(EDGES)[0]
    assert [low[0], high[0]] == pytest.approx(share, rel=0.02)
    assert low[1] == high[1] == 0


def test_densities_that_share_flows_are_resampled_together():
    """What one density has more of, the other has less of: their mean does not scatter."""
    one = np.repeat([[10, 0, 0, 0], [0, 0, 0, 10]], 20, axis=0)
    rows = np.arange(40)
    low, high = interval([one, one[::-1]], [rows, rows])
    assert low[0] == pytest.approx(high[0])
    low, high = interval([one, one[::-1]], [rows, rows + 40])
    assert high[0] > 1.3 * low[0]


def test_interval_of_no_values_is_none():
    assert np.isnan(interval([[]], [[]])).all()
    assert np.isnan(interval([np.zeros((3, 4))], [[0, 1, 2]])).all()
    with_an_empty_one = interval([np.zeros((2, 4)), np.ones((2, 4))], [[0, 1], [0, 1]])
    assert with_an_empty_one == pytest.approx(interval([np.ones((2, 4))], [[0, 1]]))


# -- reductions of series --------------------------------------------------------------------------

ENERGIES = np.linspace(0.5, 8.0, 21)
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
    found = reduce_series([series], energy, ENERGIES).merged(ALL)
    flat = series.reshape(-1, 9)
    np.testing.assert_array_equal(found.histogram.counts, np.histogram(energy(flat.T), ENERGIES)[0])
    assert found.histogram.below + found.histogram.inside + found.histogram.above == len(flat)
    assert found.moments.count == len(flat)
    np.testing.assert_allclose(found.moments.mean, flat.mean(axis=0), atol=1e-14)
    np.testing.assert_allclose(found.moments.mean_product, flat.T @ flat / len(flat), atol=1e-13)


def test_chosen_series_alone_are_merged():
    series = random_series()
    whole = reduce_series([series], energy, ENERGIES)
    rows = np.array([1, 4])
    alone = reduce_series([series[rows]], energy, ENERGIES)
    assert len(whole) == 7
    for chosen in (rows, np.isin(np.arange(7), rows)):
        found = whole.merged(chosen)
        expected = alone.merged(ALL)
        np.testing.assert_array_equal(found.histogram.counts, expected.histogram.counts)
        np.testing.assert_array_equal(found.moments.mean_product, expected.moments.mean_product)


def test_no_series_have_no_moments():
    found = reduce_series([random_series()], energy, ENERGIES).merged(np.zeros(7, dtype=bool))
    assert found.moments.count == 0
    assert found.histogram.inside == 0
    assert np.isnan(found.moments.mean).all()


@given(st.lists(st.integers(0, 6), unique=True), st.integers(1, 200))
def test_reductions_do_not_depend_on_how_series_are_cut_up(cuts, block):
    series = random_series()
    whole = reduce_series([series], energy, ENERGIES)
    blocks = [part for part in np.split(series, sorted(cuts)) if len(part)]
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(reductions, "STEPS_PER_BLOCK", block)
        assert same(reduce_series(blocks, energy, ENERGIES), whole)


@given(st.lists(st.integers(1, 149), unique=True))
def test_series_may_be_added_in_pieces_of_time(cuts):
    series = random_series()
    whole = reduce_series([series], energy, ENERGIES)
    accumulator = SeriesAccumulator(7, 9, ENERGIES)
    states = series.transpose(1, 2, 0)
    for piece in np.split(states, sorted(cuts)):
        # rows in another order: each goes to its own series
        rows = np.array([3, 0, 1, 2, 6, 5, 4])
        part = piece[..., rows]
        accumulator.add(rows, part, energy(part.transpose(1, 0, 2)))
    assert same(accumulator.reductions(), whole)


def test_reductions_already_taken_do_not_change():
    series = random_series()
    accumulator = SeriesAccumulator(7, 9, ENERGIES)
    states = series.transpose(1, 2, 0)
    accumulator.add(np.arange(7), states, energy(states.transpose(1, 0, 2)))
    taken = accumulator.reductions()
    accumulator.add(np.arange(7), states, energy(states.transpose(1, 0, 2)))
    assert same(taken, reduce_series([series], energy, ENERGIES))


def test_profiles_and_midplane_are_the_averages_of_the_fields():
    system = MoehlisFaisstEckhardt(400.0, length_x=5.0, length_z=3.0)
    modes = flow_modes(system)
    series = random_series(2, 20)
    moments = reduce_series([series], system.observable, ENERGIES).merged(ALL).moments
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


def test_a_system_without_velocities_has_no_modes_and_a_grid_is_the_whole_domain():
    grid = make_flow_grid(MoehlisFaisstEckhardt(400.0, length_x=5.0, length_z=3.0), (3, 5, 7))
    for found, ends, count in ((grid.x, (0, 5), 3), (grid.y, (-1, 1), 5), (grid.z, (0, 3), 7)):
        np.testing.assert_array_equal(found, np.linspace(*ends, count))
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
    whole = reduce_series([random_series(20)], energy, ENERGIES)
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


def test_the_floor_is_the_distance_of_disjoint_parts_and_sinks_as_the_root_of_their_size():
    series = random_series(10)
    whole = reduce_series([series], energy, ENERGIES)
    floor = sampling_floor(whole, MATRICES, 5, np.random.default_rng(3), sample=3)
    draws = np.random.default_rng(3)
    for measures in floor:
        order = draws.permutation(10)
        sample, rest = (
            histogram(energy(series[rows].T), ENERGIES) for rows in (order[:3], order[3:])
        )
        assert measures.kantorovich == pytest.approx(kantorovich_metric(rest, sample))
    assert len({measures.kantorovich for measures in floor}) == 5
    distances = []
    for size in (16, 256):
        whole = reduce_series([random_series(size, 100)], energy, ENERGIES)
        floor = sampling_floor(whole, None, 40, np.random.default_rng(4))
        distances.append(np.mean([measures.kantorovich for measures in floor]))
    assert 3 < distances[0] / distances[1] < 5.3


# -- bootstrap samples of long runs ----------------------------------------------------------------
COARSE = flow_modes(MoehlisFaisstEckhardt(400.0)).profile_matrices(np.linspace(-1, 1, 11))
NAMES = [field.name for field in dataclasses.fields(Measures)]


def series(count, seed, shift=0.0):
    """Series of different means: what is resampled are series, not values."""
    generator = np.random.default_rng(seed)
    means = generator.normal(0.2 + shift, 0.3, (count, 1, 9))
    return means + generator.normal(0.0, 1.0, (count, 40, 9))


REFERENCE = reduce_series([series(60, 1)], energy, ENERGIES).merged(slice(None))


def test_each_sample_is_compared_as_if_its_runs_were_all():
    runs = series(12, 2, shift=0.1)
    kept = np.arange(12) % 4 != 1
    weights = bootstrap_weights(12, 8, np.random.default_rng(3))
    reductions = reduce_series([runs], energy, ENERGIES)
    found = resampled_measures(REFERENCE, reductions, kept, COARSE, weights)
    assert list(found) == NAMES
    for number, weight in enumerate(weights):
        drawn = np.concatenate(
            [np.repeat(runs[row : row + 1], weight[row], axis=0) for row in np.flatnonzero(kept)]
        )
        candidate = reduce_series([drawn], energy, ENERGIES).merged(slice(None))
        expected = compare(REFERENCE, candidate, COARSE)
        for name in NAMES:
            assert found[name][number] == pytest.approx(getattr(expected, name), rel=1e-12)


def test_a_sample_without_runs_that_count_has_no_measures():
    reductions = reduce_series([series(3, 4)], energy, ENERGIES)
    kept = np.array([True, False, False])
    weights = np.array([[0, 2, 1], [1, 1, 1]])
    found = resampled_measures(REFERENCE, reductions, kept, None, weights)
    assert np.isnan(found["kantorovich"]).tolist() == [True, False]
    assert np.isnan(found["nrmse_u"]).all()  # without velocities there are no profiles


def test_intervals_are_as_wide_as_the_scatter_of_other_runs():
    # far from the reference, where a distance scatters as a mean does
    reductions = reduce_series([series(40, 5, shift=0.5)], energy, ENERGIES)
    weights = bootstrap_weights(40, 400, np.random.default_rng(6))
    kept = np.ones(40, dtype=bool)
    samples = resampled_measures(REFERENCE, reductions, kept, None, weights)["kantorovich"]
    low, high = percentile_interval(samples, 0.95)
    others = []
    for seed in range(100, 300):
        other = reduce_series([series(40, seed, shift=0.5)], energy, ENERGIES).merged(slice(None))
        others.append(compare(REFERENCE, other, None).kantorovich)
    assert (high - low) / 3.92 == pytest.approx(np.std(others), rel=0.2)


def test_reductions_come_back_from_their_file(tmp_path):
    reductions = reduce_series([series(5, 7)], energy, ENERGIES)
    path = tmp_path / "long_term.nc"
    statistics = statistics_variables(reductions.merged(slice(1, 3)))
    write_netcdf(path, {**statistics, **reduction_variables(reductions)}, {})
    found = reductions_from(read_netcdf(path))
    for name in ("edges", "counts", "sums", "product_sums"):
        np.testing.assert_array_equal(getattr(found, name), getattr(reductions, name))


def floor_of(series, **settings):
    whole = reduce_series([random_series(series)], energy, ENERGIES)
    return sampling_floor(whole, None, 1, np.random.default_rng(0), **settings)


OTHER = Histogram(EDGES + 1e-9, np.ones(4, dtype=np.int64))


@pytest.mark.parametrize(
    ("made", "message"),
    [
        (lambda: histogram(np.array([0.2, np.nan]), EDGES), "not finite"),
        (lambda: histogram(np.array([0.2]), np.array([0.0, 1.0, 1.0])), "increase"),
        (lambda: Histogram(EDGES, np.array([1, 2])), "bound"),
        (lambda: filled([1, -1, 0, 0]), "negative"),
        (lambda: kantorovich_metric(filled([1, 1, 1, 1]), OTHER), "common bins"),
        (lambda: mean_logarithmic_error(filled([1, 1, 1, 1]), OTHER), "common bins"),
        (lambda: mean_density([]), "no density"),
        (lambda: mean_density([filled([1, 0, 0, 0]), OTHER]), "common bins"),
        (lambda: reduce_series([np.full((2, 5, 9), np.nan)], energy, ENERGIES), "not finite"),
        (lambda: reduce_series([], energy, ENERGIES), "no series"),
        *((lambda size=size: floor_of(3, sample=size), "split") for size in (0, 3)),
        (lambda: floor_of(1), "split"),
    ],
)
def test_what_makes_no_sense_is_refused(made, message):
    with pytest.raises(ValueError, match=message):
        made()
