"""Records and results of a campaign belong together, and what was damaged is told and made again.

What is done about it is tested in tests/snaketrust, with a workflow of a few small jobs.
"""

import json
import os

import pytest
from helpers_rebuilds import RESULTS, Project
from snaketrust.run import VARIABLE


@pytest.fixture
def project(finished, tmp_path) -> Project:
    return finished.project.copy(tmp_path / "project")


def test_what_is_damaged_exchanged_or_has_no_record_is_told_and_made_again(project, finished):
    table = project.results / "Re400" / "tables" / "horizon.csv"
    state = table.stat()
    table.write_text(table.read_text().replace("0", "1", 1))
    os.utime(table, ns=(state.st_atime_ns, state.st_mtime_ns))
    names = [f"Re400/esn-N{neurons}-RV-seed0/forecaster.nc" for neurons in (30, 40)]
    first, second = (project.results / name for name in names)
    first.rename(project.results / "temporary")
    second.rename(first)
    (project.results / "temporary").rename(second)
    (project.results / ".records" / "Re400" / "events.nc.json").unlink()
    jobs = project.dry_run("tables")
    assert (jobs["horizon_table"], jobs["train"], jobs["events"]) == (1, 2, 1)
    said = project.why("tables")
    assert "results without a record of what made them (Re400): events (1), " in said
    for name in ("Re400/tables/horizon.csv", *names):
        assert f"{RESULTS}/{name} is not what its job wrote" in said
    outcome = project.snakemake("tables")
    assert outcome.status == 0, outcome.text[-3000:]
    assert project.tables() == finished.project.tables()


# as Snakemake's executors call it on a node
ON_A_NODE = (
    *("--mode", "remote", "--nolock", "--ignore-incomplete", "--force", "--no-hooks"),
    *("--target-jobs", "events:case=Re400", "--allowed-rules", "events"),
)


def test_an_edit_of_the_config_while_jobs_are_queued_counts_at_the_next_run(project):
    edited = {"case_defaults": {"event_threshold": 0.08}}
    claim = json.loads((project.results / ".run.json").read_text())
    run = {VARIABLE: f"{claim['token']} {RESULTS}"}
    outcome = project.snakemake(*ON_A_NODE, overlay=edited, **run)
    assert outcome.status == 0, outcome.text[-3000:]
    assert "1 of 1 steps (100%) done" in outcome.text
    record = json.loads((project.results / ".records/Re400/events.json.json").read_text())
    assert record["parameters"]["settings"]["case.event_threshold"] == 0.07
    events = f"{RESULTS}/Re400/events.json"
    assert project.dry_run(events) == {}
    assert project.dry_run(events, overlay=edited) == {"events": 1}


# -- results that nothing asks for any more --------------------------------------------------------

NETWORKS = {"neurons": [40], "validation": ["SSV", "RV"], "seeds": 1}
SMALLER = {
    "campaign": [{"reynolds": [400], "forecasters": {"esn": NETWORKS, "equations": {}}}],
    "statistics": {"forecasters": {"esn": None}},
}


def prune(project: Project, *targets: str, overlay: dict | None = None) -> tuple[int, list[str]]:
    """What ``burstcast prune`` says, by lines, and its status."""
    outcome = project.command("prune", *targets, overlay=overlay)
    return outcome.status, outcome.text.splitlines()


@pytest.mark.long
def test_results_of_a_former_campaign_are_listed(project):
    assert prune(project) == (0, [])
    (project.results / "notes.txt").write_text("a user's own, which is no result")
    status, stale = prune(project, overlay=SMALLER)
    assert status == 0
    files = {name.removeprefix(f"{RESULTS}/") for name in stale}
    gone = (
        *("esn-N30-", "equations_noisy/", "long_term.nc", "tables/statistics", "statistics_"),
        *("survival", "lyapunov_spectrum", "kaplan_yorke", "quadratic_filtered"),
    )
    assert {"tables/statistics.csv", "Re400/esn-N40-RV-seed0/long_term.nc"} < files
    assert "Re400/scan/esn-N30-seed0-RV+SSV.csv" in files
    assert not {name for name in files if not any(part in name for part in gone)}
    # a part of the campaign says nothing of the rest
    assert prune(project, "tables", overlay=SMALLER)[0] == 2
    for name in files:
        (project.results / name).unlink()
    assert prune(project, overlay=SMALLER) == (0, [])
