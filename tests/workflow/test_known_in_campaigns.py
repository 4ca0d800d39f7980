"""A record with columns that are known in advance, through the stages of the workflow."""

import numpy as np
import pytest
from helpers_rebuilds import Project

from burstcast.base.files.netcdf import read_netcdf
from burstcast.base.files.tables import read_table

SAMPLES, BLOCK = 1100, 50
NETWORKS = {"neurons": [40], "validation": ["RV"], "seeds": 2}
FORECASTERS = {
    **{"esn": {**NETWORKS, "seeds": 1}, "esn_aware": NETWORKS, "quadratic_aware": {}},
    **{"quadratic_aware_filtered": {}, "precursor": {}},
}
PLANT = {
    "data": {
        **{"files": ["plant.csv"], "time_step": "1 hour", "components": ["x", "y"]},
        **{"observable": "x", "known": ["push", "day_sin"], "blocks": {"duration": BLOCK - 1}},
    },
    **{"training": {"series": 10}, "recycle_validation": {"series": 3}},
    **{"event_threshold": 0.6, "lyapunov": {"given_exponent": 0.25}},
}
CONFIG = {
    "results": "results/plant",
    "campaign": [{"cases": ["plant"], "forecasters": FORECASTERS}],
    "cases": {"plant": PLANT},
    "washout_lt": 2,
    "forecasters": {
        "esn": {"connectivity": 5, "backend": "scipy"},
        "filter": {"members": 8},
        "quadratic": {"degree": 1, "window_lt": 0.25},
        "classifiers": {"start_spacing_lt": 0.25},
        "precursor": {"classifier": "logistic", "lags_lt": [0.25]},
    },
    "search": {"grid": 2, "bayesian_points": 1, "interval_lt": 1},
    "classification": {
        **{"start_spacing_lt": 0.25, "longest_prediction_time_lt": 2, "window_lt": 1},
        **{"resolution_lt": 0.5, "prediction_times_lt": [0.5, 2]},
    },
    "horizon": {"events": 20, "longest_lead_time_lt": 2, "lead_time_step_lt": 0.5},
    "statistics": {
        "forecasters": {"esn": {}, "esn_aware": {}},
        **{"starting_points": 4, "duration": 40, "fixed_point_interval_lt": 1},
        **{"lyapunov_exponents": 0, "floor_splits": 2},
    },
    "bootstrap": {"resamples": 20},
    "control": {"forecasters": {"esn": None, "equations": None}},
}

TABLES = ("classification", "horizon", "statistics", "probability_scores")
TARGETS = [f"results/plant/tables/{name}.csv" for name in TABLES]


def plant():
    """States under a push that nothing in them tells of in advance, and the push."""
    generator = np.random.default_rng(3)
    noise = 0.01 * generator.normal(size=(SAMPLES, 2))
    push, states = np.zeros(SAMPLES), np.zeros((SAMPLES, 2))
    for hour in range(1, SAMPLES):
        changes = generator.random() < 0.15
        push[hour] = generator.choice([0, 0, 1]) if changes else push[hour - 1]
        x, y = states[hour - 1]
        daily = 0.1 * np.sin(2 * np.pi * hour / 24)
        states[hour] = noise[hour] + [0.6 * x + 0.4 * push[hour] + daily, 0.8 * y + 0.2 * x]
    return states, push


def write_record(directory):
    states, push = plant()
    stamps = np.datetime64("2020-01-01T00") + np.arange(SAMPLES).astype("timedelta64[h]")
    phase = np.sin(2 * np.pi * np.arange(SAMPLES) / 24)  # the record begins at midnight
    rows = zip(stamps.astype("datetime64[m]"), *states.T, push, phase, strict=True)
    lines = [f"{stamp}," + ",".join(f"{value:.17g}" for value in values) for stamp, *values in rows]
    (directory / "plant.csv").write_text("\n".join(["time,x,y,push,day_sin", *lines, ""]))


@pytest.fixture(scope="module")
def project(tmp_path_factory, job_server):
    directory = tmp_path_factory.mktemp("known") / "project"
    project = Project.create(directory, job_server, "plant.yaml", CONFIG)
    write_record(directory)
    return project


@pytest.fixture(scope="module")
def results(project):
    outcome = project.made(*TARGETS)
    assert "velocity profiles, long runs of forecasters that learn from data.known" in outcome.text
    return project.directory / "results/plant"


@pytest.mark.long
def test_points_and_events_have_what_is_known_of_their_own_steps(results):
    states, push = plant()
    phase = np.sin(2 * np.pi * np.arange(SAMPLES) / 24)  # the record begins at midnight
    points = read_netcdf(results / "plant/evaluation_set.nc")
    washout, reach = points["washout"].shape[1], points["parameter"].shape[1]
    for number in range(0, len(points["series"]), 7):
        first = (10 + points["series"][number]) * BLOCK + points["step"][number] - washout + 1
        np.testing.assert_array_equal(points["washout"][number], states[first : first + washout])
        columns = points["parameter"][number]
        np.testing.assert_array_equal(columns[:, 0], push[first + 1 : first + 1 + reach])
        np.testing.assert_allclose(columns[:, 1], phase[first + 1 : first + 1 + reach], atol=1e-9)
    events = read_netcdf(results / "plant/events.nc")
    assert len(events["series"]) == 10
    for number, columns in enumerate(events["parameter"]):
        event = events["series"][number] * BLOCK + events["step"][number]
        np.testing.assert_array_equal(columns[:, 0], push[event - len(columns) + 1 : event + 1])


@pytest.mark.long
def test_what_is_known_in_advance_tells_events_that_nothing_else_does(results):
    scores = read_table(results / "tables/classification.csv")
    scores = scores[scores["prediction_time_lt"] == 2].groupby("forecaster")["f_score"].mean()
    assert scores["esn"] < 0.3
    for kind in ("esn_aware", "quadratic_aware", "quadratic_aware_filtered"):
        assert scores[kind] > 0.8, scores
    # nine events are not enough to calibrate its votes well; those themselves have a skill
    assert scores["precursor"] > 0.4 > 3 * scores["permanent_alarm"]
    horizons = read_table(results / "tables/horizon.csv").groupby("forecaster")["mean_horizon_lt"]
    assert horizons.mean()["quadratic_aware"] > 1.5 > 0.3 > horizons.mean()["esn"]
    probabilities = read_table(results / "tables/probability_scores.csv")
    skill = probabilities[
        (probabilities["metric"] == "brier_skill") & (probabilities["prediction_time_lt"] == 2)
    ].set_index(["alarm", "probability"])["value"]
    assert skill["esn_aware-N40-RV-committee", "calibrated"] > 0.6
    assert skill["precursor", "votes"] > 0.4


@pytest.mark.long
def test_no_stage_has_runs_without_known_values(project, results):
    assert (results / "plant/networks/esn-N40-RV-seed0/long_term.nc").exists()
    assert not (results / "plant/networks/esn_aware-N40-RV-seed0/long_term.nc").exists()
    forecasters = set(read_table(results / "tables/statistics.csv")["forecaster"])
    assert forecasters <= {"esn", "floor", "training"}
    assert project.dry_run(*TARGETS) == {}
