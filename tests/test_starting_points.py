import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as npst

from burstcast.data.starting_points import (
    SeriesPoints,
    crossing_points,
    horizon_events,
    segments,
    starting_points,
    steps_before_events,
)


@given(
    st.integers(1, 3), st.integers(1, 60), st.integers(1, 9), st.integers(1, 9), st.integers(1, 20)
)
def test_starting_points_are_as_many_as_leave_room(series, length, spacing, washout, longest):
    expected = []
    step = washout - 1
    while step + longest < length:  # the last forecast step is in the series
        expected.append(step)
        step += spacing
    if not expected:
        with pytest.raises(ValueError, match=r"leave no room for a washout"):
            starting_points(series, length, spacing, washout, longest)
        return
    points = starting_points(series, length, spacing, washout, longest)
    pairs = list(zip(points.series.tolist(), points.step.tolist(), strict=True))
    assert pairs == [(row, step) for row in range(series) for step in expected]
    assert len(points) == len(pairs)


def test_starting_points_of_the_paper():
    points = starting_points(150, 4001, 61, 30, 366)
    assert points.step[0] == 29  # the washout: inputs 0 to 29
    assert (np.diff(points.step[:60]) == 61).all()
    assert points.step.max() + 366 <= 4000
    assert points.step.max() + 61 + 366 > 4000


@given(npst.arrays(np.float64, (3, 12), elements=st.sampled_from([0.0, 0.09, 0.1, 0.2])))
def test_crossings_are_rises_to_the_threshold(observable):
    expected = [
        (row, step)
        for row in range(3)
        for step in range(1, 12)
        if observable[row, step - 1] < 0.1 <= observable[row, step]
    ]
    found = crossing_points(observable, 0.1)
    assert list(zip(found.series.tolist(), found.step.tolist(), strict=True)) == expected


def test_horizon_events_are_the_first_that_leave_room():
    crossings = SeriesPoints(np.array([0, 0, 1, 1, 2, 3]), np.array([9, 50, 10, 90, 11, 70]))
    events = horizon_events(crossings, 0, 10, 4)
    assert events.series.tolist() == [0, 1, 1, 2]
    assert events.step.tolist() == [50, 10, 90, 11]
    assert len(horizon_events(crossings, 0, 91, 4)) == 0
    assert len(horizon_events(crossings, 0, 0, 500)) == 6
    unseen = horizon_events(crossings, 1, 10, 2)
    assert (unseen.series.tolist(), unseen.step.tolist()) == ([1, 1], [10, 90])


@given(st.data(), st.integers(0, 4), st.integers(0, 4))
def test_segments_are_cut_out(data, before, after):
    series = np.arange(3 * 12 * 2).reshape(3, 12, 2).astype(float)
    rows = data.draw(st.lists(st.integers(0, 2), max_size=5))
    steps = [data.draw(st.integers(before, 11 - after)) for _ in rows]
    points = SeriesPoints(np.array(rows, dtype=np.int64), np.array(steps, dtype=np.int64))
    found = segments(series, points, before, after)
    assert found.shape == (len(rows), before + 1 + after, 2)
    for number, (row, step) in enumerate(zip(rows, steps, strict=True)):
        np.testing.assert_array_equal(found[number], series[row, step - before : step + after + 1])
    two_dimensional = segments(series[..., 0], points, before, after)
    np.testing.assert_array_equal(two_dimensional, found[..., 0])


@pytest.mark.parametrize(("step", "before", "after"), [(2, 3, 0), (9, 0, 1)])
def test_segments_beyond_the_series_are_refused(step, before, after):
    # a negative index would silently take the end of the series
    points = SeriesPoints(np.array([0, 0]), np.array([5, step]))
    with pytest.raises(IndexError, match="beyond its series"):
        segments(np.zeros((1, 10)), points, before, after)


def test_steps_before_events_fit_into_a_series():
    assert steps_before_events(45, 40, 5) == 44
    with pytest.raises(ValueError, match="44 samples leave no room for a washout of 5 steps and a"):
        steps_before_events(44, 40, 5)
