"""Probabilities of events as files hold them, and as alarms are raised by them."""

import numpy as np
import pytest

from burstcast.files.netcdf import read_netcdf, write_netcdf
from burstcast.forecast.event_probabilities import EventProbabilities
from burstcast.forecast.forecast_files import forecasts_from
from burstcast.forecast.windows import WindowForecasts
from burstcast.probability.forecast_points import ForecastPoints

PROBABILITIES = EventProbabilities(
    np.random.default_rng(1).random((6, 2)), np.array([0.5, 2.0]), 0.1
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
    "observable_now": np.zeros(6),
}
POINTS = ForecastPoints(DATA, {"esn": FORECASTS, "precursor": PROBABILITIES}, 1.0, 0.5)


def test_a_file_gives_back_what_was_written(tmp_path):
    write_netcdf(tmp_path / "forecast.nc", PROBABILITIES.variables(), {})
    found = forecasts_from(read_netcdf(tmp_path / "forecast.nc"))
    assert isinstance(found, EventProbabilities)
    np.testing.assert_array_equal(found.at(2.0, 0.1), PROBABILITIES.probability[:, 1])
    np.testing.assert_array_equal(found.at(0.5, 0.1), PROBABILITIES.probability[:, 0])


@pytest.mark.parametrize("event", [(1.0, 0.1), (0.5, 0.125)])
def test_another_event_is_refused(event):
    with pytest.raises(ValueError, match=r"events beyond 0.1 and prediction times \[0.5, 2.0\]"):
        PROBABILITIES.at(*event)


def test_a_classifier_is_a_source_of_alarms_like_others():
    alarms = {one.identifier: one for one in POINTS.alarms}
    assert list(alarms) == ["climatology", "observable_now", "esn", "precursor"]
    precursor = alarms["precursor"]
    assert precursor.compared
    np.testing.assert_array_equal(POINTS.values(precursor, 2, 0.1), PROBABILITIES.at(2, 0.1))
    votes = (SUMMARIES[0][:, 3] < 0.1) & (SUMMARIES[1][:, 3:5].max(axis=1) >= 0.1)
    np.testing.assert_array_equal(POINTS.values(alarms["esn"], 2, 0.1), votes.astype(float))
    assert POINTS.classifier(precursor) is PROBABILITIES
    assert POINTS.classifier(alarms["esn"]) is POINTS.classifier(alarms["climatology"]) is None


def test_points_are_labelled_where_no_event_is_under_way():
    labelled = POINTS.labelled([0.5, 2], 0.1)
    kept = [0, 2, 3, 5]
    np.testing.assert_array_equal(labelled.washouts, DATA["washout"][kept])
    np.testing.assert_array_equal(labelled.series, DATA["series"][kept])
    for column, first in enumerate((0, 3)):
        rises = (SUMMARIES[0][:, first] < 0.1) & (
            SUMMARIES[1][:, first : first + 2].max(axis=1) >= 0.1
        )
        np.testing.assert_array_equal(labelled.happened[:, column], rises[kept])
