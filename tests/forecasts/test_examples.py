"""Events, forecasts and outcomes that figures show, in made-up series whose events are known."""

from dataclasses import dataclass, replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from burstcast.data.starting_points import SeriesPoints
from burstcast.forecasts.examples import (
    EventCriterion,
    ExampleEvent,
    evaluate_lead_times,
    forecast_event,
    forecast_observable,
    forecast_outcomes,
    horizon_example,
    isolated_events,
    outcome_examples,
    predicted_event,
    stretch,
)
from burstcast.forecasts.horizon import HorizonSearch, prediction_horizons
from burstcast.forecasts.windows import WindowSummaries
from burstcast.systems.measured import MeasuredSeries
from helpers_library import MadeUpForecaster

CRITERION = EventCriterion(threshold=1.0, calm=0.5, quiet=10, longest=60, wanted_peak=2.0)


def bump(length, *pulses):
    """Observable that rests at 0.4 but for triangles (start, rise, fall, peak)."""
    values = np.full(length, 0.4)
    for start, rise, fall, peak in pulses:
        up = 0.4 + (peak - 0.4) * np.arange(rise) / rise
        down = peak - (peak - 0.4) * np.arange(fall + 1) / fall
        values[start : start + rise + fall + 1] = np.concatenate([up, down])
    return values


def isolated_by_hand(row, values, criterion, before):
    """Events of a series, by walking from each crossing to the calm steps on both sides."""
    threshold, calm, quiet = criterion.threshold, criterion.calm, criterion.quiet
    crossings = [n for n in range(1, len(values)) if values[n - 1] < threshold <= values[n]]
    for crossing in crossings:
        begin = end = crossing
        while begin >= 0 and values[begin] > calm:
            begin -= 1
        while end < len(values) and values[end] > calm:
            end += 1
        # in steps, the quiet stretches must lie within the series
        if begin < max(before, quiet) or end + quiet >= len(values):
            continue
        around = [*values[begin - quiet : begin], *values[end : end + quiet + 1]]
        if max(around) >= threshold or sum(begin < crossing < end for crossing in crossings) > 1:
            continue
        peak = max(range(begin, end), key=lambda step: values[step])
        middle = 0.5 * (calm + values[peak])
        rise = next(step for step in range(begin, end) if values[step] >= middle)
        fall = next(step for step in range(peak, end + 1) if values[step] < threshold)
        if fall - begin <= criterion.longest:
            yield ExampleEvent(row, (begin, rise, peak, fall), values[peak])


@pytest.mark.parametrize("before", [0, 21, 40])
@pytest.mark.parametrize(("quiet", "longest"), [(10, 60), (3, 25), (1, 60)])
def test_isolated_events_are_those_of_a_walk_from_each_crossing(before, quiet, longest):
    """In order of their distance from the wanted peak, equally good ones in their order."""
    # smooth noise, skewed as the kinetic energy is, has excursions of every kind; of few values,
    # so that some are the calm level, the threshold, the middle between them and equal peaks
    generator = np.random.default_rng(7)
    kernel = np.exp(-0.5 * np.square(np.arange(-30, 31) / 8))
    noise = [np.convolve(row, kernel, "same") for row in generator.normal(size=(600, 200))]
    values = np.round(0.5 * np.exp(0.15 * np.array(noise)), 1)
    criterion = replace(CRITERION, quiet=quiet, longest=longest)
    expected = [
        event
        for row, course in enumerate(values.tolist())
        for event in isolated_by_hand(row, course, criterion, before)
    ]
    assert len(expected) > 20
    result = isolated_events(values, criterion, before)
    assert result == sorted(expected, key=lambda event: abs(event.peak - 2.0))


def test_what_cannot_be_chosen():
    with pytest.raises(ValueError, match="below"):
        EventCriterion(threshold=1.0, calm=1.0, quiet=1, longest=5, wanted_peak=2.0)
    forecasting = Wrong(TRUTH, 0.0, np.zeros(3)), OBSERVED, OBSERVED
    settings = {"washout": 3, "tolerance": 0.2}
    assert predicted_event([], *forecasting, lead=3, **settings) is None
    event = ExampleEvent(0, (5, 10, 20, 30), 2.0)
    with pytest.raises(IndexError, match="beyond its series"):
        predicted_event([event], *forecasting, lead=4, **settings)


class Wrong(MadeUpForecaster):
    """Knows the truth of every series, and fails in each by a given error from a given step on.

    The second component of the state is the row of the series, the third the step, the last zero.
    """

    def __init__(self, truth, error, failing_from, component=0):
        self.truth, self.error, self.failing_from = truth, error, failing_from
        self.component = component

    def start(self, washout):
        return washout[-1]

    def advance(self, memory, steps):
        series = memory[1].astype(int)
        step = memory[2].astype(int) + 1 + np.arange(steps)[:, np.newaxis]
        # beyond the end of a series the last value
        value = self.truth[series, np.minimum(step, self.truth.shape[1] - 1)]
        series = np.broadcast_to(series, step.shape)
        states = np.stack([value, series, step, np.zeros(step.shape)], axis=1)
        states[:, self.component] += np.where(step >= self.failing_from[series], self.error, 0.0)
        return states, states[-1]


PEAKS = (2.0, 1.9, 2.2)
TRUTH = np.stack([bump(100, (30, 20, 10, peak)) for peak in PEAKS])
OBSERVED = np.stack([TRUTH, *np.indices((3, 100)), np.zeros((3, 100))], axis=2)


EVENTS = isolated_events(TRUTH, CRITERION, before=10)
BREAKDOWNS = [event.times[3] for event in EVENTS]
FAILING = st.sampled_from([0, 23, 40, 45, 50, 1000, *BREAKDOWNS, *np.add(BREAKDOWNS, 1).tolist()])


@given(
    *(st.tuples(FAILING, FAILING, FAILING), st.sampled_from([0.1, 0.3, np.nan])),
    *(st.sampled_from([0, 3]), st.integers(1, 3)),
)
def test_the_event_with_the_longest_prediction_up_to_its_breakdown_is_chosen(
    failing, error, component, batch
):
    """The first of the best: a prediction is lost at its first step beyond the tolerance.

    Whichever component of the state is wrong.
    """
    shares = []
    for event, first in zip(EVENTS, failing, strict=True):
        steps = range(event.times[0] - 7, event.times[3] + 1)
        wrong = [step for step in steps if step >= first and not error < 0.2]
        shares.append(((min(wrong) if wrong else steps.stop) - steps.start) / len(steps))
    wrong = Wrong(TRUTH, error, np.array(failing), component)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("burstcast.forecasts.examples.CANDIDATES_PER_BATCH", batch)
        chosen = predicted_event(
            EVENTS, wrong, OBSERVED, OBSERVED, lead=8, washout=3, tolerance=0.2
        )
    assert chosen is EVENTS[shares.index(max(shares))]


def test_an_event_is_forecast_from_its_washout_to_after_its_breakdown():
    space = MeasuredSeries(("value", "series", "step", "zero"), "value")
    event = ExampleEvent(1, (31, 41, 50, 57), 1.9)
    observed = OBSERVED + np.array([0.01, 0, 0, 0])
    settings = {"lead": 8, "washout": 3, "after": 4, "steps_per_lyapunov_time": 5}
    wrong = Wrong(TRUTH, 0.3, np.full(3, 45))
    result = forecast_event(event, wrong, space, observed, OBSERVED, **settings)
    shown = np.arange(21, 62)  # the forecast starts from step 23
    np.testing.assert_allclose(result.time_lt, (shown - 23) / 5)
    np.testing.assert_array_equal(result.true, TRUTH[1, shown])
    expected = TRUTH[1, shown] + np.where(shown >= 45, 0.3, 0.0)
    expected[:3] = [np.nan, np.nan, TRUTH[1, 23] + 0.01]
    np.testing.assert_array_equal(result.forecast, expected)
    np.testing.assert_array_equal(shown[result.mark], event.times)
    np.testing.assert_array_equal(result.true_state, OBSERVED[1, list(event.times)])
    np.testing.assert_array_equal(result.forecast_state[:, 0], expected[result.mark])
    none = forecast_event(None, wrong, space, observed, OBSERVED, **settings)
    assert (none.true.shape, none.forecast_state.shape) == ((0,), (0, 4))


# -- forecasts of the examples ---------------------------------------------------------------------


@dataclass(frozen=True)
class Drift(MadeUpForecaster):
    """Counts on from the last value and drifts off by a constant in each step."""

    drift: float

    def start(self, washout):
        return washout[-1].copy()

    def advance(self, memory, steps):
        rise = (1 + self.drift) * np.arange(1, steps + 1)
        outputs = memory[np.newaxis] + rise[:, np.newaxis, np.newaxis]
        return outputs, outputs[-1]


def first_component(state):
    return state[0]


SEARCH = HorizonSearch(
    longest_lead_time_lt=3.0,
    lead_time_step_lt=0.5,
    largest_error=1.0,
    washout=3,
    # odd: half a Lyapunov time is no whole number of steps
    steps_per_lyapunov_time=5,
)


def ramp(after):
    """An event at the end of a ramp of slope one, and what follows it."""
    before = SEARCH.steps_before_event
    truth = np.arange(before + 1 + after, dtype=np.float64)
    return truth[: before + 1, np.newaxis], truth


STARTS = [3.0, 2.5, 2.0, 1.5, 1.0, 0.5]


@pytest.mark.parametrize("drift", [0.0, 0.12, 0.3, 5.0])
def test_evaluations_agree_with_the_prediction_horizon(drift):
    observed, truth = ramp(after=4)
    event = SEARCH.steps_before_event
    horizon = prediction_horizons(
        Drift(drift), first_component, observed[np.newaxis], truth[np.newaxis, : event + 1], SEARCH
    )[0]
    result = evaluate_lead_times(Drift(drift), first_component, observed, truth, STARTS, SEARCH)
    found, leads = result.evaluation_horizon_lt, result.evaluation_lead_time_lt
    assert [*leads[found == leads], found[-1]][0] == horizon
    # by hand: the error grows by the drift in each step and is lost at 1
    steps = np.array([15, 12, 10, 7, 5, 2])
    accurate = np.array([sum(drift * (n + 1) < 1 for n in range(count)) for count in steps])
    expected = np.where(accurate == steps, STARTS, accurate / 5)
    np.testing.assert_allclose(found, expected)


def test_evaluations_begin_after_their_start_and_go_beyond_the_event():
    observed, truth = ramp(after=4)
    result = evaluate_lead_times(Drift(0.5), first_component, observed, truth, [2.0], SEARCH)
    start = SEARCH.steps_before_event - 10
    assert np.isnan(result.evaluation_forecast[0, : start + 1]).all()
    np.testing.assert_allclose(
        result.evaluation_forecast[0, start + 1 :], start + 1.5 * np.arange(1, 15)
    )
    # in Lyapunov times after the event, of five steps
    np.testing.assert_allclose(result.evaluation_time_lt, (np.arange(len(truth)) - start - 10) / 5)
    observed, truth = ramp(after=4)
    whole = evaluate_lead_times(Drift(0.0), first_component, observed, truth, STARTS, SEARCH)
    truth[-3:] = np.nan
    cut = evaluate_lead_times(Drift(0.0), first_component, observed, truth, STARTS, SEARCH)
    np.testing.assert_array_equal(whole.evaluation_forecast, cut.evaluation_forecast)
    np.testing.assert_array_equal(whole.evaluation_horizon_lt, cut.evaluation_horizon_lt)


def test_the_event_that_is_nearest_to_the_wanted_horizon_is_shown():
    # starts in the order of the search; the horizon of one that reaches the event is its tau_e
    horizons = np.array([2.5, 1.0, 0.5, 0.3])
    assert horizon_example(horizons, STARTS, 1.1) == (1, (2.5, 2.0, 1.5, 1.0))
    assert horizon_example(horizons, STARTS, 0.2) == (2, (2.0, 1.5, 1.0, 0.5))
    # one with fewer evaluations than are shown, where there is no other
    assert horizon_example(horizons, STARTS, 2.4, 6) == (2, tuple(STARTS))
    assert horizon_example(horizons[:1], STARTS, 1.0) == (0, (3.0, 2.5))
    assert horizon_example(horizons[3:], STARTS, 1.0) is None


def test_outcomes_are_shown_beside_the_truth_and_points_kept_apart():
    truth = np.arange(20.0).reshape(2, 10)
    washouts = np.array([[[3.0], [4.0]], [[11.0], [12.0]]])
    points = SeriesPoints(np.array([0, 1]), np.array([4, 2]))
    how = {"before": 3, "reach": 4, "steps_per_lyapunov_time": 2}
    outcomes = ["false positive", "true positive"]
    result = forecast_outcomes(
        Drift(1.0), first_component, washouts, truth, points, outcomes, **how
    )
    np.testing.assert_array_equal(result.outcome, [1, 0])
    np.testing.assert_array_equal(result.example_time_lt, np.arange(-3, 5) / 2)
    np.testing.assert_array_equal(
        result.example_truth, [[1, 2, 3, 4, 5, 6, 7, 8], [np.nan, 10, 11, 12, 13, 14, 15, 16]]
    )
    np.testing.assert_array_equal(
        result.example_forecast, [[np.nan] * 4 + [6, 8, 10, 12], [np.nan] * 4 + [14, 16, 18, 20]]
    )
    nobody = SeriesPoints(np.empty(0, dtype=int), np.empty(0, dtype=int))
    none = forecast_outcomes(None, first_component, washouts[:0], truth, nobody, [], **how)
    assert none.example_forecast.shape == none.example_truth.shape == (0, 8)
    washouts = np.array([[[1.0], [2.0]], [[5.0], [7.0]], [[0.0], [0.0]]])
    np.testing.assert_array_equal(
        forecast_observable(Drift(0.0), first_component, washouts, 2), [[3, 4], [8, 9], [1, 2]]
    )


@given(st.integers(-9, 9), st.integers(0, 9))
def test_a_stretch_is_cut_out_of_the_series_and_nothing_beyond_it(first, count):
    beyond = np.pad(np.arange(4.0), 20, constant_values=np.nan)
    np.testing.assert_array_equal(
        stretch(np.arange(4.0), first, count), beyond[20 + first : 20 + first + count]
    )


HIGH, LOW = 0.2, 0.05


def windows(*largest):
    """Summaries of points by the largest observable of five windows each; all begin low."""
    table = np.array(largest, dtype=np.float64)
    return WindowSummaries(first=np.full_like(table, LOW), largest=table)


def test_a_miss_that_is_no_error_of_timing_comes_first():
    event, early, never = [LOW, LOW, HIGH, LOW, LOW], [LOW, HIGH, LOW, LOW, LOW], [LOW] * 5

    def shown(forecasts, truth, washouts=(LOW, LOW, LOW)):
        where = {"first_window": 2, "windows": 1, "threshold": 0.1}
        seen = np.array(washouts)[: len(truth)]
        return outcome_examples(windows(*forecasts), windows(*truth), seen, **where)

    assert shown([early, never, early], [event] * 3) == {"false negative": 1}
    assert shown([event] * 3, [early, never, early]) == {"false positive": 1}
    # a marginal one is better than none
    assert list(shown([early] * 3, [event] * 3)) == ["false negative"]
    # what had an event in its washout is not scored
    began = (LOW, HIGH, LOW)
    assert shown([early, never, early], [event] * 3, began) == {"false negative": 2}
    # a hit beside an early forecast is no miss, however tall
    tall = [LOW, LOW, 2 * HIGH, LOW, LOW]
    assert shown([tall, early], [tall, event]) == {"true positive": 0, "false negative": 1}
