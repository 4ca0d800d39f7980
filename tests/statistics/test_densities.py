"""Histograms, distances of densities, reductions of series and profiles, with their intervals."""

import dataclasses
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import trapezoid
from scipy.stats import wasserstein_distance

from burstcast.base.files.netcdf import read_record, variables_of, write_netcdf
from burstcast.base.resampling import bootstrap_weights
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
from burstcast.statistics.measures import StatisticsErrors, compare, nearest, sampling_floor
from burstcast.statistics.profiles import (
    equally_spaced_profiles,
    normalised_root_mean_square_error,
)
from burstcast.statistics.reductions import SeriesAccumulator, SeriesReductions, reduce_series
from burstcast.statistics.statistics_files import statistics_variables
from burstcast.systems.flow_grid import make_flow_grid
from burstcast.systems.lorenz63 import Lorenz63
from burstcast.systems.mfe import MoehlisFaisstEckhardt
from burstcast.systems.mfe_modes import flow_modes

EDGES = np.array([0.0, 0.125, 0.5, 0.75, 1.0])
WIDTHS = np.diff(EDGES)
bin_counts = st.lists(st.integers(0, 30), min_size=4, max_size=4).filter(any)
samples = st.lists(st.floats(-2, 3, allow_subnormal=False), min_size=1, max_size=40)
beyond = st.integers(0, 9)


def filled(counts, below=0, above=0):
    return Histogram(EDGES, np.array(counts, dtype=np.int64), below, above)


@given(samples)
def test_histogram_density_and_cumulative_are_numpys(values):
    # the edges themselves are where implementations differ
    values = np.concatenate([values, EDGES, [np.nextafter(1.0, 2.0), np.nextafter(0.0, -1.0)]])
    result = histogram(values, EDGES)
    np.testing.assert_array_equal(result.counts, np.histogram(values, EDGES)[0])
    assert result.below == (values < 0).sum()
    assert result.above == (values > 1).sum()
    assert result.below + result.inside + result.above == len(values)
    density = np.histogram(values, EDGES, density=True)[0]
    np.testing.assert_allclose(result.density, density)
    np.testing.assert_allclose(result.cumulative, [0, *np.cumsum(density * WIDTHS)], atol=1e-14)
    assert result.cumulative[-1] == 1


def test_bin_edges_are_equally_spaced_and_what_is_empty_has_no_density():
    np.testing.assert_allclose(bin_edges(0.0, 0.5, 5), [0, 0.1, 0.2, 0.3, 0.4, 0.5])
    empty, other = filled([0, 0, 0, 0], above=3), filled([1, 0, 0, 0])
    assert np.isnan(empty.density).all()
    assert np.isnan(kantorovich_metric(empty, other))
    assert np.isnan(mean_logarithmic_error(other, empty))


@given(bin_counts, bin_counts, beyond, beyond)
def test_kantorovich_metric_is_the_integral_of_the_difference_and_scipys(
    first_counts, two, below, above
):
    first, second = filled(first_counts, below, above), filled(two)
    grid = np.linspace(0, 1, 40001)
    cumulative = [np.interp(grid, EDGES, result.cumulative) for result in (first, second)]
    expected = trapezoid(np.abs(cumulative[0] - cumulative[1]), grid)
    assert kantorovich_metric(first, second) == pytest.approx(expected, abs=1e-8)
    assert kantorovich_metric(first, first) == 0
    # bins that are filled evenly, by a thousand values each eighth
    values = (np.arange(8000) + 0.5) / 8000
    weights = [np.repeat(result.density, (8000 * WIDTHS).astype(int)) for result in (first, second)]
    theirs = wasserstein_distance(values, values, *weights)
    assert kantorovich_metric(first, second) == pytest.approx(theirs, abs=2e-4)


@given(bin_counts, bin_counts, beyond, beyond)
def test_mean_logarithmic_error_is_that_of_a_plain_loop(first, second, below, above):
    """A bin that is empty in either counts one; no other error is cut off."""
    errors = [
        abs(math.log10(first_counts / sum(first)) - math.log10(two / sum(second)))
        if first_counts and two
        else 1.0
        for first_counts, two in zip(first, second, strict=True)
    ]
    result = mean_logarithmic_error(filled(first, below, above), filled(second))
    assert result == pytest.approx(sum(errors) / 4)


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
    counts = [np.asarray(row, np.int64).reshape(-1, 4) for row in counts]
    rows = [np.asarray(row, np.int64) for row in rows]
    return density_interval(EDGES, counts, rows, generator=generator, **how)


@given(st.integers(0, 99), st.floats(0.5, 0.99))
def test_density_interval_is_that_of_flows_drawn_one_by_one(seed, confidence):
    """Densities that share flows are resampled together."""
    rows = [[4, 0, 7, 5], [7, 2], [3]]
    generator = np.random.default_rng(seed)
    counts = [generator.poisson(2, (len(row), 4)) for row in rows[:2]] + [np.zeros((1, 4))]
    means = []
    for weights in bootstrap_weights(6, 40, np.random.default_rng(0)):
        times = dict(zip([0, 2, 3, 4, 5, 7], weights, strict=True))
        sums = [
            sum(times[row] * flow for row, flow in zip(row, flows, strict=True))
            for row, flows in zip(rows, counts, strict=True)
        ]
        densities = [of_rows / of_rows.sum() / WIDTHS for of_rows in sums if of_rows.sum()]
        means.append(np.mean(densities, axis=0) if densities else np.full(4, np.nan))
    ends = np.nanquantile(means, [(1 - confidence) / 2, (1 + confidence) / 2], axis=0)
    np.testing.assert_allclose(interval(counts, rows, 40, confidence), ends, atol=1e-12)
    for none in (interval([[]], [[]]), interval([np.zeros((3, 4))], [[0, 1, 2]])):
        assert np.isnan(none).all()


# -- reductions of series --------------------------------------------------------------------------

ENERGIES = np.linspace(0.5, 8.0, 21)
ALL = slice(None)


def energy(state):
    return 0.5 * np.square(state).sum(axis=0)


def random_series(series=7, time=150, dimension=9, seed=0):
    return np.random.default_rng(seed).normal(0.2, 1.0, (series, time, dimension))


def reduced(series, edges=ENERGIES):
    return reduce_series([series], energy, edges)


def same(first, second):
    return all(np.array_equal(getattr(first, name), getattr(second, name)) for name in vars(first))


@pytest.mark.parametrize(
    "rows", [ALL, np.array([1, 4]), np.arange(7) % 3 == 1, np.array([5, 2, 5]), np.zeros(7, bool)]
)
def test_merged_reductions_are_those_of_all_values_of_the_chosen_series(rows):
    series = random_series()
    whole = reduced(series)
    result, flat = whole.merged(rows), series[rows].reshape(-1, 9)
    counts, _ = np.histogram(energy(flat.T), ENERGIES)
    np.testing.assert_array_equal(result.histogram.counts, counts)
    assert result.histogram.below + result.histogram.inside + result.histogram.above == len(flat)
    assert (len(whole), result.moments.count) == (7, len(flat))
    if len(flat):
        np.testing.assert_allclose(result.moments.mean, flat.mean(axis=0), atol=1e-14)
        mean_product = flat.T @ flat / len(flat)
        np.testing.assert_allclose(result.moments.mean_product, mean_product, atol=1e-13)
    else:
        assert np.isnan(result.moments.mean).all()


@given(
    st.lists(st.integers(0, 6), unique=True),
    st.lists(st.integers(1, 149), unique=True),
    st.integers(1, 200),
)
def test_reductions_do_not_depend_on_how_series_are_cut_up(between, times, block):
    series = random_series()
    whole = reduced(series)
    blocks = [part for part in np.split(series, sorted(between)) if len(part)]
    accumulator = SeriesAccumulator(7, 9, ENERGIES)
    # rows in another order: each goes to its own series
    rows = np.array([3, 0, 1, 2, 6, 5, 4])
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(reductions, "STEPS_PER_BLOCK", block)
        assert same(reduce_series(blocks, energy, ENERGIES), whole)
        for piece in np.split(series.transpose(1, 2, 0)[..., rows], sorted(times)):
            accumulator.add(rows, piece, energy(piece.transpose(1, 0, 2)))
    taken = accumulator.reductions()
    assert same(taken, whole)
    accumulator.add(rows, piece, energy(piece.transpose(1, 0, 2)))
    assert same(taken, whole)


def test_profiles_and_midplane_are_the_averages_of_the_fields():
    system = MoehlisFaisstEckhardt(400.0, length_x=5.0, length_z=3.0)
    modes, series = flow_modes(system), random_series(2, 20)
    statistics = reduce_series([series], system.observable, ENERGIES).merged(ALL)
    x, z = np.arange(16) * 5.0 / 16, np.arange(12) * 3.0 / 12
    grid = np.meshgrid(x, np.linspace(-1, 1, 9), z, indexing="ij", sparse=True)
    u, v, _ = modes.velocity(series.reshape(-1, 9).T, *grid)
    moments, matrices = statistics.moments, equally_spaced_profiles(system, 9)
    result = matrices.profiles(moments.mean, moments.mean_product)
    for profile, field in zip(result, (u, u * u, u * v), strict=True):
        np.testing.assert_allclose(profile, field.mean(axis=(0, 1, 3)), atol=1e-12)
    plane = np.square(u[:, :, 4]).mean(axis=0)
    result = modes.midplane_mean_square(moments.mean_product, x, z)
    np.testing.assert_allclose(result, plane, atol=1e-12)
    grid = make_flow_grid(system, (3, 5, 7))
    for result, ends, count in ((grid.x, (0, 5), 3), (grid.y, (-1, 1), 5), (grid.z, (0, 3), 7)):
        np.testing.assert_array_equal(result, np.linspace(*ends, count))


# -- measures of statistics ------------------------------------------------------------------------

MATRICES = flow_modes(MoehlisFaisstEckhardt(400.0)).profile_matrices(np.linspace(-1, 1, 21))
NAMES = [field.name for field in dataclasses.fields(StatisticsErrors)]
# bins that are all filled: an empty one counts in the mean logarithmic error
FULL = np.linspace(2.0, 7.0, 11)


def test_compare_measures_each_thing_against_the_reference():
    whole = reduced(random_series(20))
    reference, candidate = whole.merged(ALL), whole.merged(np.arange(3))
    result = compare(reference, candidate, MATRICES)
    assert result.kantorovich == kantorovich_metric(reference.histogram, candidate.histogram)
    assert result.mean_log_error == mean_logarithmic_error(reference.histogram, candidate.histogram)
    true, others = (
        MATRICES.profiles(each.moments.mean, each.moments.mean_product)
        for each in (reference, candidate)
    )
    for name, profile, other in zip(("u", "uu", "uv"), true, others, strict=True):
        error = getattr(result, f"nrmse_{name}")
        # the range of the reference, not of the candidate
        difference = other - profile
        assert error == pytest.approx(np.sqrt(np.mean(difference**2)) / np.ptp(profile))


def test_comparison_with_itself_finds_nothing_and_without_series_nothing_defined():
    whole = reduced(random_series(), FULL)
    every, two, none = (whole.merged(np.arange(number)) for number in (7, 2, 0))
    assert compare(every, every, MATRICES) == StatisticsErrors(0, 0, 0, 0, 0)
    assert np.isnan(list(vars(compare(every, none, MATRICES)).values())).all()
    assert flow_modes(Lorenz63()) is equally_spaced_profiles(Lorenz63(), 9) is None
    without = compare(every, two, None)
    assert np.isnan([without.nrmse_u, without.nrmse_uu, without.nrmse_uv]).all()
    assert without.kantorovich > 0


def test_the_nearest_candidate_is_that_of_the_smallest_kantorovich_metric():
    whole = reduced(random_series(), FULL)
    reference, none = whole.merged(ALL), whole.merged(np.array([], dtype=int))
    parts = [whole.merged(np.arange(number)) for number in (1, 3)]
    distances = [compare(reference, part, None).kantorovich for part in parts]
    assert nearest(reference, [none, *parts]) == 1 + int(np.argmin(distances))
    assert nearest(reference, [none, *parts, reference]) == 3
    assert nearest(reference, [none]) is None
    assert nearest(reference, []) is None


def test_the_sampling_floor_is_the_distance_of_disjoint_parts():
    series = random_series(10)
    for sample, size in ((3, 3), (None, 5)):
        result = sampling_floor(reduced(series), MATRICES, 5, np.random.default_rng(3), sample)
        draws = np.random.default_rng(3)
        for measures in result:
            order = draws.permutation(10)
            parts = [reduced(series[rows]).merged(ALL) for rows in (order[size:], order[:size])]
            assert vars(measures) == pytest.approx(vars(compare(*parts, MATRICES)), rel=1e-9)
        assert len({measures.kantorovich for measures in result}) == 5


def test_each_sample_of_resampled_measures_is_compared_as_if_its_runs_were_all():
    # series of different means: what is resampled are series, not values
    means = np.random.default_rng(2).normal(0.3, 0.3, (12, 1, 9))
    runs = means + random_series(12, 40, seed=4)
    reference = reduced(random_series(60, 40, seed=1)).merged(ALL)
    kept = np.arange(12) % 4 != 1
    weights = bootstrap_weights(12, 8, np.random.default_rng(3))
    weights[7, kept] = 0  # no run that counts
    for matrices in (MATRICES, None):
        result = resampled_measures(reference, reduced(runs), kept, matrices, weights)
        assert list(result) == NAMES
        for number, weight in enumerate(weights):
            drawn = np.repeat(np.arange(12)[kept], weight[kept])
            candidate = reduced(runs[drawn]).merged(ALL)
            expected = compare(reference, candidate, matrices)
            for name in NAMES:
                theirs = pytest.approx(getattr(expected, name), rel=1e-12, nan_ok=True)
                assert result[name][number] == theirs
        assert np.isnan(result["kantorovich"]).tolist() == [False] * 7 + [True]


def test_reductions_come_back_from_their_file(tmp_path):
    result = reduced(random_series(5))
    path = tmp_path / "long_term.nc"
    statistics = statistics_variables(result.merged(slice(1, 3)))
    write_netcdf(path, {**statistics, **variables_of(result)}, {})
    assert same(read_record(path, SeriesReductions), result)


def floor_of(series, **settings):
    whole = reduced(random_series(series))
    return sampling_floor(whole, None, 1, np.random.default_rng(0), **settings)


ONES, OTHER = filled([1, 1, 1, 1]), Histogram(EDGES + 1e-9, np.ones(4, dtype=np.int64))
NRMSE = normalised_root_mean_square_error


@pytest.mark.parametrize(
    ("made", "message"),
    [
        (lambda: histogram(np.array([0.2, np.nan]), EDGES), "not finite"),
        (lambda: histogram(np.array([0.2]), np.array([0.0, 1.0, 1.0])), "increase"),
        (lambda: Histogram(EDGES, np.array([1, 2])), "bound"),
        (lambda: filled([1, -1, 0, 0]), "negative"),
        (lambda: filled([1, 1, 0, 0], -1), "negative"),
        (lambda: filled([1, 1, 0, 0], 0, -1), "negative"),
        (lambda: kantorovich_metric(ONES, OTHER), "common bins"),
        (lambda: mean_logarithmic_error(ONES, OTHER), "common bins"),
        (lambda: mean_density([]), "no density"),
        (lambda: mean_density([ONES, OTHER]), "common bins"),
        (lambda: reduced(np.full((2, 5, 9), np.nan)), "no value that is finite"),
        (lambda: reduce_series([], energy, ENERGIES), "no series"),
        *((lambda size=size: floor_of(3, sample=size), "split") for size in (0, 3)),
        (lambda: floor_of(1), "split"),
        (lambda: make_flow_grid(Lorenz63(), (4, 3, 4)), "system Lorenz63 has no velocity field"),
        (lambda: NRMSE(np.ones(3), np.arange(3.0)), "constant"),
        (lambda: NRMSE(np.arange(3.0), np.arange(2.0)), "compared"),
    ],
)
def test_what_makes_no_sense_is_refused(made, message):
    with pytest.raises(ValueError, match=message):
        made()
