import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as npst

from burstcast.events import upward_crossings

VALUES = st.sampled_from([0.0, 0.09, 0.1, 0.2, np.nan])


@given(npst.arrays(np.float64, (3, 12), elements=VALUES))
def test_events_start_where_the_threshold_is_reached_from_below(observable):
    found = upward_crossings(observable, 0.1)
    for row in range(3):
        for step in range(12):
            reached = observable[row, step] >= 0.1
            above_before = step == 0 or observable[row, step - 1] >= 0.1
            assert found[row, step] == (reached and not above_before)


@given(npst.arrays(np.float64, (3, 4, 5), elements=VALUES), st.sampled_from([0, 1, 2, -1]))
def test_time_may_be_any_axis(observable, axis):
    expected = np.moveaxis(upward_crossings(np.moveaxis(observable, axis, -1), 0.1), -1, axis)
    np.testing.assert_array_equal(upward_crossings(observable, 0.1, axis), expected)


def test_an_event_under_way_at_the_first_step_has_no_start():
    assert not upward_crossings(np.array([0.2, 0.2, 0.0, 0.0]), 0.1).any()
    assert upward_crossings(np.array([0.2, 0.0, 0.1, 0.2]), 0.1).tolist() == [0, 0, 1, 0]
