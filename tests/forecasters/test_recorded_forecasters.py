"""Forecasts that another program has made go on from their own washouts, and have horizons."""

import numpy as np
import pytest

from burstcast.benchmark.task import horizon_starts
from burstcast.data.starting_points import SeriesPoints, segments
from burstcast.forecast.horizon import HorizonSearch
from burstcast.forecasters._recorded import RecordedForecasts, recorded_horizons


def test_recorded_forecasts_go_on_from_their_washouts():
    washouts = np.arange(24.0).reshape(4, 3, 2)
    outputs = np.arange(40.0).reshape(4, 10, 1)
    recorded = RecordedForecasts(washouts, outputs)
    memory = recorded.start(np.ascontiguousarray(washouts[[2, 0]].transpose(1, 2, 0)))
    first, memory = recorded.advance(memory, 4)
    later, _ = recorded.advance(memory[:, 1:], 6)
    assert np.array_equal(first[:, 0].T, outputs[[2, 0], :4, 0])
    assert np.array_equal(later[:, 0, 0], outputs[0, 4:, 0])
    again = RecordedForecasts.restore(recorded.record(), None)
    assert np.array_equal(again.start(washouts[[1]].transpose(1, 2, 0)), [[1.0], [0.0]])
    with pytest.raises(ValueError, match="1 of 2 washouts have no recorded forecast"):
        recorded.start(np.stack([washouts[0], washouts[1] + 1], axis=2))
    with pytest.raises(ValueError, match="have 10 steps, and 11 are requested"):
        recorded.advance(memory, 7)
    with pytest.raises(NotImplementedError):
        RecordedForecasts.fit(washouts, None)


def test_horizons_are_found_in_the_recorded_forecasts():
    """Right for all steps, or for less than half a Lyapunov time: no start reaches its event."""
    search = HorizonSearch(
        longest_lead_time_lt=2.0,
        lead_time_step_lt=0.5,
        tolerance=0.1,
        washout=3,
        steps_per_lyapunov_time=20,
    )
    truth = np.random.default_rng(2).normal(size=(2, 200))
    events = SeriesPoints(np.array([0, 1]), np.array([120, 150]))
    before = segments(truth[..., np.newaxis], events, search.steps_before_event, 0)
    starts = horizon_starts(events, search, np.random.default_rng(1))
    washouts = segments(before, SeriesPoints(*starts), search.washout - 1, 0)
    steps = search.longest_lead_time
    event, step = starts
    right = np.stack(
        [
            truth[one, events.step[one] - search.steps_before_event + at + 1 :][:steps]
            for one, at in zip(event, step, strict=True)
        ]
    )

    def horizons(forecasts):
        return recorded_horizons(washouts, forecasts, before, before[..., 0], search)

    assert (horizons(right) == 2.0).all()
    wrong = np.where(np.arange(steps) < 9, right, 9.0)
    assert (horizons(wrong) == 9 / 20).all()
    assert (horizons(right[::-1]) < 0.2).all()
