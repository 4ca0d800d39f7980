"""Starting points with what is observed and what follows: brute force, point by point."""

from itertools import pairwise

import numpy as np
from numpy.testing import assert_array_equal

from burstcast.forecast.observed_points import observed_points


def test_points_one_by_one() -> None:
    generator = np.random.default_rng(1)
    truth, observed = generator.normal(size=(3, 60)), generator.normal(size=(3, 60, 2))
    washout, spacing, boundaries = 5, 7, (2, 4, 9)
    found = observed_points(
        observed,
        truth,
        lambda state: state[0] * state[1],
        spacing=spacing,
        washout=washout,
        boundaries=boundaries,
    )
    row = 0
    for series in range(3):
        for now in range(washout - 1, 60 - boundaries[-1], spacing):
            assert (found.points.series[row], found.points.step[row]) == (series, now)
            seen = observed[series, now - washout + 1 : now + 1]
            assert_array_equal(found.washouts[row], seen)
            assert_array_equal(found.seen[row], seen[:, 0] * seen[:, 1])
            for window, (start, end) in enumerate(pairwise(boundaries)):
                following = truth[series, now + start : now + end + 1]
                assert found.truth.first[row, window] == following[0]
                assert found.truth.largest[row, window] == following.max()
            row += 1
    assert row == len(found.points)
