"""Bootstrap samples of long runs, against the statistics of the series that each of them holds."""

import dataclasses

import numpy as np
import pytest

from burstcast.files.netcdf import read_netcdf, write_netcdf
from burstcast.statistics.intervals import resampled_measures
from burstcast.statistics.measures import Measures, compare
from burstcast.statistics.reductions import reduce_series
from burstcast.statistics.resampling import bootstrap_weights, percentile_interval
from burstcast.statistics.statistics_files import (
    reduction_variables,
    reductions_from,
    statistics_variables,
)
from burstcast.systems.mfe import MoehlisFaisstEckhardt
from burstcast.systems.mfe_modes import flow_modes

EDGES = np.linspace(0.5, 8.0, 21)
MATRICES = flow_modes(MoehlisFaisstEckhardt(400.0)).profile_matrices(np.linspace(-1, 1, 11))
NAMES = [field.name for field in dataclasses.fields(Measures)]


def energy(state):
    return 0.5 * np.square(state).sum(axis=0)


def series(count, seed, shift=0.0):
    """Series of different means: what is resampled are series, not values."""
    generator = np.random.default_rng(seed)
    means = generator.normal(0.2 + shift, 0.3, (count, 1, 9))
    return means + generator.normal(0.0, 1.0, (count, 40, 9))


REFERENCE = reduce_series([series(60, 1)], energy, EDGES).merged(slice(None))


def test_each_sample_is_compared_as_if_its_runs_were_all():
    runs = series(12, 2, shift=0.1)
    kept = np.arange(12) % 4 != 1
    weights = bootstrap_weights(12, 8, np.random.default_rng(3))
    reductions = reduce_series([runs], energy, EDGES)
    found = resampled_measures(REFERENCE, reductions, kept, MATRICES, weights)
    assert list(found) == NAMES
    for number, weight in enumerate(weights):
        drawn = np.concatenate(
            [np.repeat(runs[row : row + 1], weight[row], axis=0) for row in np.flatnonzero(kept)]
        )
        candidate = reduce_series([drawn], energy, EDGES).merged(slice(None))
        expected = compare(REFERENCE, candidate, MATRICES)
        for name in NAMES:
            assert found[name][number] == pytest.approx(getattr(expected, name), rel=1e-12)


def test_a_sample_without_runs_that_count_has_no_measures():
    reductions = reduce_series([series(3, 4)], energy, EDGES)
    kept = np.array([True, False, False])
    weights = np.array([[0, 2, 1], [1, 1, 1]])
    found = resampled_measures(REFERENCE, reductions, kept, None, weights)
    assert np.isnan(found["kantorovich"]).tolist() == [True, False]
    assert np.isnan(found["nrmse_u"]).all()  # without velocities there are no profiles


def test_intervals_are_as_wide_as_the_scatter_of_other_runs():
    # far from the reference, where a distance scatters as a mean does
    reductions = reduce_series([series(40, 5, shift=0.5)], energy, EDGES)
    weights = bootstrap_weights(40, 400, np.random.default_rng(6))
    kept = np.ones(40, dtype=bool)
    samples = resampled_measures(REFERENCE, reductions, kept, None, weights)["kantorovich"]
    low, high = percentile_interval(samples, 0.95)
    others = [
        compare(
            REFERENCE,
            reduce_series([series(40, seed, shift=0.5)], energy, EDGES).merged(slice(None)),
            None,
        ).kantorovich
        for seed in range(100, 300)
    ]
    assert (high - low) / 3.92 == pytest.approx(np.std(others), rel=0.2)


def test_reductions_come_back_from_their_file(tmp_path):
    reductions = reduce_series([series(5, 7)], energy, EDGES)
    path = tmp_path / "long_term.nc"
    statistics = statistics_variables(reductions.merged(slice(1, 3)))
    write_netcdf(path, {**statistics, **reduction_variables(reductions)}, {})
    found = reductions_from(read_netcdf(path))
    for name in ("edges", "counts", "sums", "product_sums"):
        np.testing.assert_array_equal(getattr(found, name), getattr(reductions, name))
