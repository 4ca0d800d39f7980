"""Campaigns with classifiers, which give probabilities of events without a trajectory."""

import copy
import json

import numpy as np
import pytest
import yaml
from helpers_rebuilds import ROOT, Project
from sklearn.ensemble import HistGradientBoostingClassifier
from sklearn.metrics import average_precision_score, f1_score, recall_score
from snakemake.utils import update_config

from burstcast.base.files.netcdf import read_attributes, read_netcdf
from burstcast.base.files.tables import read_table
from burstcast.data.dataset import component_scales, observed_series
from burstcast.forecasters._event_classifier import LabelledPoints
from burstcast.forecasters.base import ForecastingCase
from burstcast.forecasters.registry import make_kind
from burstcast.systems.mfe import MoehlisFaisstEckhardt

# classifiers have tests in their room
pytestmark = pytest.mark.long
OVERLAY = yaml.safe_load((ROOT / "tests" / "workflow" / "tiny_precursor.yaml").read_text())
LAGS, WASHOUT, SPACING, UNIT, REACH = (0, 6, 12, 18, 24), 30, 6, 61, 4 * 61
TRAINING, TIMES, THRESHOLD = 8, (1, 2, 3), 0.07


# -- a run -----------------------------------------------------------------------------------------


FIGURES = ("forecast_skill", "reliability")


@pytest.fixture(scope="module")
def project(tmp_path_factory, job_server):
    project = Project.create(tmp_path_factory.mktemp("precursor") / "project", job_server)
    figures = [f"{OVERLAY['results']}/figures/{name}.png" for name in FIGURES]
    project.made("tables", *figures, overlay=OVERLAY)
    assert project.dry_run("tables", overlay=OVERLAY) == {}
    return project


@pytest.fixture(scope="module")
def results(project):
    return project.directory / OVERLAY["results"]


def labelled(observed_energy, truth, row, step):
    """Whether a point counts, and whether an event follows in each window."""
    quiet = observed_energy[row, step + 1 - WASHOUT : step + 1].max() < THRESHOLD
    follows = []
    for time in TIMES:
        window = truth[row, step + time * UNIT : step + (time + 1) * UNIT + 1]
        follows.append(window[0] < THRESHOLD <= window.max())
    return quiet, follows


@pytest.fixture(scope="module")
def by_hand(results):
    """Features, labels and rows of points in the training series, point by point; all series."""
    ensemble = read_netcdf(results / "Re400/ensemble.nc")
    scales, truth = component_scales(ensemble["state"][:TRAINING]), ensemble["observable"]
    seen = observed_series(ensemble["state"], 0, 0.01, scales, 2022, "Re400")
    energy = 0.5 * (seen**2).sum(axis=2)
    features, happened, rows = [], [], []
    for row in range(TRAINING):
        for step in range(WASHOUT - 1, truth.shape[1] - REACH, SPACING):
            quiet, follows = labelled(energy, truth, row, step)
            if quiet:
                features.append(np.concatenate([seen[row, step - lag] for lag in LAGS]))
                happened.append(follows)
                rows.append(row)
    return np.array(features), np.array(happened), np.array(rows), seen, truth


def classifier(features, happened):
    return HistGradientBoostingClassifier(
        max_iter=150, max_leaf_nodes=12, learning_rate=0.08, early_stopping=False, random_state=0
    ).fit(features, happened)


def features_at(seen, points, first):
    return np.array(
        [
            np.concatenate([seen[first + row, step - lag] for lag in LAGS])
            for row, step in zip(points["series"], points["step"], strict=True)
        ]
    )


def test_probabilities_are_those_of_a_classifier_of_the_series(results, by_hand):
    features, happened, _, seen, _ = by_hand
    points = read_netcdf(results / "Re400" / "evaluation_set.nc")
    forecast = read_netcdf(results / "Re400/classifiers/precursor" / "forecast.nc")
    assert forecast["prediction_time_lt"].tolist() == list(TIMES)
    tested = features_at(seen, points, TRAINING)
    for window in range(len(TIMES)):
        oracle = classifier(features, happened[:, window]).predict_proba(tested)[:, 1]
        np.testing.assert_allclose(forecast["probability"][:, window], oracle, rtol=1e-12)
    stored = read_netcdf(results / "Re400/classifiers/precursor" / "forecaster.nc")
    np.testing.assert_allclose(stored["features"], features, rtol=1e-12)
    np.testing.assert_array_equal(stored["happened"], happened)


def test_calibration_has_not_learnt_from_what_it_forecasts(results, by_hand):
    features, happened, rows, seen, _ = by_hand
    points = read_netcdf(results / "Re400" / "calibration_set.nc")
    probability = read_netcdf(results / "Re400/classifiers/precursor/calibration_forecast.nc")[
        "probability"
    ]
    asked = features_at(seen, points, 0)
    for fold in range(3):
        here, others = points["series"] % 3 == fold, rows % 3 != fold
        for window in range(len(TIMES)):
            labels = happened[others, window]
            if len(set(labels)) == 1:
                expected = np.full(here.sum(), float(labels[0]))
            else:
                oracle = classifier(features[others], labels)
                expected = oracle.predict_proba(asked[here])[:, 1]
            np.testing.assert_allclose(probability[here, window], expected, rtol=1e-12)


def test_its_alarms_are_scored_like_those_of_others(results, by_hand):
    _, _, _, seen, truth = by_hand
    energy = 0.5 * (seen**2).sum(axis=2)
    points = read_netcdf(results / "Re400/evaluation_set.nc", "series", "step")
    raw = read_netcdf(results / "Re400/classifiers/precursor/forecast.nc")["probability"]
    chosen = json.loads((results / "Re400/calibration.json").read_text())
    rules = chosen["alarms"]["precursor"]
    assert list(rules) == [f"{time}" for time in TIMES]
    pairs = [
        labelled(energy, truth, TRAINING + row, step)
        for row, step in zip(points["series"], points["step"], strict=True)
    ]
    scored, happened = (np.array(column) for column in zip(*pairs, strict=True))
    table, scores = (
        rows[(rows["case"] == "Re400") & (rows["forecaster"] == "precursor")]
        for rows in (
            read_table(results / f"tables/{name}.csv")
            for name in ("classification", "probability_scores")
        )
    )
    for window, time in enumerate(TIMES):
        rule, votes = rules[f"{time}"]["calibrated"], raw[scored, window]
        probability = np.interp(votes, rule["values"], rule["probabilities"])
        alarms, events = probability >= rule["threshold"], happened[scored, window]
        (row,) = table[table["prediction_time_lt"] == time].to_dict("records")
        assert row["true_positive"] + row["false_positive"] == alarms.sum()
        assert row["true_positive"] + row["false_negative"] == events.sum()
        assert row["f_score"] == pytest.approx(f1_score(events, alarms))
        assert row["recall"] == pytest.approx(recall_score(events, alarms))
        mine = scores[scores["prediction_time_lt"] == time]
        mine = mine.set_index(["probability", "metric"])["value"]
        assert mine["calibrated", "alarm_f_score"] == pytest.approx(row["f_score"])
        assert mine["calibrated", "alarm_threshold"] == rule["threshold"]
        precision = average_precision_score(events, votes)
        assert mine["votes", "average_precision"] == pytest.approx(precision)


def test_every_table_of_probabilities_has_it_and_none_of_trajectories(results):
    of_kind = {}
    for path in (results / "tables").glob("*.csv"):
        table = read_table(path)
        if "forecaster" in table:
            kinds = {"precursor", "esn_direct"}
            of_kind[path.stem] = kinds & set(table["forecaster"]) == kinds
    having = {
        *("classification", "classification_intervals", "classification_percentiles"),
        *("probability_scores", "reliability", "lead_times", "warnings"),
    }
    assert {name for name, has in of_kind.items() if has} == having
    assert {"horizon", "horizon_intervals"} <= set(of_kind)


def test_a_part_of_the_state_is_learnt_from_what_is_seen_of_it(results):
    part, whole = (
        read_netcdf(results / case / "classifiers/precursor/forecaster.nc")
        for case in ("modes_4", "Re400")
    )
    # its four components, and the observable, which is none of them
    assert part["features"].shape[1] == 5 * len(LAGS)
    # the same events, scored where what is seen of them says that none is under way
    assert abs(len(part["happened"]) - len(whole["happened"])) < 5


def test_a_reservoir_is_read_out_as_the_library_does_it(results, by_hand):
    _, happened, rows, _, _ = by_hand
    place = results / "Re400/classifiers/esn_direct"
    attributes = read_attributes(place / "forecaster.nc")
    assert (attributes["random_seed"], attributes["seed"], attributes["penalty"]) == (2022, 0, 1)
    options = {"neurons": 30, "penalty": [1], "backend": "scipy", "input_scaling": [1, 10]}
    # simulated cases have the paper's inputs, the library has others by default
    options |= {"input_bias": 0.1, "input_offset": "none", "readout": "linear"}
    case = ForecastingCase(MoehlisFaisstEckhardt(400.0), 0.5, 2, UNIT, random_seed=2022)
    training = read_netcdf(results / "Re400/training_set.nc")
    kept = training["washout_maximum"] < THRESHOLD
    points = LabelledPoints(training["washout"][kept], happened, rows)
    fitted = make_kind("esn_direct", options).fit(points, case)
    tested = read_netcdf(results / "Re400/evaluation_set.nc", "washout")["washout"]
    forecast = read_netcdf(place / "forecast.nc")["probability"]
    np.testing.assert_allclose(forecast, fitted.probabilities(tested), rtol=1e-9)


# -- what runs again -------------------------------------------------------------------------------

SPACED = {"forecasters": {"classifiers": {"start_spacing_lt": 0.2}}}
SCORES = {
    *("calibrate", "classification_table", "probability_scores", "reliability_table"),
    *("lead_times", "warnings_table"),
}


@pytest.mark.parametrize(
    ("change", "first"),
    [
        ({"forecasters": {"precursor": {"lags_lt": [0.2]}}}, {"event_probabilities"}),
        (SPACED, {"training_set", "event_probabilities"}),
        ({"probability": {"prior_forecasts": 20}}, set()),
    ],
)
def test_what_runs_again_after_an_edit(project, change, first):
    overlay = copy.deepcopy(OVERLAY)
    update_config(overlay, change)
    planned = project.dry_run("tables", overlay=overlay)
    rules = {rule for rule in planned if not rule.startswith("joined_")}
    assert rules <= first | SCORES
    assert first | {"calibrate", "classification_table"} <= rules


def test_a_window_without_an_event_is_told_by_the_first_job_that_knows(project, tmp_path):
    work = project.copy(tmp_path / "project")
    overlay = copy.deepcopy(OVERLAY)
    update_config(overlay, {"case_defaults": {"event_threshold": 0.28}})
    target = f"{OVERLAY['results']}/Re400/classifiers/precursor/forecast.nc"
    outcome = work.snakemake(target, overlay=overlay)
    assert outcome.status != 0
    assert "case Re400: an event follows 0 of the" in outcome.text
    assert "needs both kinds of points; change event_threshold" in outcome.text
