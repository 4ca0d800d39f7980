"""The event that stands for all of them."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from burstcast.probability.typical_event import typical_event


@given(
    st.lists(st.tuples(st.integers(0, 4), st.booleans(), st.booleans()), min_size=1, max_size=30)
)
def test_half_of_the_events_were_seen_better_and_half_worse(points):
    probability = np.array([level / 4 for level, _, _ in points])
    happened, scored = (np.array([point[column] for point in points]) for column in (1, 2))
    events = [number for number, point in enumerate(points) if point[1] and point[2]]
    found = typical_event(probability, happened, scored)
    if not events:
        assert found is None
        return
    assert found in events
    worse = sum(probability[number] < probability[found] for number in events)
    better = sum(probability[number] > probability[found] for number in events)
    assert worse < len(events) / 2
    assert better <= len(events) / 2
    # the first of equals
    assert all(probability[number] != probability[found] for number in events if number < found)
