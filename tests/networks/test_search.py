"""Grids, the Bayesian search, and the standard errors of its objectives."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats
from skopt.learning import GaussianProcessRegressor

from burstcast.networks import network_search
from burstcast.networks.bayesian_search import bayesian_search
from burstcast.networks.hyperparameters import HyperparameterPoint, SearchSpace, SurrogateSettings
from burstcast.networks.scan import Evaluation, scan
from burstcast.networks.uncertainty import objective_uncertainty
from burstcast.networks.validation import Validation
from burstcast.networks.validation_strategies.registry import make_strategy

PAPER = SearchSpace(spectral_radius=(0.1, 1.0), input_scaling=(0.1, 10.0))
BEST = (-0.3, 0.4)  # decimal logarithms


def bowl(point):
    """A smooth objective of the size of ours, whose minimum lies between the points of the grid."""
    rho, sigma = math.log10(point.spectral_radius), math.log10(point.input_scaling)
    return -6 + 4 * (rho - BEST[0]) ** 2 + (sigma - BEST[1]) ** 2


def search(space=PAPER, points=5, seed=1, objective=bowl, surrogate=()):
    """Points of the Bayesian search after a 4 x 4 grid."""
    result = []

    def evaluate(point):
        result.append(point)
        return objective(point)

    grid = [(point, objective(point)) for point in space.grid(4)]
    bayesian_search(space, grid, points, evaluate, seed, *surrogate)
    return result


def test_the_papers_grid():
    grid = PAPER.grid(4)
    assert len(set(grid)) == 16
    assert grid[0] == HyperparameterPoint(0.1, 0.1)
    rho = sorted({point.spectral_radius for point in grid})
    sigma = sorted({point.input_scaling for point in grid})
    np.testing.assert_allclose(rho, 10 ** np.array([-1, -2 / 3, -1 / 3, 0]))
    np.testing.assert_allclose(sigma, 10 ** np.array([-1, -1 / 3, 1 / 3, 1]))


BOUNDS = st.tuples(
    st.floats(1e-6, 1e6, allow_subnormal=False), st.floats(1.001, 1e6, allow_subnormal=False)
).map(lambda pair: (pair[0], pair[0] * pair[1]))


@given(BOUNDS, BOUNDS, st.integers(2, 5))
def test_grids_and_logarithms_stay_within_the_bounds(rho, sigma, points):
    space = SearchSpace(rho, sigma)
    grid = space.grid(points)
    assert len(grid) == points**2
    for name, (low, high) in (("spectral_radius", rho), ("input_scaling", sigma)):
        values = [getattr(point, name) for point in grid]
        assert min(values) == low
        assert max(values) == high
    for point in grid:
        logarithm = space.logarithm(point)
        for value, (low, high) in zip(logarithm, (rho, sigma), strict=True):
            assert np.log10(low) <= value <= np.log10(high)
        back = space.point(logarithm)
        assert rho[0] <= back.spectral_radius <= rho[1]
        assert sigma[0] <= back.input_scaling <= sigma[1]
        assert back.spectral_radius == pytest.approx(point.spectral_radius)
        assert back.input_scaling == pytest.approx(point.input_scaling)


@pytest.mark.parametrize("bounds", [(0.0, 1.0), (-1.0, 1.0), (1.0, 1.0), (2.0, 1.0)])
def test_impossible_bounds_are_refused(bounds):
    with pytest.raises(ValueError, match="bounds of spectral_radius"):
        SearchSpace(bounds, (0.1, 1.0))
    with pytest.raises(ValueError, match="bounds of input_scaling"):
        SearchSpace((0.1, 1.0), bounds)


@pytest.fixture(scope="module")
def nine():
    """The paper's nine points on the bowl."""
    return search(points=9)


def test_the_search_finds_what_the_grid_misses_within_bounds_of_any_size(nine):
    assert len(nine) == 9
    assert len({(point.spectral_radius, point.input_scaling) for point in nine}) == 9
    best_of_grid = min(bowl(point) for point in PAPER.grid(4))
    assert min(map(bowl, nine)) < -6 + 0.1 * (best_of_grid + 6)
    for point in nine:
        assert 0.1 <= point.spectral_radius <= 1
        assert 0.1 <= point.input_scaling <= 10
    space = SearchSpace((0.37, 0.3701), (123.4, 56789.1))
    for point in search(space, points=2, objective=lambda point: point.input_scaling):
        assert 0.37 <= point.spectral_radius <= 0.3701
        assert 123.4 <= point.input_scaling <= 56789.1


def test_points_depend_on_seed_and_objective_and_later_ones_change_no_earlier(nine):
    # what comes later does not change what came before
    assert search(points=3) == nine[:3]
    assert search(points=1, objective=lambda point: -bowl(point)) != nine[:1]
    assert search(points=0) == []


def test_the_best_network_is_that_of_its_own_strategy():
    """Others, validated in the same go on the grid, may have lower objectives."""
    single, recycled = make_strategy("SSV"), make_strategy("RV")
    seen = []

    def validator(point, strategies):
        seen.append([evaluation.name for evaluation in strategies])
        errors = {"RV": bowl(point), "SSV": bowl(point) - 50.0}
        return [
            Validation(strategy.name, beta, np.array([errors[strategy.name] + beta]), "", 1.0)
            for strategy in strategies
            for beta in (1.0, 2.0)
        ]

    scanned = scan(validator, PAPER, [single, recycled], 2)
    trace = network_search.search(validator, PAPER, recycled, scanned, 3, 1)
    assert seen == [["SSV", "RV"]] * 4 + [["RV"]] * 3
    assert [evaluation.number for evaluation in trace[::2]] == [*range(7)]
    assert [evaluation.source for evaluation in trace[::2]] == ["grid"] * 4 + ["bayesian"] * 3
    result = network_search.best(trace)
    assert result.validation.tikhonov == 1.0
    assert result.objective == pytest.approx(bowl(result.point) + 1)
    assert bowl(result.point) <= min(map(bowl, PAPER.grid(2)))


def test_the_search_takes_the_leak_rate_of_the_best_point_of_the_grid():
    space = SearchSpace(PAPER.spectral_radius, PAPER.input_scaling, (1.0, 0.5, 0.25))
    assert len(set(space.grid(4))) == 48
    assert space.grid(4)[:16] == PAPER.grid(4)  # those without a leak first
    strategy = make_strategy("RV")

    def validator(point, strategies):
        error = bowl(point) + 3 * abs(point.leak_rate - 0.5)
        return [Validation("RV", 1.0, (error,), "", 1.0)]

    scanned = scan(validator, space, [strategy], 4)
    trace = network_search.search(validator, space, strategy, scanned, 2, 1)
    assert [evaluation.point.leak_rate for evaluation in trace[48:]] == [0.5] * 2
    # the process knows the grid of this leak rate alone
    alone = SearchSpace(space.spectral_radius, space.input_scaling, (0.5,))
    scanned = scan(validator, alone, [strategy], 4)
    other = network_search.search(validator, alone, strategy, scanned, 2, 1)
    assert [each.point for each in trace[48:]] == [each.point for each in other[16:]]
    # rows of tables say the leak rates that are not 1
    for evaluation in trace:
        row = evaluation.record()
        assert ("leak_rate" in row) == (evaluation.point.leak_rate != 1)
        assert Evaluation.restore(row, evaluation.validation.log_errors) == evaluation


def test_the_surrogate_has_the_settings_that_it_is_given(monkeypatch):
    made = []

    def recorded(**arguments):
        made.append(arguments)
        return GaussianProcessRegressor(**arguments)

    monkeypatch.setattr("burstcast.networks.bayesian_search.GaussianProcessRegressor", recorded)
    authors = SurrogateSettings((0.1, 3.0), (0.01, 10.0), 0.2, 10)
    paths = [
        search(points=1, seed=seed, surrogate=[surrogate])
        for seed, surrogate in ((1, SurrogateSettings()), (1, authors), (2, authors))
    ]
    kernel, other = (evaluation["kernel"] for evaluation in made[:2])
    # by hand, of the kernels of skopt: bounds in logarithms, the constant first
    np.testing.assert_allclose(np.exp(kernel.bounds), [[1e-2, 1e3], [1e-2, 1e2], [1e-2, 1e2]])
    np.testing.assert_allclose(np.exp(kernel.theta), [1, 1, 1])
    np.testing.assert_allclose(np.exp(other.bounds), [[0.1, 3], [0.01, 10], [0.01, 10]])
    np.testing.assert_allclose(np.exp(other.theta), [1, 0.2, 0.2])
    assert [evaluation["random_state"] for evaluation in made] == [1, 10, 10]
    assert paths[1] == paths[2]
    assert paths[0] == search(points=1)


# -- standard errors of objectives -----------------------------------------------------------------

SHARED = np.random.default_rng(1).normal(size=40)
"""What the intervals do to all points alike."""
OWN = 0.1 * np.random.default_rng(2).normal(size=(3, 40))
LOG_ERRORS = np.array([[0.2], [0.0], [1.0]]) + SHARED + OWN


def test_standard_errors_are_those_of_scipy_and_the_best_has_no_excess():
    result = objective_uncertainty(LOG_ERRORS)
    single, excess, paired_error = result.values()
    np.testing.assert_allclose(single, stats.sem(LOG_ERRORS, axis=1), rtol=1e-12)
    assert int(np.argmin(LOG_ERRORS.mean(axis=1))) == 1
    assert (excess[1], paired_error[1]) == (0, 0)
    assert np.all(excess >= 0)
    assert np.all(paired_error < 0.3 * single)
    for point in (0, 2):
        paired = stats.ttest_rel(LOG_ERRORS[point], LOG_ERRORS[1]).statistic
        assert excess[point] / paired_error[point] == pytest.approx(paired, rel=1e-10)


NAN, INF = np.nan, np.inf


@pytest.mark.parametrize(
    ("errors", "single", "excess", "paired"),
    [
        # one interval says nothing about its error; closed loops that diverge have infinite ones
        ([[-5.0], [-5.1], [-5.1]], [NAN] * 3, [pytest.approx(0.1), 0, 0], [NAN, 0, NAN]),
        ([[INF] * 3] * 2, [NAN, NAN], [0, NAN], [0, NAN]),
        ([[INF] * 3, [2.0] * 3], [NAN, 0], [INF, 0], [NAN, 0]),
    ],
)
def test_what_is_not_defined_is_not_a_number(errors, single, excess, paired):
    result = objective_uncertainty(np.array(errors))
    expected = {"standard_error": single, "excess": excess, "paired_standard_error": paired}
    for name, values in expected.items():
        for value, wanted in zip(result[name], values, strict=True):
            assert value == wanted or np.isnan([value, wanted]).all()


def test_a_search_without_points_is_refused():
    with pytest.raises(ValueError, match="no point"):
        objective_uncertainty(np.empty((0, 5)))
