"""Other choices of the training series, and the scatter that they cause."""

import numpy as np
import pytest
import scipy.stats
from hypothesis import given
from hypothesis import strategies as st

from burstcast.data.training_realisations import (
    DRAWS,
    draw_training_series,
    rows_of_drawn_series,
    rows_of_realisation,
    trained_first,
    variance_components,
)


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


@given(st.data())
def test_chosen_series_come_first_and_the_others_stay(data):
    kept = data.draw(st.integers(4, 30))
    training = data.draw(st.integers(1, kept // 2))
    chosen = np.array(data.draw(st.permutations(range(kept))))[:training]
    rows = trained_first(kept, chosen)
    assert rows[:training].tolist() == chosen.tolist()
    assert sorted(rows.tolist()) == list(range(kept))
    for row in set(range(training, kept)) - set(chosen.tolist()):
        assert rows[row] == row


def drawn(shares, candidates, training, wanted, seed=0):
    generators = [np.random.default_rng([seed, number]) for number in range(len(wanted))]
    return draw_training_series(shares, candidates, training, wanted, generators)


@given(st.integers(0, 100))
def test_drawn_sets_share_no_series_and_leave_out_the_test_series(seed):
    shares = np.random.default_rng(seed).beta(2, 12, size=80)
    candidates = np.delete(np.arange(80), np.s_[5:45])
    sets = drawn(shares, candidates, 5, [0.1, 0.2, 0.1], seed)
    together = np.concatenate(sets)
    assert len(set(together.tolist())) == 15
    assert set(together.tolist()) <= set(candidates.tolist())
    # what is asked for later changes no earlier choice
    np.testing.assert_array_equal(drawn(shares, candidates, 5, [0.1], seed)[0], sets[0])


def test_a_drawn_set_is_the_nearest_of_many_and_random_otherwise():
    generator = np.random.default_rng(3)
    shares = generator.beta(2, 12, size=300)
    spread = shares.std() / np.sqrt(10)
    for wanted in (shares.mean(), shares.mean() + 1.5 * spread):
        (rows,) = drawn(shares, np.arange(300), 10, [wanted])
        # 1000 sets, of which some lie within a hundredth of the spread of their means
        assert abs(shares[rows].mean() - wanted) < 0.05 * spread
    # without a wish that can be met, the order of the series is that of chance
    first = [drawn(shares, np.arange(300), 10, [0.143], seed)[0] for seed in range(200)]
    counts = np.bincount(np.concatenate(first), minlength=300)
    assert scipy.stats.chisquare(counts).pvalue > 1e-3
    assert abs(np.mean([rows[0] for rows in first]) - 149.5) < 4 * 300 / np.sqrt(12 * 200)


def test_the_nearest_set_is_found_by_hand():
    shares, generator = np.array([0.1, 0.5, 0.2, 0.9]), np.random.default_rng(5)
    order = generator.random((DRAWS, 4)).argsort(axis=1)[:, :2]
    assert {0.15} < {round(float(shares[one].mean()), 6) for one in order}
    (rows,) = drawn_by(shares, 0.14, 5)
    assert sorted(rows.tolist()) == [0, 2]


def drawn_by(shares, wanted, seed):
    return draw_training_series(shares, np.arange(4), 2, [wanted], [np.random.default_rng(seed)])


def test_too_few_series_to_draw_from_are_refused():
    with pytest.raises(ValueError, match="29 series are too few for 3 choices of 10"):
        drawn(np.zeros(29), np.arange(29), 10, [0.1] * 3)


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


def test_drawn_series_come_first_and_held_ones_stay():
    shares = np.random.default_rng(2).beta(2, 12, size=60)
    generators = [np.random.default_rng([7, number]) for number in range(2)]
    rows = rows_of_drawn_series(shares, 4, 30, ["all", 0.2], generators)
    assert sorted(rows.tolist()) == list(range(60))
    np.testing.assert_array_equal(rows[4:34], np.arange(4, 34))
    candidates = [*range(4), *range(34, 60)]
    first = drawn(shares, np.array(candidates), 4, [shares.mean()], 7)[0]
    # the last choice, of 1000 sets of what the first one leaves
    assert not {*first.tolist()} & {*rows[:4].tolist()}
    assert abs(shares[rows[:4]].mean() - 0.2) < 0.01
