"""docs/tutorial_data.md as it is written: small here, whole behind the marker `long`."""

import contextlib
import io
import re
import sys

import pytest
import yaml
from helpers_rebuilds import ROOT, Project

from burstcast.files.netcdf import read_netcdf
from burstcast.files.tables import read_table
from burstcast_workflow.harness.storage import read_json

TEXT = (ROOT / "docs" / "tutorial_data.md").read_text(encoding="utf-8")
PYTHON = re.findall(r"```python\n(.*?)```", TEXT, re.DOTALL)
CONFIGS = re.findall(r"```yaml\n(.*?)```", TEXT, re.DOTALL)


def run(code, directory, monkeypatch):
    """Run a piece of the tutorial in a directory; what it prints."""
    monkeypatch.chdir(directory)
    said = io.StringIO()
    with contextlib.redirect_stdout(said):
        exec(code, {"np": sys.modules["numpy"]})
    return said.getvalue()


def probabilities(said):
    found = re.findall(r"an event between (\d) and (\d) Lyapunov times from now: ([\d.]+)", said)
    assert [(one, two) for one, two, _ in found] == [("1", "2"), ("2", "3")]
    return [float(probability) for *_, probability in found]


@pytest.fixture
def project(tmp_path, job_server, monkeypatch):
    """A working copy with the tutorial's numbers and its config."""
    project = Project.create(tmp_path / "project", job_server, "lab.yaml")
    assert len(PYTHON) == 2
    run(PYTHON[0], project.directory, monkeypatch)
    (project.directory / "lab.yaml").write_text(CONFIGS[0])
    return project


def test_from_numbers_to_a_probability(project, monkeypatch):
    assert (project.directory / "lab.csv").open().readline() == "time,x,y,z\n"
    outcome = project.snakemake("results/lab/lab/lyapunov.json", "results/lab/lab/events.json")
    assert outcome.status == 0, outcome.text[-3000:]
    lab = project.directory / "results/lab/lab"
    assert read_netcdf(lab / "ensemble.nc", "state")["state"].shape == (40, 2001, 3)
    assert read_json(lab / "lyapunov.json")["leading"]["mean"] == pytest.approx(0.906, rel=0.1)
    assert read_json(lab / "events.json")["usable_events"] > 100
    small = PYTHON[1].replace("members=6", "members=2, grid=2, bayesian_points=0")
    said = run(small.replace("neurons=100", "neurons=40"), project.directory, monkeypatch)
    assert all(0 <= probability <= 1 for probability in probabilities(said))


def test_the_parts_of_a_state_are_a_config(project):
    part = yaml.safe_load(CONFIGS[2])["cases"]
    config = yaml.safe_load(CONFIGS[0])
    forecasters = config["campaign"][0]["forecasters"]
    config["campaign"].append({"reynolds": [400], "cases": list(part), "forecasters": forecasters})
    config["cases"] |= part
    (project.directory / "lab.yaml").write_text(yaml.safe_dump(config))
    assert project.dry_run("results/lab/two_modes/evaluation_set.nc") == {
        "simulate": 1,
        "import_data": 1,
        "evaluation_set": 1,
    }
    outcome = project.snakemake("-n", "results/lab/two_modes_and_their_past/evaluation_set.nc")
    assert outcome.status == 0, outcome.text[-3000:]


def test_the_second_run_counts_in_what_it_is_told(project):
    config = yaml.safe_load(CONFIGS[0])
    config["results"] = "results/lab_again"
    config["cases"]["lab"] |= yaml.safe_load(CONFIGS[1])["cases"]["lab"]
    (project.directory / "lab.yaml").write_text(yaml.safe_dump(config))
    planned = project.dry_run("results/lab_again/lab/evaluation_set.nc")
    assert planned == {"import_data": 1, "evaluation_set": 1}  # no estimate


@pytest.mark.long
def test_the_whole_tutorial(project, monkeypatch):
    outcome = project.snakemake()
    assert outcome.status == 0, outcome.text[-3000:]
    assert "lab: measured series; off: " in outcome.text
    table = read_table(project.directory / "results/lab/tables/classification.csv")
    at_one = table[table["prediction_time_lt"] == 1].groupby("forecaster")["f_score"].median()
    assert at_one["esn"] > 0.9
    assert at_one["quadratic_filtered"] > 0.9
    assert at_one["persistence"] < 0.1
    said = run(PYTHON[1], project.directory, monkeypatch)
    assert all(0 <= probability <= 1 for probability in probabilities(said))
