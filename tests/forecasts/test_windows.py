"""Windows of forecasts against plain loops: summaries, crossings, members, starting points."""

from dataclasses import replace
from itertools import pairwise, product

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as npst
from numpy.testing import assert_array_equal

from burstcast.base.exogenous import with_inputs
from burstcast.base.files.netcdf import variables_of
from burstcast.data.starting_points import SeriesPoints
from burstcast.forecasters.analogues import Analogues
from burstcast.forecasters.base import ForecastingCase
from burstcast.forecasters.equations_filtered import FilteredEquations
from burstcast.forecasters.linear_inverse import LinearInverseModel
from burstcast.forecasts import windows as module
from burstcast.forecasts.forecast_files import (
    event_summary,
    event_variables,
    forecast_variables,
    forecasts_from,
    horizon_variables,
    point_variables,
    schedule_variables,
)
from burstcast.forecasts.points import ForecastPoints, observed_points
from burstcast.forecasts.probabilities import EventProbabilities
from burstcast.forecasts.windows import (
    WindowForecasts,
    crosses,
    summarise,
    window_boundaries,
    window_forecasts,
)
from burstcast.systems.lorenz63 import Lorenz63
from burstcast.systems.parameters import SystemParameters
from helpers_library import lorenz_series

THRESHOLD = 0.1


def crosses_by_hand(values, first, last, threshold):
    """Below at the first step of the window, and at or above it somewhere in the window."""
    window = [values[step] for step in range(first, last + 1)]
    reaches = any(value >= threshold for value in window)
    return bool(all(map(np.isfinite, window)) and window[0] < threshold and reaches)


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
    below = np.nextafter(THRESHOLD, 0)
    elements = st.sampled_from([0.0, 0.05, below, THRESHOLD, 0.2, np.nan, np.inf])
    how = {"elements": elements, "fill": st.sampled_from([0.0, 0.05, 0.2])}
    observable = data.draw(npst.arrays(np.float64, (boundaries[-1] + 1, 3), **how))
    result = crosses(summarise(observable[1:], boundaries), before, length, THRESHOLD)
    first = int((before + 1) * resolution * lyapunov_time)
    last = int((before + 1 + length) * resolution * lyapunov_time)
    expected = [crosses_by_hand(observable[:, row], first, last, THRESHOLD) for row in range(3)]
    assert result.tolist() == expected


@pytest.mark.parametrize(("first", "length"), [(-1, 1), (1, 2), (2, 1)])
def test_windows_beyond_the_forecast_are_refused(first, length):
    summaries = summarise(np.zeros((5, 1)), (1, 3, 5))
    with pytest.raises(IndexError, match="beyond the forecast"):
        crosses(summaries, first, length, THRESHOLD)


# -- forecasts reduced to windows ------------------------------------------------------------------

CASE = ForecastingCase(Lorenz63(), 0.01, 2, 50)
BOUNDARIES = (3, 8, 20)
FILTER = FilteredEquations(noise=0.02, members=6)
RHO = SystemParameters.of(Lorenz63(), ["rho"])
MEMBERS = {
    "equations_filtered": (FILTER, 6, CASE),
    "under schedules": (FILTER, 6, replace(CASE, parameters=RHO)),
    "analogues": (Analogues(neighbours=4), 4, CASE),
    "linear_inverse": (LinearInverseModel(), 1, CASE),
}


def first_component(states):
    return states[0]


@pytest.fixture(scope="module")
def training():
    """Three series of 300 steps."""
    return np.ascontiguousarray(lorenz_series(3, 101, 401))


@pytest.fixture(scope="module")
def washouts(training):
    """Twelve stretches of ten steps, with noise."""
    starts = [(row, start) for row in range(3) for start in (20, 70, 120, 200)]
    result = np.stack([training[row, start : start + 10] for row, start in starts])
    return result + 0.05 * np.random.default_rng(1).standard_normal(result.shape)


@pytest.mark.parametrize("batches", [(1, 1), (5, 30), (12, 7), ()])
@pytest.mark.parametrize(("kind", "number", "case"), MEMBERS.values(), ids=MEMBERS)
def test_forecasts_are_those_of_each_memory_alone(
    kind, number, case, batches, training, washouts, monkeypatch
):
    """Whatever the batches are; under schedules, each point keeps its own one."""
    forecaster = kind.fit(training, case)
    if case.parameters:
        schedule = np.random.default_rng(6).choice([24.0, 28.0], size=(12, 9 + BOUNDARIES[-1], 1))
        washouts = with_inputs(washouts, schedule)
    for name, size in zip(("POINTS_PER_BATCH", "TRAJECTORIES_PER_BATCH"), batches, strict=False):
        monkeypatch.setattr(module, name, size)
    result = window_forecasts(forecaster, first_component, washouts, BOUNDARIES)
    assert len(result.members) == number
    assert result.member_first.shape == (12, number if number > 1 else 0, 2)
    for point, washout in enumerate(washouts):
        given = np.ascontiguousarray(washout[:, :, np.newaxis])
        ensemble = forecaster.ensemble(given)
        members = [np.ascontiguousarray(ensemble[..., member, :]) for member in range(number)]
        for summaries, memory in zip(
            [result, *result.members], [forecaster.start(given), *members], strict=True
        ):
            outputs, _ = forecaster.advance(memory, BOUNDARIES[-1])
            expected = summarise(outputs[:, 0], BOUNDARIES)
            np.testing.assert_array_equal(summaries.first[point], expected.first[0])
            np.testing.assert_array_equal(summaries.largest[point], expected.largest[0])


def test_forecasts_that_are_lost_have_diverged(training, washouts):
    lost = np.where(np.arange(12)[:, np.newaxis, np.newaxis] == 5, np.inf, washouts)
    model = LinearInverseModel().fit(training, CASE)
    with np.errstate(invalid="ignore"):
        result = window_forecasts(model, first_component, lost, BOUNDARIES)
    assert np.flatnonzero(result.diverged).tolist() == [5]


# -- points with what is observed ------------------------------------------------------------------


def test_points_one_by_one():
    generator = np.random.default_rng(1)
    truth, observed = generator.normal(size=(3, 60)), generator.normal(size=(3, 60, 2))
    washout, spacing, boundaries = 5, 7, (2, 4, 9)
    where = {"spacing": spacing, "washout": washout, "boundaries": boundaries}
    result = observed_points(observed, truth, lambda state: state[0] * state[1], **where)
    places = list(product(range(3), range(washout - 1, 60 - boundaries[-1], spacing)))
    for row, (series, now) in enumerate(places):
        assert (result.points.series[row], result.points.step[row]) == (series, now)
        seen = observed[series, now - washout + 1 : now + 1]
        assert_array_equal(result.washouts[row], seen)
        assert_array_equal(result.seen[row], seen[:, 0] * seen[:, 1])
        for window, (start, end) in enumerate(pairwise(boundaries)):
            following = truth[series, now + start : now + end + 1]
            assert result.truth.first[row, window] == following[0]
            assert result.truth.largest[row, window] == following.max()
    assert len(result.points) == len(places)


# -- probabilities of events in files --------------------------------------------------------------

PROBABILITIES = EventProbabilities(
    np.random.default_rng(1).random((6, 2)), np.array([0.5, 2.0]), np.array([0.1])
)
NONE = np.empty((6, 0, 8))
SUMMARIES = np.random.default_rng(2).random((2, 6, 8)) / 5
FORECASTS = WindowForecasts(*SUMMARIES, np.zeros(6, dtype=bool), NONE, NONE)
DATA = {
    "first": SUMMARIES[0],
    "largest": SUMMARIES[1],
    "series": np.array([0, 0, 1, 1, 2, 2]),
    "washout": np.arange(60.0).reshape(6, 5, 2),
    "washout_maximum": np.array([0.0, 0.2, 0.09, 0.05, 0.1, 0.0]),
    "observable_now": np.array([0.0, 0.1, 0.09, 0.01, 0.03, 0.0]),
}
POINTS = ForecastPoints(DATA, {"esn": FORECASTS, "precursor": PROBABILITIES}, 1.0, 0.5)


@pytest.mark.parametrize("event", [(1.0, 0.1), (0.5, 0.125)])
def test_another_event_is_refused(event):
    with pytest.raises(ValueError, match=r"events beyond 0.1 and prediction times \[0.5, 2.0\]"):
        PROBABILITIES.at(*event)


def test_a_classifier_is_a_source_of_alarms_like_others():
    alarms = {item.identifier: item for item in POINTS.alarms}
    assert list(alarms) == ["climatology", "observable_now", "esn", "precursor"]
    precursor = alarms["precursor"]
    assert precursor.compared
    np.testing.assert_array_equal(POINTS.values(precursor, 2, 0.1), PROBABILITIES.at(2, 0.1))
    votes = (SUMMARIES[0][:, 3] < 0.1) & (SUMMARIES[1][:, 3:5].max(axis=1) >= 0.1)
    np.testing.assert_array_equal(POINTS.values(alarms["esn"], 2, 0.1), votes.astype(float))
    now = POINTS.values(alarms["observable_now"], 2, 0.1)
    np.testing.assert_array_equal(now, DATA["observable_now"])
    assert not POINTS.values(alarms["climatology"], 2, 0.1).any()
    assert POINTS.classifier(precursor) is PROBABILITIES
    assert POINTS.classifier(alarms["esn"]) is POINTS.classifier(alarms["climatology"]) is None


def test_points_are_labelled_where_no_event_is_under_way():
    assert POINTS.series == 3
    labelled, kept, (first, largest) = POINTS.labelled([0.5, 2], 0.1), [0, 2, 3, 5], SUMMARIES
    np.testing.assert_array_equal(labelled.washouts, DATA["washout"][kept])
    np.testing.assert_array_equal(labelled.series, DATA["series"][kept])
    for column, start in enumerate((0, 3)):
        rises = (first[:, start] < 0.1) & (largest[:, start : start + 2].max(axis=1) >= 0.1)
        np.testing.assert_array_equal(labelled.happened[:, column], rises[kept])


# -- what files hold -------------------------------------------------------------------------------


def held(variables):
    """Data of variables by name, whose dimensions they have."""
    for item in variables.values():
        assert np.ndim(item.data) == len(item.dimensions)
    return {name: item.data for name, item in variables.items()}


def test_files_hold_what_lies_around_each_point_and_event():
    generator = np.random.default_rng(1)
    observed, states = generator.normal(size=(2, 3, 60, 2))
    truth, schedules = generator.normal(size=(5, 60)), generator.normal(size=(3, 59, 1))
    where = {"spacing": 7, "washout": 5, "boundaries": (2, 4, 9)}
    result = observed_points(observed, truth[2:], first_component, **where)
    points = held(point_variables(result, states, "x") | schedule_variables(result, schedules, 9))
    for row, (series, now) in enumerate(zip(points["series"], points["step"], strict=True)):
        seen = slice(now - 4, now + 1)
        assert_array_equal(points["washout"][row], observed[series, seen])
        assert_array_equal(points["true_washout"][row], states[series, seen])
        assert_array_equal(points["parameter"][row], schedules[series, now - 4 : now + 9])
        assert points["observable_now"][row] == observed[series, now, 0]
        assert points["washout_maximum"][row] == observed[series, seen, 0].max()
    assert_array_equal(points["first"], result.truth.first)
    assert_array_equal(points["largest"], result.truth.largest)
    events = SeriesPoints(np.array([2, 4, 3]), np.array([20, 33, 59]))
    arguments = events, 2, observed, states, truth, 6
    assert "parameter" not in event_variables(*arguments)
    of_events = held(event_variables(*arguments, schedules))
    for row, (series, step) in enumerate(((2, 20), (4, 33), (3, 59))):
        before = slice(step - 6, step + 1)
        assert (of_events["series"][row], of_events["step"][row]) == (series, step)
        assert_array_equal(of_events["observed"][row], observed[series - 2, before])
        assert_array_equal(of_events["true_state"][row], states[series - 2, before])
        assert_array_equal(of_events["truth"][row], truth[series, before])
        assert_array_equal(of_events["parameter"][row], schedules[series - 2, step - 6 : step])
    horizons = held(horizon_variables(events.series, events.step, np.array([1.0, 2.0, 0.5])))
    assert horizons["prediction_horizon_lt"].tolist() == [1.0, 2.0, 0.5]
    assert horizons["step"].tolist() == [20, 33, 59]


@pytest.mark.parametrize("members", [0, 3])
def test_forecasts_come_back_from_their_files(members):
    first, largest = np.random.default_rng(2).random((2, 6, 4))
    of_members = np.random.default_rng(3).random((2, 6, members, 4))
    forecasts = WindowForecasts(first, largest, np.arange(6) % 2 == 0, *of_members)
    result = forecasts_from(held(forecast_variables(forecasts, "x")))
    for name, values in vars(forecasts).items():
        assert_array_equal(getattr(result, name), values)
    again = forecasts_from(held(variables_of(PROBABILITIES)))
    for column, time in enumerate((0.5, 2.0)):
        assert_array_equal(again.at(time, 0.1), PROBABILITIES.probability[:, column])


def test_events_are_summed_up():
    observable = np.array([[0.0, 1.0, 2.0, 0.0], [0.5, 0.0, 0.0, 1.0]])
    assert event_summary(observable, 1.0, 1, 3, 2) == {
        **{"event_share": 3 / 8, "training_event_share": 0.5, "events_per_series": 1.5},
        **{"usable_events": 2, "largest_observable": 2.0},
    }
