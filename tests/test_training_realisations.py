"""Other choices of the training series, and the scatter that they cause."""

import numpy as np
import pytest
import scipy.stats
from hypothesis import given
from hypothesis import strategies as st

from burstcast.data.training_realisations import rows_of_realisation, variance_components


@given(st.integers(1, 6), st.integers(0, 5), st.integers(0, 30))
def test_choices_share_no_series_and_leave_the_others_where_they_are(training, count, between):
    kept = training * (count + 1) + between
    chosen = [rows_of_realisation(kept, training, number) for number in range(count + 1)]
    np.testing.assert_array_equal(chosen[0], np.arange(kept))
    trained = np.concatenate([rows[:training] for rows in chosen])
    assert len(set(trained.tolist())) == len(trained)
    for rows in chosen:
        assert sorted(rows.tolist()) == list(range(kept))
        middle = slice(training, training + between)
        np.testing.assert_array_equal(rows[middle], np.arange(kept)[middle])


def test_an_ensemble_that_is_too_small_is_refused():
    with pytest.raises(ValueError, match="29 series are too few for 3 choices of 10"):
        rows_of_realisation(29, 10, 2)


@given(st.integers(0, 1000), st.integers(2, 6), st.integers(2, 5))
def test_components_are_those_of_the_analysis_of_variance(seed, groups, members):
    generator = np.random.default_rng(seed)
    values = generator.normal(size=(groups, members)) + generator.normal(size=(groups, 1))
    found = variance_components(list(values))
    within = values.var(axis=1, ddof=1).mean()
    assert found.within == pytest.approx(np.sqrt(within))
    # scipy's F is the ratio of the mean squares
    mean_square = scipy.stats.f_oneway(*values).statistic * within
    expected = max(0.0, (mean_square - within) / members)
    assert found.between == pytest.approx(np.sqrt(expected), abs=1e-9)
    assert found.mean == pytest.approx(values.mean())
    assert (found.groups, found.values) == (groups, groups * members)


def test_known_components_are_found():
    generator = np.random.default_rng(0)
    sizes = generator.integers(2, 6, size=3000)
    groups = [3.0 * generator.normal() + 0.5 * generator.normal(size=size) for size in sizes]
    found = variance_components(groups)
    assert found.between == pytest.approx(3.0, rel=0.05)
    assert found.within == pytest.approx(0.5, rel=0.05)


def test_what_is_not_known_is_not_told():
    single = variance_components([np.array([1.0]), np.array([3.0]), np.empty(0)])
    assert single.between == pytest.approx(np.sqrt(2.0))
    assert np.isnan(single.within)
    assert (single.groups, single.values) == (2, 2)
    alone = variance_components([np.array([1.0, 2.0])])
    assert np.isnan(alone.between)
    assert alone.within == pytest.approx(np.sqrt(0.5))
    assert variance_components([]).groups == 0
