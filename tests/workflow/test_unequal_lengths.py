"""A measured campaign whose series have unequal lengths."""

import numpy as np
import pytest
from helpers_rebuilds import Project

from burstcast.base.files.netcdf import read_netcdf
from burstcast.base.files.tables import read_table
from burstcast.forecasters.nvar import NVAR
from burstcast.forecasts.points import observed_points
from burstcast.forecasts.windows import window_boundaries, window_forecasts
from burstcast.systems.integration import integrate
from burstcast.systems.lorenz63 import Lorenz63
from burstcast_workflow import open_campaign
from burstcast_workflow.harness.storage import read_json

LENGTHS = (700, 801, 350, 801, 120, 801, 640, 60, 801, 500)
TRAINING = 6
STEPS = 55
"""Samples in a Lyapunov time."""
CONFIG = {
    "results": "results/lab",
    "campaign": [
        {
            "cases": ["lab"],
            "forecasters": {
                "esn": {"neurons": [30], "validation": ["SSV", "RV"], "seeds": 1},
                **{"nvar": {}, "precursor": {}},
            },
        },
    ],
    "cases": {
        "lab": {
            "data": {"files": ["lab_*.csv"], "observable": "z", "time_step": 0.02},
            **{"event_threshold": {"quantile": 0.9}, "training": {"series": TRAINING}},
            "lyapunov": {"given_exponent": 0.9},
        }
    },
    "washout_lt": 0.5,
    "search": {"grid": 2, "bayesian_points": 1, "interval_lt": 2},
    "classification": {"longest_prediction_time_lt": 3, "prediction_times_lt": [1, 2]},
    "horizon": {"longest_lead_time_lt": 2},
    "probability": {"start_spacing_lt": 0.25},
    "statistics": {"starting_points": 6, "fixed_point_interval_lt": 1, "lyapunov_exponents": 0},
    "forecasters": {
        "esn": {"backend": "scipy"},
        "precursor": {"classifier": "logistic", "lags_lt": [0.2]},
    },
}


@pytest.fixture(scope="module")
def series():
    start = np.array([[1.0], [1.0], [20.0]]) + np.random.default_rng(0).normal(size=(3, 10))
    states = integrate(Lorenz63(), start, 0.01, 2 * 1300, stride=2)[500:]
    return [run[:length] for run, length in zip(states.transpose(2, 0, 1), LENGTHS, strict=True)]


@pytest.fixture(scope="module")
def lab(tmp_path_factory, job_server, series):
    """The campaign, all of it for the case of tables."""
    place = tmp_path_factory.mktemp("lab") / "lab"
    project = Project.create(place, job_server, "lab.yaml", CONFIG)
    for number, states in enumerate(series):
        project.write_series(f"lab_{number}.csv", "x,y,z", 0.02, states)
    names = ("classification", "horizon", "statistics", "probability_scores", "warnings")
    tables = [f"results/lab/lab/tables/{name}.csv" for name in (*names, "lead_times", "survival")]
    outcome = project.made(*tables, "results/lab/lab/lengths.json")
    return project, outcome.text


def test_series_are_those_of_the_files(lab, series):
    project, text = lab
    assert "10 series have 60 to 801 samples" in text
    place = project.directory / "results/lab"
    ensemble = read_netcdf(place / "lab/ensemble.nc")
    assert ensemble["length"].tolist() == list(LENGTHS)
    for stored, states in zip(ensemble["state"], series, strict=True):
        np.testing.assert_array_equal(stored[: len(states)], states)
        assert np.isnan(stored[len(states) :]).all()
    opened = open_campaign(place).series("lab", 0, 3)
    assert [len(states) for states in opened] == list(LENGTHS[:3])


def test_results_are_those_of_the_library(lab):
    """A forecaster learns from all series; points and forecasts are those of each series alone."""
    project, text = lab
    assert "1 of 4 series have no starting point" in text
    place = project.directory / "results/lab/lab"
    ensemble = read_netcdf(place / "ensemble.nc")
    model = NVAR().fit(ensemble["state"][:TRAINING], None)
    record, stored = model.record(), read_netcdf(place / "models/nvar/forecaster.nc")
    for name, value in record.arrays.items():
        np.testing.assert_array_equal(stored[name], value)
    points, forecast = (
        read_netcdf(place / name) for name in ("evaluation_set.nc", "models/nvar/forecast.nc")
    )
    assert set(points["series"]) == {0, 2, 3}  # the second test series has 60 samples
    calibrated = read_netcdf(place / "calibration_set.nc")
    assert set(calibrated["series"]) == {0, 1, 2, 3, 5}
    boundaries = window_boundaries(0.5, forecast["first"].shape[1], STEPS)
    for row in (0, 2, 3):
        here = points["series"] == row
        length = LENGTHS[TRAINING + row]
        whole = ensemble["state"][[TRAINING + row], :length]
        alone = observed_points(
            *(whole, whole[..., 2], lambda states: states[2]),
            **{"spacing": int(np.diff(points["step"][here])[0]), "washout": STEPS // 2},
            boundaries=boundaries,
        )
        np.testing.assert_array_equal(points["step"][here], alone.points.step)
        np.testing.assert_array_equal(points["washout"][here], alone.washouts)
        np.testing.assert_array_equal(points["largest"][here], alone.truth.largest)
        expected = window_forecasts(model, lambda states: states[2], alone.washouts, boundaries)
        np.testing.assert_allclose(forecast["largest"][here], expected.largest, rtol=1e-9)


def test_every_sample_counts_once(lab, series):
    place = lab[0].directory / "results/lab/lab"
    statistics = read_netcdf(place / "statistics_data.nc")
    assert statistics["states"] == sum(LENGTHS)
    np.testing.assert_allclose(statistics["mean"], np.concatenate(series).mean(axis=0), rtol=1e-12)
    tables = {path.stem: read_table(path) for path in (place / "tables").glob("*.csv")}
    assert tables["classification"]["f_score"].notna().any()
    assert (tables["horizon"]["mean_horizon_lt"] > 0).any()
    assert set(tables["statistics"]["forecaster"]) >= {"esn", "training"}
    lengths = read_json(place / "lengths.json")
    assert lengths["samples"] == max(LENGTHS[TRAINING:])
