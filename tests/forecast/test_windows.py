"""Window summaries and crossings against a plain loop over the observable's values."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as npst

from burstcast.forecast.windows import (
    WindowSummaries,
    crosses,
    summarise,
    window_boundaries,
)

THRESHOLD = 0.1


def crosses_by_hand(values, first, last, threshold):
    """Below at the first step of the window, and at or above it somewhere in the window."""
    if not all(np.isfinite(values[step]) for step in range(first, last + 1)):
        return False
    if not values[first] < threshold:
        return False
    return any(values[step] >= threshold for step in range(first, last + 1))


def test_boundaries_at_the_papers_reynolds_number():
    # windows of half a Lyapunov time up to 5 + 1 of them; 61 steps each
    boundaries = window_boundaries(0.5, 11, 61)
    assert boundaries == (30, 61, 91, 122, 152, 183, 213, 244, 274, 305, 335, 366)


@given(
    st.data(),
    st.integers(2, 60),  # steps in a Lyapunov time
    st.sampled_from([0.5, 1.0, 0.25]),
    st.integers(1, 3),  # windows in a prediction window
    st.integers(0, 4),  # windows before it
)
def test_a_window_crosses_if_the_observable_itself_does(
    data, lyapunov_time, resolution, length, before
):
    if resolution * lyapunov_time < 1:
        return
    boundaries = window_boundaries(resolution, before + length + 1, lyapunov_time)
    # from 0, the starting point itself, which no forecast contains
    observable = data.draw(
        npst.arrays(
            np.float64,
            (boundaries[-1] + 1, 3),
            elements=st.sampled_from([0.0, 0.05, THRESHOLD, 0.2, np.nan, np.inf]),
            fill=st.sampled_from([0.0, 0.05, 0.2]),
        )
    )
    found = crosses(summarise(observable[1:], boundaries), before, length, THRESHOLD)
    first = int((before + 1) * resolution * lyapunov_time)
    last = int((before + 1 + length) * resolution * lyapunov_time)
    expected = [crosses_by_hand(observable[:, row], first, last, THRESHOLD) for row in range(3)]
    assert found.tolist() == expected


def one_window(*values):
    """Whether these values, from the window's first step on, cross the threshold."""
    observable = np.concatenate([[0.5], values])[:, np.newaxis]  # an event before the window
    return bool(crosses(summarise(observable, (2, 1 + len(values))), 0, 1, THRESHOLD)[0])


@pytest.mark.parametrize(
    ("values", "expected"),
    [
        ((0.0, 0.0, 0.2), True),
        ((0.0, 0.2, 0.0), True),
        ((0.0, 0.0, 0.0), False),
        ((0.2, 0.0, 0.0), False),  # under way at the first step
        ((0.2, 0.0, 0.2), False),  # even if it comes again
        ((0.1, 0.0, 0.2), False),  # the threshold itself counts as an event
        ((0.0, 0.0, 0.1), True),
        ((np.nextafter(0.1, 0), 0.0, 0.1), True),
        ((0.0, np.nan, 0.2), False),
        ((np.nan, 0.0, 0.2), False),
        ((0.0, 0.2, np.nan), False),
        ((0.0, 0.2, np.inf), False),
        ((0.0, -np.inf, 0.05), False),
    ],
)
def test_edges(values, expected):
    assert one_window(*values) is expected


def test_the_largest_value_may_be_the_first_or_the_last():
    falling = summarise(np.array([[9.0], [5.0], [4.0], [3.0]]), (2, 4))
    assert (falling.first.tolist(), falling.largest.tolist()) == ([[5.0]], [[5.0]])
    rising = summarise(np.array([[0.0], [1.0], [2.0], [3.0], [9.0]]), (2, 4))
    assert (rising.first.tolist(), rising.largest.tolist()) == ([[1.0]], [[3.0]])


def test_windows_share_their_common_step():
    # the rise ends on the boundary: both windows see it, only the first one crosses there
    summaries = summarise(np.array([[0.0], [0.0], [0.2], [0.0], [0.3]]), (1, 3, 5))
    assert summaries.first.tolist() == [[0.0, 0.2]]
    assert summaries.largest.tolist() == [[0.2, 0.3]]
    assert crosses(summaries, 0, 1, THRESHOLD).tolist() == [True]
    assert crosses(summaries, 1, 1, THRESHOLD).tolist() == [False]
    assert crosses(summaries, 0, 2, 0.25).tolist() == [True]


@pytest.mark.parametrize(("first", "length"), [(-1, 1), (1, 2), (2, 1)])
def test_windows_beyond_the_forecast_are_refused(first, length):
    summaries = summarise(np.zeros((5, 1)), (1, 3, 5))
    with pytest.raises(IndexError, match="beyond the forecast"):
        crosses(summaries, first, length, THRESHOLD)


def test_forecasts_that_are_lost_cross_nothing():
    summaries = WindowSummaries(first=np.full((1, 2), np.nan), largest=np.full((1, 2), np.nan))
    assert not crosses(summaries, 0, 2, THRESHOLD).any()
