"""Scaled parameters and their monomials."""

import numpy as np
import pytest
from sklearn.preprocessing import PolynomialFeatures

from burstcast.data.parameter_factors import ParameterFactors

REYNOLDS = np.array([[400.0], [600.0], [1000.0], [400.0]])


@pytest.mark.parametrize("degree", [1, 2, 3])
def test_factors_are_monomials_of_scaled_inverses(degree):
    factors = ParameterFactors.of(["reynolds"], REYNOLDS, "inverse", degree)
    inverse = 1 / REYNOLDS
    scaled = (inverse - (1 / 400 + 1 / 1000) / 2) / ((1 / 400 - 1 / 1000) / 2)
    expected = PolynomialFeatures(degree, include_bias=False).fit_transform(scaled)
    np.testing.assert_allclose(factors(REYNOLDS), expected, rtol=1e-12, atol=1e-12)
    assert factors.count == degree


def test_several_parameters_have_products():
    values = np.random.default_rng(1).uniform(1, 2, (20, 2))
    factors = ParameterFactors.of(["a", "b"], values, "identity", 2)
    low, high = values.min(axis=0), values.max(axis=0)
    scaled = (values - (low + high) / 2) / ((high - low) / 2)
    expected = PolynomialFeatures(2, include_bias=False).fit_transform(scaled)
    np.testing.assert_allclose(factors(values), expected, rtol=1e-12, atol=1e-12)


def test_a_schedule_has_factors_in_its_own_layout():
    factors = ParameterFactors.of(["reynolds"], REYNOLDS, "inverse", 2)
    schedule = np.random.default_rng(2).uniform(400, 1000, (5, 1, 3))
    found = factors.of_schedule(schedule)
    assert found.shape == (5, 2, 3)
    assert np.array_equal(found[3, :, 1], factors(schedule[3, :, 1]))


def test_a_parameter_that_is_constant_in_training_has_no_factor():
    one = ParameterFactors.of(["reynolds"], np.full((7, 1), 400.0), "inverse", 2)
    assert one.count == 0
    assert one(np.full((3, 1), 400.0)).shape == (3, 0)
    two = np.column_stack([np.full(4, 5.0), np.arange(4.0)])
    factors = ParameterFactors.of(["a", "b"], two, "identity", 1)
    assert factors(two).tolist() == [[-1.0], [pytest.approx(-1 / 3)], [pytest.approx(1 / 3)], [1.0]]


def test_extrapolation_is_told_with_the_range():
    factors = ParameterFactors.of(["reynolds"], REYNOLDS, "inverse", 1)
    with pytest.warns(UserWarning, match=r"reynolds = 2000 lies outside .* 400 to 1000"):
        found = factors(np.array([[2000.0]]))
    assert found[0, 0] == pytest.approx(-1.0 - 2 * (1 / 1000 - 1 / 2000) / (1 / 400 - 1 / 1000))
    assert factors.outside(REYNOLDS) is None


@pytest.mark.parametrize(
    ("values", "transform", "degree", "message"),
    [
        (REYNOLDS, "logarithm", 1, "unknown transform"),
        (REYNOLDS, "inverse", 0, "must be 1 at least"),
        (REYNOLDS - 600.0, "inverse", 1, "have no inverse in between"),
    ],
)
def test_what_cannot_be_scaled_is_refused(values, transform, degree, message):
    with pytest.raises(ValueError, match=message):
        ParameterFactors.of(["reynolds"], values, transform, degree)


def test_a_value_without_an_inverse_is_refused():
    factors = ParameterFactors.of(["reynolds"], REYNOLDS, "inverse", 1)
    with (
        pytest.warns(UserWarning, match="outside"),
        pytest.raises(ValueError, match="has no inverse"),
    ):
        factors(np.zeros((1, 1)))
