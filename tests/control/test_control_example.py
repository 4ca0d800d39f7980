import numpy as np
import pytest

from burstcast.control.example import suppressed_event_times

THRESHOLD = 1.0


def test_times_of_a_single_event() -> None:
    observable = np.array([0, 0, 0.5, 0.9, 1.0, 3.0, 2.0, 0.9, 0.1])
    assert suppressed_event_times(observable, THRESHOLD, 2, (3, 6)) == (2, 4, 5, 7)


def test_an_earlier_and_a_later_event_are_not_looked_at() -> None:
    observable = np.array([9, 0, 5.0, 0.9, 1.1, 0.5, 0, 7.0, 0])
    assert suppressed_event_times(observable, THRESHOLD, 1, (3, 6)) == (1, 4, 4, 5)


def test_an_event_that_is_under_way_at_the_end() -> None:
    observable = np.array([0, 0, 0.5, 1.5, 2.0])
    assert suppressed_event_times(observable, THRESHOLD, 0, (1, 4)) == (0, 3, 4, 4)


@pytest.mark.parametrize("observable", [[0, 0, 0, 2.0], [0, 2.0, 2.0, 2.0]])
def test_an_event_outside_the_window_is_refused(observable: list[float]) -> None:
    with pytest.raises(ValueError, match="does not cross"):
        suppressed_event_times(np.array(observable), THRESHOLD, 0, (1, 2))
