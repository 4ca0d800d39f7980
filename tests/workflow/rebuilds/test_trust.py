"""Records and results belong together: whatever happens, nothing wrong is used."""

import json
import os
import shutil
import subprocess
import sys

import pytest
from helpers_rebuilds import HERE, RESULTS, Project

from burstcast_workflow.figures.registry import FIGURES
from snaketrust.run import VARIABLE

NETWORKS = [f"Re400/esn-N{neurons}-RV-seed0/forecaster.nc" for neurons in (30, 40)]
NOTHING = "Nothing would run: all results are up to date.\n"


@pytest.fixture
def project(finished, tmp_path) -> Project:
    return finished.project.copy(tmp_path / "project")


def record_of(project: Project, name: str):
    return project.results / ".records" / f"{name}.json"


def repaired(project: Project, finished) -> None:
    outcome = project.snakemake("tables")
    assert outcome.status == 0, outcome.text[-3000:]
    assert project.tables() == finished.project.tables()


def test_edits_are_seen_without_the_records_of_snakemake(project):
    """As after make clean, or with another backend of Snakemake's records."""
    overlay = {"case_defaults": {"event_threshold": 0.08}}
    before = project.dry_run("tables", overlay=overlay)
    assert "events" in before
    shutil.rmtree(project.directory / ".snakemake")
    assert project.dry_run("tables") == {}
    assert project.dry_run("tables", overlay=overlay) == before
    assert project.why("tables") == NOTHING
    assert "event_threshold 0.07 -> 0.08 (Re400)" in project.why("tables", overlay=overlay)


@pytest.mark.long
def test_results_may_be_spelt_otherwise_and_shared_by_two_copies(project, tmp_path):
    other = project.without_results(tmp_path / "other")
    shared = {"results": str(project.results)}
    for copy in (project, other):
        assert copy.dry_run("tables", overlay=shared) == {}
    # what one of them makes with other settings is no result of the other
    target = f"{project.results}/Re400/events.json"
    seed = {"random_seed": 7}
    assert other.snakemake(target, overlay={**shared, **seed}).status == 0
    assert other.dry_run(target, overlay={**shared, **seed}) == {}
    assert project.dry_run(f"{RESULTS}/Re400/events.json") == {"simulate": 1, "events": 1}


def test_results_without_a_record_are_made_again(project, finished):
    record_of(project, "Re400/events.nc").unlink()
    assert "events" in project.dry_run("tables")
    said = project.why("tables")
    assert said.startswith("results without a record of what made them (Re400): events (1), ")
    repaired(project, finished)


def test_damaged_and_exchanged_files_are_made_again(project, finished):
    table = project.results / "Re400" / "tables" / "horizon.csv"
    state = table.stat()
    table.write_text(table.read_text().replace("0", "1", 1))
    os.utime(table, ns=(state.st_atime_ns, state.st_mtime_ns))
    first, second = (project.results / name for name in NETWORKS)
    first.rename(project.results / "temporary")
    second.rename(first)
    (project.results / "temporary").rename(second)
    jobs = project.dry_run("tables")
    assert (jobs["horizon_table"], jobs["train"]) == (1, 2)
    said = project.why("tables")
    for name in ("Re400/tables/horizon.csv", *NETWORKS):
        assert f"{RESULTS}/{name} is not what its job wrote" in said
    repaired(project, finished)


@pytest.mark.long
def test_what_was_made_from_another_version_of_a_file_is_made_again(project, finished, tmp_path):
    """A file that is restored from a backup, with its times and its record."""
    name = "Re400/events.nc"
    backup = tmp_path / "backup"
    for path in (project.results / name, record_of(project, name)):
        backup.mkdir(exist_ok=True)
        shutil.copy2(path, backup / path.name)
    target = f"{RESULTS}/tables/horizon.csv"
    assert project.snakemake(target, overlay={"horizon": {"events": 7}}).status == 0
    shutil.copy2(backup / "events.nc", project.results / name)
    shutil.copy2(backup / "events.nc.json", record_of(project, name))
    shutil.copy2(
        finished.project.results / "Re400/events.json", project.results / "Re400/events.json"
    )
    shutil.copy2(
        record_of(finished.project, "Re400/events.json"), record_of(project, "Re400/events.json")
    )
    jobs = project.dry_run(target)
    assert "events" not in jobs
    assert jobs["horizon"] == len(list(project.results.glob("*/*/horizon.nc")))
    assert f"made from another {RESULTS}/{name} (Re400): horizon" in project.why(target)
    repaired(project, finished)


OF_A_NETWORK = ["Re400/esn-N40-RV-seed0/hyperparameters.json", "Re400/scan/*"]
DELETED = {
    "ensemble.duration 400 -> 420": (
        ["Re400/ensemble.nc"],
        {"case_defaults": {"ensemble": {"duration": 420}}},
    ),
    "search.bayesian_points 1 -> 2": (OF_A_NETWORK[:1], {"search": {"bayesian_points": 2}}),
    "search.grid 2 -> 3": (OF_A_NETWORK[1:], {"search": {"grid": 3}}),
    "random_seed 2022 -> 7": (["Re400/*.nc", *OF_A_NETWORK], {"random_seed": 7}),
}


def delete(project: Project, names: list[str]) -> None:
    for path in [path for name in names for path in project.results.glob(name)]:
        path.unlink()


@pytest.mark.parametrize("change", DELETED)
def test_an_edit_counts_for_deleted_files_too(project, change):
    names, overlay = DELETED[change]
    jobs = project.dry_run("tables", overlay=overlay)
    delete(project, names)
    assert project.dry_run("tables") == {}  # they are not needed
    assert project.dry_run("tables", overlay=overlay) == jobs
    assert change in project.why("tables", overlay=overlay)


def test_edited_code_counts_for_deleted_files_too(project):
    delete(project, OF_A_NETWORK)
    project.edit("src/burstcast/tuning/search.py", "nu=2.5", "nu=1.5")
    assert project.dry_run("tables")["search"] == 4
    assert "code of burstcast.tuning.search changed" in project.why("tables")


def test_a_deleted_file_without_its_record_is_made_again(project, finished):
    """The same files with the record of another version: what was made from them does not fit."""
    (project.results / NETWORKS[0]).unlink()
    record_of(project, NETWORKS[0]).unlink()
    assert project.dry_run("tables")["train"] == 1
    (project.results / NETWORKS[1]).unlink()
    record = json.loads(record_of(project, NETWORKS[1]).read_text())
    record_of(project, NETWORKS[1]).write_text(json.dumps(record | {"digest": "0" * 64}))
    assert project.dry_run("tables")["train"] == 2
    repaired(project, finished)


def test_an_input_that_is_damaged_when_a_job_reads_it_fails_the_job(project):
    """A disk that has lost a bit: the stamp says nothing."""
    name = "Re400/events.nc"
    path = project.results / name
    content = bytearray(path.read_bytes())
    content[-1] ^= 1
    path.write_bytes(content)
    record = json.loads(record_of(project, name).read_text())
    state = path.stat()
    record["stamp"] = [state.st_size, state.st_mtime_ns, state.st_ctime_ns, state.st_ino]
    record_of(project, name).write_text(json.dumps(record))
    overlay = {"horizon": {"tolerance": 0.3}}
    outcome = project.snakemake(f"{RESULTS}/tables/horizon.csv", overlay=overlay)
    assert outcome.status == 1
    damaged = f"{RESULTS}/{name}"
    assert f"{damaged} is not what its job wrote: remove it (rm {damaged})" in outcome.text


# -- nothing stale is shown ------------------------------------------------------------------------

SMALLER = {
    "campaign": [
        {
            "reynolds": [400],
            "forecasters": {
                "esn": {"neurons": [40], "validation": ["SSV", "RV"], "seeds": 1},
                "equations": {},
            },
        }
    ],
    "statistics": {"forecasters": {"esn": None}},
}


def prune(project: Project, *arguments: str, overlay: dict | None = None) -> tuple[int, list[str]]:
    """What ``burstcast prune`` says, by lines, and its status."""
    result = subprocess.run(
        [
            *(sys.executable, "-m", "burstcast_workflow", "prune"),
            *arguments,
            *project.options("-n", overlay=overlay)[1:],
        ],
        cwd=project.directory,
        env=project.environment(),
        capture_output=True,
        text=True,
        check=False,
    )
    return result.returncode, (result.stdout + result.stderr).splitlines()


@pytest.mark.long
def test_results_of_a_former_campaign_are_listed(project):
    assert prune(project) == (0, [])
    (project.results / "notes.txt").write_text("a user's own, which is no result")
    status, stale = prune(project, overlay=SMALLER)
    assert status == 0
    files = {name.removeprefix(f"{RESULTS}/") for name in stale}
    gone = (
        *("esn-N30-", "equations_noisy/", "long_term.nc", "tables/statistics", "statistics_"),
        *("survival", "lyapunov_spectrum", "kaplan_yorke", "quadratic_filtered/"),
    )
    assert {"tables/statistics.csv", "Re400/esn-N40-RV-seed0/long_term.nc"} < files
    assert "Re400/scan/esn-N30-seed0-RV+SSV.csv" in files
    assert not {name for name in files if not any(part in name for part in gone)}
    # a part of the campaign says nothing of the rest
    assert prune(project, "tables", overlay=SMALLER)[0] == 2
    for name in files:
        (project.results / name).unlink()
    assert prune(project, overlay=SMALLER) == (0, [])


def test_a_source_that_is_missing_is_an_error(project):
    """Snakemake takes figures that are there for sources, and has nothing to do."""
    figures = project.results / "figures"
    figures.mkdir(exist_ok=True)
    overlay = {"figures": {"published_overlay": True}}
    for name in [name for name, figure in FIGURES.items() if figure.published]:
        for suffix in ("pdf", "png"):
            (figures / f"{name}.{suffix}").write_text("")
    (project.directory / "resources" / "published_percentiles.csv").unlink()
    outcome = project.snakemake("-n", "figures", overlay=overlay)
    assert outcome.status == 1
    assert "nothing makes it" in outcome.text
    assert "source file is missing" in outcome.text


def test_a_clock_that_is_wrong_does_no_harm(project):
    """An input that another machine has written an hour from now."""
    path = project.results / "Re400" / "events.nc"
    later = path.stat().st_mtime + 3600
    os.utime(path, (later, later))
    target, overlay = f"{RESULTS}/Re400/equations/horizon.nc", {"horizon": {"tolerance": 0.3}}
    assert project.snakemake(target, overlay=overlay).status == 0
    assert project.dry_run(target, overlay=overlay) == {}


# -- jobs of a cluster, for which Snakemake reads the workflow anew --------------------------------

EVENTS = f"{RESULTS}/Re400/events.json"
# as Snakemake's executors call it on a node
ON_A_NODE = (
    *("--mode", "remote", "--nolock", "--ignore-incomplete", "--force", "--no-hooks"),
    *("--target-jobs", "events:case=Re400", "--allowed-rules", "events"),
)


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


# -- a copy of the project runs its own code, or none ----------------------------------------------


def test_the_environment_of_another_copy_is_refused(finished, tmp_path):
    one, other = (finished.project.without_results(tmp_path / name) for name in ("one", "other"))
    path = f"{one.directory / 'src'}:{HERE / 'server'}"
    outcome = other.snakemake("-n", PYTHONPATH=path)
    assert outcome.status == 1
    assert f"Python imports burstcast from {one.directory / 'src'}, another copy" in outcome.text
    assert "Traceback" not in outcome.text
    assert one.snakemake("-n").status == 0


def test_an_edit_during_a_run_that_is_undone_before_the_next_leaves_nothing(finished, tmp_path):
    project = finished.project.copy(tmp_path / "project")
    tables = project.tables()
    module = project.directory / "src/burstcast/forecast/horizon.py"
    script = project.directory / "workflow/scripts/data/events.py"
    texts = {path: path.read_text() for path in (module, script)}
    # the job of the events edits what the jobs of the horizons import
    edit = f"open({str(module)!r}, 'a').write('EDITED = 1')"
    function = '    """Write the events'
    assert texts[script].count(function) == 1
    script.write_text(texts[script].replace(function, f"    {edit}\n{function}"))
    target = "results/tiny/tables/horizon.csv"
    outcome = project.snakemake(target)
    assert outcome.status == 1
    assert "burstcast.forecast.horizon changed after the workflow was planned" in outcome.text
    for path, text in texts.items():
        path.write_text(text)
    assert project.snakemake("tables").status == 0
    assert project.tables() == tables
