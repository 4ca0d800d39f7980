"""A system of one's own, and the workflow from elsewhere: as a module, in another directory."""

import json
import os
import subprocess
import sys

import numpy as np
import pytest
import yaml
from helpers_rebuilds import ROOT, Project

from burstcast.base.files.netcdf import read_netcdf
from burstcast.base.files.tables import read_table
from burstcast_workflow.harness.storage import read_json
from burstcast_workflow.tracking.code import search_directories
from burstcast_workflow.tracking.run import VARIABLE

PRESET = ROOT / "workflow" / "presets" / "tiny.yaml"

# No Jacobian, initial states from a sampler, a threshold as a quantile; what the class says of its
# cases is in its own units, and its parameters come from a module beside it.
MODULE = """
from dataclasses import dataclass

import numpy as np

from my_flows.classical import A, B, C, D
from burstcast.systems.base import DynamicalSystem


@dataclass(frozen=True)
class Roessler(DynamicalSystem):
    a: float = A
    b: float = B
    c: float = C

    dimension = 3
    observable_name, observable_symbol = "x component", "x"
    case_defaults = {
        "event_threshold": {"quantile": 0.9},
        "ensemble": {
            "time_step": 0.05, "sampling_stride": 4, "transient": 50.0, "duration": 300.0,
        },
        "density": {"range": [-15.0, 15.0]},
    }

    def right_hand_side(self, state):
        x, y, z = state
        return np.stack([-y - D * z, x + self.a * y, self.b + z * (x - self.c)])

    def observable(self, state):
        return np.array(state[0])

    def sample_initial_states(self, series, generator):
        return generator.uniform(-5.0, 5.0, (3, series)) + [[0.0], [0.0], [5.0]]
"""

CONSTANTS = """
from pathlib import Path

A, B, C = 0.2, 0.2, 5.7
D = float((Path(__file__).parent / "constants/d.txt").read_text())
"""

OVERLAY = yaml.safe_load("""
    results: results/mine
    campaign:
      - cases: [roessler]
        forecasters:
          esn: {neurons: [30], validation: [RV], seeds: 1}
          equations: {}
    cases:
      roessler:
        system: "my_flows.roessler:Roessler"
        files: ["constants/d.txt"]
        lyapunov: {given_exponent: 0.0714}    # Sprott, Chaos and Time-Series Analysis (2003)
        test_series: 10
        recycle_validation: {series: 2, intervals_per_series: 5}
    search: {interval_lt: 1}
    statistics: {duration: null}
    control: {forecasters: {esn: null, equations: null}, strategies: []}
    figures: {example_case: roessler, example_forecaster: esn-N30-RV-seed0, fixed_neurons: 30}
""")
RESULTS = "results/mine"
TABLES = [f"{RESULTS}/tables/{name}.csv" for name in ("dataset", "classification", "horizon")]


@pytest.fixture(scope="module")
def mine(tmp_path_factory, job_server):
    directory = tmp_path_factory.mktemp("user") / "campaign"
    (directory / "my_flows" / "constants").mkdir(parents=True)
    files = {"__init__.py": "", "classical.py": CONSTANTS, "roessler.py": MODULE}
    for name, text in {**files, "constants/d.txt": "1\n", "unused.py": "D = 1\n"}.items():
        (directory / "my_flows" / name).write_text(text)
    user = Project(directory, job_server, str(PRESET), ("-s", str(ROOT / "Snakefile")))
    user.made(*TABLES, overlay=OVERLAY)
    return user


def test_results_of_a_system_of_ones_own(mine):
    results = mine.directory / RESULTS
    scores = read_table(results / "tables" / "classification.csv")
    perfect = scores[scores["forecaster"] == "equations"]
    assert (perfect["f_score"] == 1).all()
    (dataset,) = read_table(results / "tables" / "dataset.csv").to_dict("records")
    assert dataset["lyapunov_exponent"] == pytest.approx(0.0714, rel=0.35)  # of short series
    assert dataset["series_kept"] == 40
    # initial states are drawn by the system
    states = read_netcdf(results / "roessler" / "ensemble.nc", "state")["state"]
    assert len(np.unique(states[:, 0, 0])) == 40


def test_thresholds_as_quantiles_are_of_the_training_series(mine):
    case = mine.directory / RESULTS / "roessler"
    observable = read_netcdf(case / "ensemble.nc", "observable")["observable"]
    threshold = read_json(case / "event_threshold.json")["event_threshold"]
    assert threshold == np.quantile(observable[:3], 0.9)
    assert threshold != np.quantile(observable, 0.9)


def test_edits_run_what_depends_on_them(mine):
    with (
        mine.edited("my_flows/unused.py", "D = 1", "D = 2"),
        mine.edited("my_flows/classical.py", "A, B", "# the classical values\nA, B"),
    ):
        assert mine.dry_run(*TABLES, overlay=OVERLAY) == {}
    threshold = f"{RESULTS}/roessler/event_threshold.json"
    for name, old, new in (
        ("classical.py", "5.7", "5.8"),
        ("roessler.py", "self.b + z", "1.0 * self.b + z"),
        ("constants/d.txt", "1", "1.01"),
    ):
        with mine.edited(f"my_flows/{name}", old, new):
            planned = mine.dry_run(*TABLES, overlay=OVERLAY)
            assert {"simulate", "scan", "train", "forecast"} <= {*planned}
            # what does not integrate the equations does not depend on them
            planned = mine.dry_run(threshold, overlay=OVERLAY)
            assert {*planned} == {"simulate", "event_threshold"}
    case = {**OVERLAY["cases"]["roessler"], "event_threshold": {"quantile": 0.8}}
    planned = {*mine.dry_run(*TABLES, overlay={**OVERLAY, "cases": {"roessler": case}})}
    assert {"event_threshold", "events", "horizon", "classification_table"} <= planned
    assert not {"simulate", "scan", "train", "forecast", "evaluation_set"} & planned


def test_own_modules_are_looked_for_here_and_beside_configs(tmp_path, monkeypatch):
    project, here, configs = (tmp_path / name for name in ("project", "here", "configs"))
    here.mkdir()
    monkeypatch.chdir(here)
    files = [project / "config.yaml", configs / "a.yaml", configs / "b.yaml"]
    assert search_directories(files, project) == [str(here), str(configs)]


def test_a_mistake_in_ones_own_module_is_told_before_any_job(mine):
    with mine.edited("my_flows/roessler.py", "np.stack([", "np.stack[("):
        outcome = mine.snakemake("-n", overlay=OVERLAY)
    assert outcome.status == 1
    message = "case roessler: system: the module my_flows.roessler cannot be imported"
    assert message in outcome.text
    assert "roessler.py, line" in outcome.text
    assert "Traceback" not in outcome.text


def test_jobs_of_a_cluster_find_ones_own_modules(mine):
    """As Snakemake's executors call it on a node: the config and the directories of the claim."""
    claim = json.loads((mine.directory / RESULTS / ".run.json").read_text())
    assert str(mine.directory) in claim["directories"]
    outcome = mine.snakemake(
        *("--mode", "remote", "--nolock", "--ignore-incomplete", "--force", "--no-hooks"),
        *("--target-jobs", "simulate:case=roessler", "--allowed-rules", "simulate"),
        overlay=OVERLAY,
        **{VARIABLE: f"{claim['token']} {RESULTS}"},
    )
    assert outcome.status == 0, outcome.text[-3000:]
    assert "1 of 1 steps (100%) done" in outcome.text


def test_modules_beside_the_config_are_found_from_elsewhere(mine, tmp_path, job_server):
    config = mine.directory / "overlay.yaml"
    arguments = ["-s", ROOT / "Snakefile", "--configfile", PRESET, config]
    assert planned_jobs(job_server, tmp_path, *arguments)["simulate"] == 1


# -- as a module of another workflow ---------------------------------------------------------------

AS_MODULE = f"""
configfile: {str(PRESET)!r}

module burstcast:
    snakefile: {str(ROOT / "Snakefile")!r}
    config: config

use rule * from burstcast"""


def planned_jobs(job_server, directory, *arguments):
    """How many jobs of each rule Snakemake plans in a directory."""
    outcome = job_server.snakemake(directory, "-n", "--verbose", "--cores", "1", *arguments)
    assert outcome.status == 0, outcome.text
    return outcome.jobs


def test_another_workflow_takes_it_as_a_module(tmp_path, job_server):
    """With the project's own Snakefile, with that below workflow, and as a module."""
    config = ["--configfile", PRESET]
    expected = planned_jobs(job_server, tmp_path, "-s", ROOT / "Snakefile", *config)
    assert sum(expected.values()) > 50
    below = planned_jobs(job_server, tmp_path, "-s", ROOT / "workflow" / "Snakefile", *config)
    assert below == expected
    for prefix, naming in (("", ""), ("flow_", " as flow_*")):
        (tmp_path / "Snakefile").write_text(f"{AS_MODULE}{naming}\n", encoding="utf-8")
        jobs = planned_jobs(job_server, tmp_path)
        jobs.pop("flow_all", None)  # without the project's profile, Snakemake counts the target
        assert jobs == {prefix + rule: count for rule, count in expected.items()}


@pytest.mark.long
@pytest.mark.parametrize("prefix", ["", "below"])
def test_a_module_runs_and_its_results_are_known(tmp_path, job_server, finished, prefix):
    """Files say the stages that made them, whatever the rules are called; where they are, too."""
    where = f"\n    prefix: {prefix!r}" if prefix else ""
    module = AS_MODULE.replace("    config: config", f"    config: config{where}")
    (tmp_path / "Snakefile").write_text(f"{module} as flow_*\n", encoding="utf-8")
    results = tmp_path / prefix / "results" / "tiny"
    table = results / "tables" / "control.csv"
    # what another rule has made, under its own name, comes from the cache
    cache = finished.directory / ".burstcast_cache"
    command = [sys.executable, "-m", "snakemake", "--cores", "1", table.relative_to(tmp_path)]
    environment = {**os.environ, "BURSTCAST_CACHE": str(cache)}
    options = {"cwd": tmp_path, "capture_output": True, "text": True, "env": environment}
    result = subprocess.run(command, check=False, **options)
    assert result.returncode == 0, result.stdout + result.stderr
    assert table.read_bytes() == (finished.results / "tables/control.csv").read_bytes()
    logs = [path.read_text() for path in (results / "logs").rglob("*.log")]
    assert len(logs) > 10
    assert all("the outputs are those of this job" in log for log in logs)
    assert planned_jobs(job_server, tmp_path, table.relative_to(tmp_path)) == {}
