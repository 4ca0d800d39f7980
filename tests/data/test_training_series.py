"""Training series: other choices of them, under schedules, with factors of parameters."""

from itertools import pairwise

import numpy as np
import pytest
import scipy.stats
from hypothesis import given
from hypothesis import strategies as st
from sklearn.preprocessing import PolynomialFeatures

from burstcast.data.scheduled_series import (
    RandomActuation,
    TrainingSet,
    scheduled_variables,
    simulated_series,
)
from burstcast.data.training_realisations import (
    draw_training_series,
    rows_of_drawn_series,
    rows_of_realisation,
    trained_first,
    variance_components,
)
from burstcast.forecasters._parameter_factors import ParameterFactors
from burstcast.systems.integration import integrate
from burstcast.systems.mfe import MoehlisFaisstEckhardt
from burstcast.systems.parameters import SystemParameters, integrate_scheduled


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


@given(st.integers(0, 1000), st.lists(st.integers(2, 5), min_size=2, max_size=6))
def test_components_are_those_of_the_analysis_of_variance(seed, sizes):
    generator = np.random.default_rng(seed)
    groups = [generator.normal(size=size) + generator.normal() for size in sizes]
    components, number = variance_components(groups), sum(sizes)
    within = sum(size * group.var() for size, group in zip(sizes, groups, strict=True))
    within /= number - len(sizes)
    assert components.within == pytest.approx(np.sqrt(within))
    # scipy's F is the ratio of the mean squares, which means over a typical size
    mean_square = scipy.stats.f_oneway(*groups).statistic * within
    typical = (number - np.square(sizes).sum() / number) / (len(sizes) - 1)
    expected = max(0.0, (mean_square - within) / typical)
    assert components.between == pytest.approx(np.sqrt(expected), abs=1e-6)
    assert components.mean == pytest.approx(np.concatenate(groups).mean())
    assert (components.groups, components.values) == (len(sizes), number)


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


# -- under schedules -------------------------------------------------------------------------------

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
    on, off = (steps / 15 for steps in stretch_lengths(acting))
    assert (on == on.astype(int)).all()
    assert on.mean() == pytest.approx(3.0, abs=5 * 2.5 / np.sqrt(len(on)))
    assert off.mean() == pytest.approx(9.0, abs=5 * 8.5 / np.sqrt(len(off)))
    # geometric: a stretch of one interval has the probability 1 / mean
    assert (on == 1).mean() == pytest.approx(1 / 3, abs=0.02)
    assert acting.mean() == pytest.approx(0.25, abs=0.01)
    many = RandomActuation(15, 3.0, 9.0).draw(4000, 15, np.random.default_rng(2))
    assert many[:, 0].mean() == pytest.approx(0.25, abs=0.03)
    fewer = RandomActuation(15, 3.0, 9.0).draw(3, 15, np.random.default_rng(2))
    assert np.array_equal(many[:3], fewer)


def test_series_are_those_of_integration_and_the_first_that_do_not_laminarise():
    start = np.array([1, 0, 0.07066, -0.07076, 0, 0, 0, 0, 0])[:, np.newaxis]
    perturbed = start + 0.01 * np.random.default_rng(2).random((9, 12))
    perturbed = integrate(MFE, perturbed, 0.25, 2400, 2400)[-1]
    perturbed[:, [1, 4]] = 0.0
    perturbed[0, [1, 4]] = 1.0  # laminar from the first
    acting = RandomActuation(15, 3.0, 9.0).draw(12, 300, np.random.default_rng(3))
    schedules = np.where(acting, 2000.0, 400.0)[:, :, np.newaxis]
    settings = {"time_step": 0.25, "sampling_stride": 4, "laminarisation_threshold": 0.48}
    states, in_force = simulated_series(REYNOLDS, MFE, perturbed, schedules, 5, **settings)
    rows = np.flatnonzero((schedules[:, np.newaxis] == in_force).all(axis=(2, 3)).any(axis=1))
    together = integrate_scheduled(REYNOLDS, schedules.transpose(1, 2, 0), perturbed, 0.25, 4)
    every = integrate_scheduled(
        REYNOLDS, np.repeat(schedules.transpose(1, 2, 0), 4, axis=0), perturbed, 0.25
    )
    quiet = (MFE.observable(every.transpose(1, 0, 2)) <= 0.48).all(axis=0)
    assert rows.tolist() == np.flatnonzero(quiet)[:5].tolist()
    assert 1 not in rows
    assert np.array_equal(states, together[:, :, rows].transpose(2, 0, 1))
    assert np.array_equal(in_force, schedules[rows])
    # as many as are left are enough, one more is not
    left = int(quiet.sum())
    _, in_force = simulated_series(REYNOLDS, MFE, perturbed, schedules, left, **settings)
    assert np.array_equal(in_force, schedules[quiet])
    with pytest.raises(ValueError, match=rf"^{left} of 12 flows .* but {left + 1} are wanted"):
        simulated_series(REYNOLDS, MFE, perturbed, schedules, left + 1, **settings)
    with pytest.raises(ValueError, match=r"but 12 are wanted: give more initial states"):
        simulated_series(REYNOLDS, MFE, perturbed, schedules, 12, **settings)


@pytest.mark.parametrize(
    ("made", "message"),
    [
        (lambda: rows_of_realisation(29, 10, 2), "29 series are too few for 3 choices of 10"),
        (
            lambda: drawn(np.zeros(29), np.arange(29), 10, [0.1] * 3),
            "29 series are too few for 3 choices of 10",
        ),
        (
            lambda: TrainingSet.of_parts([part(0, 2, 10), part(0, 2, 9)], part_of_case=0),
            "the same length, components and parameters",
        ),
        (lambda: RandomActuation(5, 0.5, 3.0), r"mean_on must be 1 at least, not 0\.5"),
        (lambda: factors_of(VALUES, "logarithm", 1), "unknown transform"),
        (lambda: factors_of(VALUES, "inverse", 0), "must be 1 at least"),
        (lambda: factors_of(VALUES - 600.0, "inverse", 1), "have no inverse in between"),
    ],
)
def test_what_does_not_fit_is_refused(made, message):
    with pytest.raises(ValueError, match=message):
        made()


def part(case, count, length=4):
    """Series of a case as they are in its file; the numbers say which case and series it is."""
    numbers = 10.0 * case + np.arange(count)
    states = np.tile(numbers[:, np.newaxis, np.newaxis], (1, length, 2))
    schedules = np.full((count, length - 1, 1), float(case))
    variables = scheduled_variables(states, states + 0.5, schedules)
    return {name: variable.data for name, variable in variables.items()}


def test_series_of_several_cases_take_turns():
    """Case 0 has two series, case 1 three."""
    parts = [part(0, 2), part(1, 3)]
    training = TrainingSet.of_parts(parts, part_of_case=1)
    assert training.states[:, 0, 0].tolist() == [0, 10, 1, 11, 12]
    assert training.observed[:, 3, 1].tolist() == [0.5, 10.5, 1.5, 11.5, 12.5]
    assert training.observed[:, 2, 2].tolist() == [0, 1, 0, 1, 1]
    assert training.own_rows == [1, 3, 4]
    assert TrainingSet.of_parts(parts, part_of_case=0).own_rows == [0, 2]
    assert TrainingSet.of_parts(parts, part_of_case=None).own_rows == []


# -- factors of parameters -------------------------------------------------------------------------

VALUES = np.array([[400.0], [600.0], [1000.0], [400.0]])


@pytest.mark.parametrize("degree", [1, 2, 3])
@pytest.mark.parametrize("transform", ["identity", "inverse"])
@pytest.mark.parametrize("names", [["a"], ["a", "b"]])
def test_parameter_factors_are_monomials_of_scaled_values_or_inverses(names, transform, degree):
    values = np.random.default_rng(1).uniform(1, 2, (20, len(names)))
    factors = ParameterFactors.of(names, values, transform, degree)
    taken = values if transform == "identity" else 1 / values
    low, high = taken.min(axis=0), taken.max(axis=0)
    scaled = (taken - (low + high) / 2) / ((high - low) / 2)
    expected = PolynomialFeatures(degree, include_bias=False).fit_transform(scaled)
    np.testing.assert_allclose(factors(values), expected, rtol=1e-12, atol=1e-12)
    assert factors.count == expected.shape[1]


def factors_of(values, transform, degree):
    return ParameterFactors.of(["reynolds"], values, transform, degree)


def test_a_parameter_that_is_constant_in_training_has_no_factor():
    none = factors_of(np.full((7, 1), 400.0), "inverse", 2)
    assert none.count == 0
    assert none(np.full((3, 1), 400.0)).shape == (3, 0)
    values = np.column_stack([np.full(4, 5.0), np.arange(4.0)])
    factors = ParameterFactors.of(["a", "b"], values, "identity", 1)
    np.testing.assert_allclose(factors(values), [[-1], [-1 / 3], [1 / 3], [1]], rtol=1e-15)


def test_extrapolation_is_told_with_the_range():
    factors = factors_of(VALUES, "inverse", 1)
    with pytest.warns(UserWarning, match="reynolds = 2000 lies outside .* 400 to 1000") as caught:
        extrapolated = factors(np.array([[2000.0]]))
    expected = -1.0 - 2 * (1 / 1000 - 1 / 2000) / (1 / 400 - 1 / 1000)
    assert extrapolated[0, 0] == pytest.approx(expected)
    assert factors.outside(VALUES) is None
    assert caught[0].filename == __file__  # of the caller
    with pytest.warns(UserWarning, match="outside"), pytest.raises(ValueError, match="no inverse"):
        factors(np.zeros((1, 1)))
