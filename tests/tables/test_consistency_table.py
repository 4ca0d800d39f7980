"""The table of scores by the consistency of washouts, counted point by point."""

import numpy as np
import pytest

from burstcast.base.names import parsed
from burstcast.forecasts.alarms import UNCALIBRATED, AlarmRule
from burstcast.forecasts.forecast_files import forecasts_from
from burstcast.forecasts.points import ForecastPoints
from burstcast.tables.makers._probabilities import CaseProbabilities
from burstcast.tables.makers.consistency_table import make
from burstcast.tables.makers.registry import Gathered

POINTS, SERIES = 60, 6


@pytest.fixture
def case():
    """Random forecasts of one window by an ensemble of ten, and a forecaster without a test."""
    generator = np.random.default_rng(0)
    event = generator.random(POINTS) < 0.4
    evaluation_set = {
        "series": np.arange(POINTS) % SERIES,
        "first": np.zeros((POINTS, 1)),
        "largest": np.where(event, 1.0, 0.0)[:, np.newaxis],
        "washout_maximum": (np.arange(POINTS) % 7 == 0).astype(float),  # under way at some
        "observable_now": np.zeros(POINTS),
    }
    votes = generator.random((POINTS, 10)) < np.where(event, 0.7, 0.2)[:, np.newaxis]
    members = votes[..., np.newaxis].astype(float)
    forecast = {
        "first": np.zeros((POINTS, 1)),
        "largest": members[:, 0],
        "diverged": np.zeros(POINTS, dtype=bool),
        "member_first": np.zeros((POINTS, 10, 1)),
        "member_largest": members,
    }
    forecasts = {name: forecasts_from(forecast) for name in ("equations", "quadratic_filtered")}
    points = ForecastPoints(evaluation_set, forecasts, 1.0, 1.0)
    rule = {"calibrated": AlarmRule(UNCALIBRATED, 0.5).record()}
    chosen = {"alarms": {alarm.identifier: {"1": rule} for alarm in points.alarms}}
    return CaseProbabilities(points, chosen, "Re400", 1, 0.5, [1.0], 50, 0.9)


def test_scores_are_those_of_the_points_of_each_group(case):
    p_values = np.random.default_rng(3).choice([0.01, 0.05, 0.06, 0.8], POINTS)
    tests = [Gathered(parsed("quadratic_filtered"), {"p_value": p_values})]
    rows = make(case=case, tests=tests, bins=11)["consistency"]
    data, forecast = case.points.data, case.points.forecasts["quadratic_filtered"]
    quiet = data["washout_maximum"] < 0.5
    happened = data["largest"][:, 0] >= 0.5
    votes = forecast.member_largest[..., 0].mean(axis=1)
    # the single forecast and the members' votes; the other forecaster has no test
    committee = "quadratic_filtered-committee"
    assert {row["alarm"] for row in rows} == {"quadratic_filtered", committee}
    rows = [row for row in rows if row["alarm"] == committee]
    for name, chosen in (("consistent", p_values > 0.05), ("inconsistent", p_values <= 0.05)):
        found = {row["metric"]: row for row in rows if row["washouts"] == name}
        here = chosen & quiet
        rate = happened[here].mean()
        error = np.square(votes[here] - happened[here]).mean()
        alarms = votes[here] >= 0.5
        hits = (alarms & happened[here]).sum()
        expected = {
            "washout_fraction": here.sum() / quiet.sum(),
            "base_rate": rate,
            "brier_skill": 1 - error / (rate * (1 - rate)),
            "alarm_f_score": 2 * hits / (alarms.sum() + happened[here].sum()),
        }
        for metric, value in expected.items():
            assert found[metric]["value"] == pytest.approx(value), metric
            assert found[metric]["low"] <= value <= found[metric]["high"]


def test_without_an_inconsistent_washout_its_scores_are_undefined(case):
    tests = [Gathered(parsed("quadratic_filtered"), {"p_value": np.ones(POINTS)})]
    rows = make(case=case, tests=tests, bins=11)["consistency"]
    values = {(row["washouts"], row["metric"]): row["value"] for row in rows}
    assert values["consistent", "washout_fraction"] == 1.0
    assert values["inconsistent", "washout_fraction"] == 0.0
    assert np.isnan(values["inconsistent", "brier_skill"])


def test_a_forecaster_without_a_test_has_no_rows(case):
    tests = [Gathered(parsed("quadratic_filtered"), {"p_value": np.full(POINTS, np.nan)})]
    assert make(case=case, tests=tests, bins=11) == {"consistency": []}
