"""Events for the flow figures, in made-up series whose events are known."""

import numpy as np
import pytest

from burstcast.forecast.example_events import (
    EventCriterion,
    ExampleEvent,
    forecast_event,
    isolated_events,
    predicted_event,
)
from burstcast.systems.measured import MeasuredSeries
from helpers_forecasters import MadeUpForecaster

CRITERION = EventCriterion(threshold=1.0, calm=0.5, quiet=10, longest=60, wanted_peak=2.0)


def bump(length, *pulses):
    """Observable that rests at 0.4 but for triangles (start, rise, fall, peak)."""
    values = np.full(length, 0.4)
    for start, rise, fall, peak in pulses:
        up = 0.4 + (peak - 0.4) * np.arange(rise) / rise
        down = peak - (peak - 0.4) * np.arange(fall + 1) / fall
        values[start : start + rise + fall + 1] = np.concatenate([up, down])
    return values


def test_times_of_one_event_by_hand():
    # rise by 0.08 a step from step 20, fall by 0.16 from step 40
    values = bump(100, (20, 20, 10, 2.0))
    (event,) = isolated_events(values[np.newaxis], CRITERION)
    assert event.series == 0
    assert event.peak == 2.0
    # 0.4 + 0.08 * 1 is the last value not above 0.5; 0.4 + 0.08 * 11 the first not below 1.25;
    # 2 - 0.16 * 7 the first below 1
    assert event.times == (21, 31, 40, 47)


def test_an_event_lasts_as_long_as_the_threshold_is_reached():
    # from 2 by 0.1 a step, exactly: 1 in step 50
    (event,) = isolated_events(bump(100, (20, 20, 16, 2.0))[np.newaxis], CRITERION)
    assert event.times == (21, 31, 40, 51)


def test_the_event_with_the_wanted_peak_comes_first():
    series = np.stack(
        [bump(200, (20, 20, 10, peak)) for peak in (1.2, 2.5, 1.9, 2.11, 0.9)]
        + [bump(200, (20, 20, 10, 1.6), (100, 20, 10, 2.05))]
    )
    found = isolated_events(series, CRITERION)
    assert [(event.series, event.peak) for event in found] == [
        (5, 2.05),
        (2, 1.9),
        (3, 2.11),
        (5, 1.6),
        (1, 2.5),
        (0, 1.2),
    ]


@pytest.mark.parametrize(
    "values",
    [
        bump(100, (5, 20, 10, 2.0)),  # no quiet stretch before
        bump(62, (20, 20, 20, 2.0)),  # none after
        bump(100, (20, 20, 6, 2.0), (48, 6, 6, 1.5)),  # another event too soon
        bump(100, (33, 2, 3, 1.5), (40, 20, 10, 2.0)),  # or just before
        bump(200, (20, 70, 10, 2.0)),  # takes too long
        np.where(np.arange(100) == 44, 0.9, bump(100, (20, 20, 16, 2.0))),  # crosses twice
        bump(100)[:] + 2.0,  # above all the time
        np.full(100, 0.4),
    ],
)
def test_events_unfit_to_be_shown_are_left_out(values):
    assert isolated_events(values[np.newaxis], CRITERION) == []


@pytest.mark.parametrize(("first", "after", "count"), [(9, 0, 1), (8, 0, 0), (9, -1, 0)])
def test_quiet_stretches_may_fill_the_series(first, after, count):
    # one step of the rise is calm; so are the last of the fall, 1.6 / 0.16 steps, and what follows
    values = bump(first + 30 + 10 + 1 + after, (first, 20, 10, 2.0))
    assert values[first + 30] <= CRITERION.calm < values[first + 29]
    assert len(isolated_events(values[np.newaxis], CRITERION)) == count


def test_room_before_the_event_is_asked_for():
    values = bump(100, (20, 20, 10, 2.0))[np.newaxis]
    assert len(isolated_events(values, CRITERION, before=21)) == 1
    assert isolated_events(values, CRITERION, before=22) == []


def test_all_events_satisfy_their_definition():
    # smooth noise, skewed as the kinetic energy is, has excursions of every kind
    generator = np.random.default_rng(7)
    kernel = np.exp(-0.5 * np.square(np.arange(-30, 31) / 8))
    noise = [np.convolve(row, kernel, "same") for row in generator.normal(size=(40, 3000))]
    values = 0.5 * np.exp(0.15 * np.array(noise))
    found = isolated_events(values, CRITERION)
    assert len(found) > 20
    for event in found:
        course, (first, second, third, fourth) = values[event.series], event.times
        assert first < second <= third < fourth <= first + CRITERION.longest
        assert course[first] <= 0.5
        assert (course[first + 1 : fourth] > 0.5).all()
        assert course[third] == event.peak == course[first:fourth].max() >= 1.0
        assert course[fourth] < 1.0 <= course[third:fourth].min()
        assert (course[first - 10 : first] < 1.0).all()
        assert course[second] >= 0.5 * (0.5 + event.peak) > course[first:second].max()
    distances = [abs(event.peak - 2.0) for event in found]
    assert distances == sorted(distances)


def test_calm_must_lie_below_the_threshold():
    with pytest.raises(ValueError, match="below"):
        EventCriterion(threshold=1.0, calm=1.0, quiet=1, longest=5, wanted_peak=2.0)


class Wrong(MadeUpForecaster):
    """Knows the truth of every series, and fails in each by a given error from a given step on.

    The second component of the state is the row of the series, the third the step.
    """

    def __init__(self, truth, error, failing_from):
        self.truth, self.error, self.failing_from = truth, error, failing_from

    def start(self, washout, parameters=None):
        return washout[-1]

    def advance(self, memory, steps, parameters=None):
        series = memory[1].astype(int)
        step = memory[2].astype(int) + 1 + np.arange(steps)[:, np.newaxis]
        # beyond the end of a series the last value
        value = self.truth[series, np.minimum(step, self.truth.shape[1] - 1)]
        value = value + np.where(step >= self.failing_from[series], self.error, 0.0)
        states = np.stack([value, np.broadcast_to(series, step.shape), step], axis=1)
        return states, states[-1]


PEAKS = (2.0, 1.9, 2.2)
TRUTH = np.stack([bump(100, (30, 20, 10, peak)) for peak in PEAKS])
OBSERVED = np.stack(
    [TRUTH, np.broadcast_to(np.arange(3)[:, None], (3, 100)), np.tile(np.arange(100), (3, 1))],
    axis=2,
).astype(float)


def choose(failing_from, lead=8, error=0.3):
    events = isolated_events(TRUTH, CRITERION, before=lead + 2)
    assert [event.series for event in events] == [0, 1, 2]
    chosen = predicted_event(
        events,
        Wrong(TRUTH, error, np.array(failing_from)),
        OBSERVED,
        OBSERVED,
        lead=lead,
        washout=3,
        tolerance=0.2,
    )
    breakdowns = [event.times[3] for event in events]
    return chosen.series, breakdowns


def test_the_best_predicted_event_is_chosen():
    never = 1000
    assert choose([never] * 3)[0] == 0
    _, breakdowns = choose([never] * 3)
    # lost at the very last step that counts, and one step later
    assert choose([breakdowns[0], never, never])[0] == 1
    assert choose([breakdowns[0] + 1, never, never])[0] == 0
    assert choose([0, 0, never])[0] == 2


def test_an_error_within_the_tolerance_is_no_failure():
    assert choose([0, 1000, 1000], error=0.1)[0] == 0


def test_a_forecast_that_is_not_finite_is_lost():
    assert choose([40, 1000, 1000], error=np.nan)[0] == 1


def test_the_whole_state_must_be_right():
    events = isolated_events(TRUTH, CRITERION, before=10)
    states = np.pad(OBSERVED, ((0, 0), (0, 0), (0, 1)))
    wrong = states.copy()
    wrong[0, events[0].times[3], 3] = 0.3

    class FourthComponentZero(Wrong):
        def advance(self, memory, steps, parameters=None):
            forecast, _ = super().advance(memory, steps)
            forecast = np.pad(forecast, ((0, 0), (0, 1), (0, 0)))
            return forecast, forecast[-1]

    forecaster = FourthComponentZero(TRUTH, 0.0, np.zeros(3))
    settings = {"lead": 8, "washout": 3, "tolerance": 0.2}
    assert predicted_event(events, forecaster, states, states, **settings).series == 0
    assert predicted_event(events, forecaster, states, wrong, **settings).series == 1


def test_without_a_predicted_event_the_longest_prediction_is_chosen():
    assert choose([40, 50, 45])[0] == 1
    assert choose([0, 0, 0])[0] == 0


def test_batches_change_no_choice(monkeypatch):
    monkeypatch.setattr("burstcast.forecast.example_events.CANDIDATES_PER_BATCH", 1)
    assert choose([40, 50, 45])[0] == 1
    assert choose([0, 1000, 1000])[0] == 1


def test_no_events_no_choice():
    chosen = predicted_event(
        [],
        Wrong(TRUTH, 0.0, np.zeros(3)),
        OBSERVED,
        OBSERVED,
        lead=3,
        washout=3,
        tolerance=0.2,
    )
    assert chosen is None


def test_a_forecast_from_the_start_of_a_series_is_refused():
    event = ExampleEvent(0, (5, 10, 20, 30), 2.0)
    with pytest.raises(IndexError, match="beyond its series"):
        predicted_event(
            [event],
            Wrong(TRUTH, 0.0, np.zeros(3)),
            OBSERVED,
            OBSERVED,
            lead=4,
            washout=3,
            tolerance=0.2,
        )


def test_an_event_is_forecast_from_its_washout_to_after_its_breakdown():
    space = MeasuredSeries(("value", "series", "step"), "value")
    event = ExampleEvent(1, (31, 41, 50, 57), 1.9)
    observed = OBSERVED + np.array([0.01, 0, 0])
    settings = {"lead": 8, "washout": 3, "after": 4, "steps_per_lyapunov_time": 5}
    wrong = Wrong(TRUTH, 0.3, np.full(3, 45))
    found = forecast_event(event, wrong, space, observed, OBSERVED, **settings)
    shown = np.arange(21, 62)  # the forecast starts from step 23
    np.testing.assert_allclose(found.time_lt, (shown - 23) / 5)
    np.testing.assert_array_equal(found.true, TRUTH[1, shown])
    expected = TRUTH[1, shown] + np.where(shown >= 45, 0.3, 0.0)
    expected[:3] = [np.nan, np.nan, TRUTH[1, 23] + 0.01]
    np.testing.assert_array_equal(found.forecast, expected)
    np.testing.assert_array_equal(shown[found.mark], event.times)
    np.testing.assert_array_equal(found.true_state, OBSERVED[1, list(event.times)])
    np.testing.assert_array_equal(found.forecast_state[:, 0], expected[found.mark])
    none = forecast_event(None, wrong, space, observed, OBSERVED, **settings)
    assert (none.true.shape, none.forecast_state.shape) == ((0,), (0, 3))
