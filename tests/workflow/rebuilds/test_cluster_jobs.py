"""Jobs of a cluster, for which Snakemake reads the workflow anew, do what was planned."""

import json

import pytest
from helpers_rebuilds import RESULTS, Project

from snaketrust.run import VARIABLE

EVENTS = f"{RESULTS}/Re400/events.json"
# as Snakemake's executors call it on a node
ON_A_NODE = (
    *("--mode", "remote", "--nolock", "--ignore-incomplete", "--force", "--no-hooks"),
    *("--target-jobs", "events:case=Re400", "--allowed-rules", "events"),
)


@pytest.fixture
def project(finished, tmp_path) -> Project:
    return finished.project.copy(tmp_path / "project")


def run_of(project: Project) -> dict[str, str]:
    """What its jobs find in their environment."""
    claim = json.loads((project.results / ".run.json").read_text())
    return {VARIABLE: f"{claim['token']} {RESULTS}"}


def settings_of(project: Project) -> dict:
    record = project.results / ".records" / "Re400" / "events.json.json"
    return json.loads(record.read_text())["parameters"]["settings"]


def test_an_edit_of_the_config_during_a_campaign_counts_at_its_next_run(project):
    edited = {"case_defaults": {"event_threshold": 0.08}}
    outcome = project.snakemake(*ON_A_NODE, overlay=edited, **run_of(project))
    assert outcome.status == 0, outcome.text[-3000:]
    assert "1 of 1 steps (100%) done" in outcome.text
    assert settings_of(project)["case.event_threshold"] == 0.07
    assert project.dry_run(EVENTS) == {}
    assert project.dry_run(EVENTS, overlay=edited) == {"events": 1}


def test_an_edit_of_the_code_during_a_campaign_fails_the_job(project):
    project.edit(
        "workflow/scripts/data/events.py",
        "from burstcast import durations",
        "from burstcast import durations; a=1",
    )
    outcome = project.snakemake(*ON_A_NODE, **run_of(project))
    assert outcome.status == 1
    assert "events.py changed after the workflow was planned" in outcome.text


def test_a_job_that_waited_in_the_queue_for_too_long_does_nothing(project):
    before = run_of(project)
    target = f"{RESULTS}/Re400/statistics_data.nc"
    assert project.snakemake(target, "--forcerun", "reference_statistics").status == 0
    outcome = project.snakemake(*ON_A_NODE, **before)
    assert outcome.status == 1
    assert f"{RESULTS} belongs to a newer run now" in outcome.text


def test_a_job_that_does_not_know_its_run_says_so(project):
    outcome = project.snakemake(*ON_A_NODE, **{VARIABLE: ""})
    assert outcome.status == 1
    assert f"the environment variable {VARIABLE} does not reach jobs" in outcome.text
