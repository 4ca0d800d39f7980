"""Campaigns of a flow that sensors see and encoders encode: from the config to the ranking."""

import json
import shutil

import numpy as np
import pandas as pd
import pytest
import yaml
from helpers_configs import ROOT
from helpers_rebuilds import Project
from sklearn.metrics import average_precision_score

from burstcast.base import random_streams
from burstcast.base.files.netcdf import read_attributes, read_netcdf
from burstcast.base.files.tables import read_table
from kolmogorov_flow import KolmogorovFlow

# half a minute of a flow in a plane; sensors and encoders have tests in their rooms
pytestmark = pytest.mark.long
EXAMPLE = ROOT / "examples" / "kolmogorov"
OVERLAY = yaml.safe_load((EXAMPLE / "tiny.yaml").read_text())
FLOW = KolmogorovFlow(40.0, 4, 4)
TARGETS = [
    f"{OVERLAY['results']}/{target}"
    for target in (
        "tables/ranking.csv",
        "tables/control_strategies.csv",
        "figures/forecast_skill_sensors.png",
    )
]


@pytest.fixture(scope="module")
def project(tmp_path_factory, job_server):
    project = Project.create(tmp_path_factory.mktemp("encoded") / "project", job_server)
    for module in EXAMPLE.glob("*.py"):
        shutil.copy(module, project.directory)
    project.made(*TARGETS, overlay=OVERLAY)
    return project


@pytest.fixture(scope="module")
def results(project):
    return project.directory / OVERLAY["results"]


def test_noise_comes_before_the_encoder(results):
    """Channels of the noisy state, noise and all made again from the name of its stream."""
    whole, encoded = (
        read_netcdf(results / case / "ensemble.nc") for case in ("turbulence", "invariants")
    )
    scales = whole["state"][:3].reshape(-1, 80).std(axis=0)
    for row in (0, 4):
        generator = random_streams.stream(2022, "noise", "turbulence", row)
        states = whole["state"][row]
        seen = states + 0.01 * scales * generator.standard_normal(states.shape)
        np.testing.assert_allclose(
            encoded["observed"][row, :, :-1].T, FLOW.invariants(seen.T), atol=1e-12
        )
        np.testing.assert_allclose(
            encoded["state"][row, :, :-1].T, FLOW.invariants(states.T), atol=1e-12
        )
    np.testing.assert_array_equal(encoded["state"][..., -1], whole["observable"])
    error = (encoded["observed"] - encoded["state"])[..., -1]
    assert error.std() == pytest.approx(0.01 * whole["observable"][:3].std(), rel=0.1)


def errors(results, case, forecaster):
    """Errors of the largest dissipation in the first window."""
    truth = read_netcdf(results / case / "evaluation_set.nc", "largest")["largest"]
    largest = read_netcdf(results / case / f"models/{forecaster}/forecast.nc", "largest")["largest"]
    return np.abs(largest - truth)[:, 0].mean()


def test_the_filter_sees_more_than_the_linear_estimate_and_modes_less(results):
    assert errors(results, "turbulence", "equations") == 0
    filtered = errors(results, "sensors", "equations_filtered")
    assert filtered < errors(results, "sensors", "equations_noisy")
    assert errors(results, "turbulence", "equations_noisy") < errors(
        results, "sensors_pod", "equations_noisy"
    )


def test_ranking_by_other_means(results):
    """Average precision of onsets and of any time above the threshold, by scikit-learn."""
    table = read_table(results / "tables" / "ranking.csv")
    assert set(table["case"]) == {"turbulence", "sensors", "invariants", "sensors_pod"}
    points = read_netcdf(results / "turbulence" / "evaluation_set.nc")
    forecast = read_netcdf(results / "turbulence" / "models" / "equations_noisy" / "forecast.nc")
    level = json.loads((results / "turbulence/event_threshold.json").read_text())["event_threshold"]
    here = points["washout_maximum"] < level
    for time, first in ((1, 1), (2, 3)):
        window = slice(first, first + 2)
        true, peaks = (data["largest"][here][:, window].max(axis=1) for data in (points, forecast))
        begins, foreseen = (data["first"][here][:, first] < level for data in (points, forecast))
        ranked = np.where(foreseen, peaks, peaks[foreseen].mean())
        expected = {
            "onset": average_precision_score(begins & (true >= level), ranked),
            "any": average_precision_score(true >= level, peaks),
        }
        for event, value in expected.items():
            keys = {"case": "turbulence", "alarm": "equations_noisy", "event": event}
            keys |= {"prediction_time_lt": time, "metric": "average_precision"}
            row = table[(table[list(keys)] == pd.Series(keys)).all(axis=1)]
            assert row["value"].item() == pytest.approx(value)
            assert row["low"].item() <= value <= row["high"].item()
    alarms = set(table[table["case"] == "turbulence"]["alarm"])
    assert {"published_precursor", "observable_now", "equations"} <= alarms
    assert "published_precursor" not in set(table[table["case"] == "invariants"]["alarm"])


def test_control_through_sensors_and_encoders(results):
    """Exceedance of each run, from the observables of its flows."""
    table = read_table(results / "tables" / "control_strategies.csv")
    table = table[table["metric"] == "exceedance_controlled"]
    observed = dict(zip(table["forecaster"], table["observed"].fillna(""), strict=True))
    assert observed == {"equations": "", "equations_filtered": "sensors", "precursor": "invariants"}
    uncontrolled = []
    for forecaster in observed:
        (path,) = (results / "turbulence" / "control" / forecaster).iterdir()
        flows, span = read_netcdf(path / "flows.nc"), read_attributes(path / "flows.nc")
        row, steps = table[table["forecaster"] == forecaster], span["steps"]
        assert row["value"].item() == pytest.approx(flows["exceeding_controlled"].mean() / steps)
        uncontrolled.append(flows["exceeding_uncontrolled"].tolist())
        acting = flows["actuated_integration_steps"].mean() / span["integration_steps"]
        assert 0 < acting < 1
    assert uncontrolled == [uncontrolled[0]] * 3


def test_edits_of_ones_own_encoder_run_what_it_encodes(project):
    def planned():
        outcome = project.snakemake("--quiet", "rules", "-n", *TARGETS, overlay=OVERLAY)
        assert outcome.status == 0, outcome.text
        return outcome.jobs

    encoded = "return self.flow.invariants(observed)"
    assert planned() == {}
    project.edit("shift_invariants.py", encoded, f"# of the flow\n        {encoded}")
    assert planned() == {}
    project.edit("shift_invariants.py", encoded, f"{encoded} * 1.0")
    jobs = planned()
    # the channels of one of three encoded cases, and what learns from them
    assert jobs["encode"] == 1
    assert {"train", "forecast", "control", "ranking_table"} <= set(jobs)
    assert "simulate" not in jobs
