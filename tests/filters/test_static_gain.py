"""Static gains and leading directions, against the Kalman filter's formula and by hand."""

import numpy as np

from burstcast.filters.static_gain import leading_directions, static_gain


def test_the_gain_is_the_kalman_filters():
    generator = np.random.default_rng(3)
    root, matrix = generator.normal(size=(6, 6)), generator.normal(size=(2, 6))
    covariance, noise = root @ root.T, np.array([0.3, 0.7])
    gain = static_gain(covariance, matrix, noise, 0.01)
    # in information form: (C^-1 / share + H' R^-1 H)^-1 H' R^-1
    precision = np.linalg.inv(0.01 * covariance) + matrix.T @ np.diag(noise**-2) @ matrix
    np.testing.assert_allclose(gain, np.linalg.solve(precision, matrix.T * noise**-2), rtol=1e-9)


def test_leading_directions_make_the_covariance():
    generator = np.random.default_rng(5)
    root = generator.normal(size=(5, 5))
    covariance = root @ root.T
    directions = leading_directions(covariance, 5)
    np.testing.assert_allclose(directions @ directions.T, covariance, rtol=1e-9, atol=1e-9)
    lengths = np.linalg.norm(directions, axis=0)
    assert (np.diff(lengths) < 0).all()
    np.testing.assert_array_equal(leading_directions(covariance, 2), directions[:, :2])
    largest = np.argmax(np.abs(directions), axis=0)
    assert (directions[largest, range(5)] > 0).all()
