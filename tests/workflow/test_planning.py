"""What Snakemake plans by, and what the workflow changes in its scheduler."""

import asyncio
from pathlib import Path
from types import SimpleNamespace

import pytest
from snakemake.cli import get_argument_parser
from snakemake.persistence import PersistenceBase
from snakemake.rules import Rule
from snakemake.scheduling.job_scheduler import JobRateLimiter, JobScheduler
from snakemake.settings.types import MaxJobsPerTimespan

from burstcast_workflow import planning, snakemake_patches
from burstcast_workflow.harness.records import Records, digest
from burstcast_workflow.harness.run import VARIABLE
from burstcast_workflow.planning import FORMER, plan_by_records
from burstcast_workflow.snakemake_patches import (
    plan_without_idle_groups,
    start_jobs_without_delay,
)


def test_snakemake_is_told_what_records_say(tmp_path, monkeypatch):
    for name in ("metadata", "incomplete"):
        monkeypatch.setattr(PersistenceBase, name, getattr(PersistenceBase, name))
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv(VARIABLE, "")
    source, made, records = Path("series.csv"), Path("results/a.nc"), Records("results")
    made.parent.mkdir()
    source.write_text("series")
    made.write_text("a")
    inputs = {str(source): digest(source)}
    records.write([str(made)], {"rule": "train"}, {"seed": 1}, inputs, "results/a.log", 5.0)
    changed = made.stat().st_mtime

    def known(path=made):
        plan_by_records("results")
        return PersistenceBase.metadata(None, str(path))

    assert known("results/b.nc") is None
    found = known()
    assert (found.rule, found.params, found.log) == ("train", ["1"], ["results/a.log"])
    assert (found.starttime, found.endtime) == pytest.approx((changed - 5, changed), abs=1e-3)
    assert found.input == ["series.csv"]
    assert found.input_checksums == {"series.csv": f"sha256:{inputs['series.csv']}"}
    source.write_text("another")
    assert known().input == ["series.csv" + FORMER]
    made.write_text("damaged")
    assert known().params == ["results/a.nc is not what its job wrote"]


def test_outputs_without_a_record_are_incomplete(tmp_path, monkeypatch):
    """Of those that Snakemake marked; one of an earlier run that has its record is whole."""
    made = [tmp_path / "results" / f"{name}.nc" for name in ("whole", "half", "missing")]

    async def marked(_self, _job):
        return [str(path) for path in made]

    monkeypatch.setattr(planning, "_marked_incomplete", marked)
    for name in ("metadata", "incomplete"):
        monkeypatch.setattr(PersistenceBase, name, getattr(PersistenceBase, name))
    monkeypatch.setenv(VARIABLE, "")
    made[0].parent.mkdir()
    for path in made[:2]:
        path.write_text("content")
    records = Records(str(tmp_path / "results"))
    records.write([str(made[0])], {"rule": "train"}, {}, {}, "a.log", 1.0)
    plan_by_records(str(tmp_path / "results"))
    found = asyncio.run(PersistenceBase.incomplete(None, None))
    assert found == [str(path) for path in made[1:]]


def limit_left(monkeypatch, limit, local=True):
    """Limit that a scheduler keeps."""

    def make(scheduler, _workflow, *_rest):
        scheduler.job_rate_limiter = limit and JobRateLimiter(limit)

    monkeypatch.setattr(snakemake_patches, "_make_scheduler", make)
    monkeypatch.setattr(JobScheduler, "__init__", JobScheduler.__init__)  # restored afterwards
    start_jobs_without_delay()
    return JobScheduler(SimpleNamespace(local_exec=local), "plugin", "scheduler").job_rate_limiter


@pytest.fixture
def default():
    """What Snakemake's command line has where nobody says otherwise."""
    text = get_argument_parser().get_default("max_jobs_per_timespan")
    return MaxJobsPerTimespan.parse_choice(text)


def test_jobs_of_this_machine_start_at_once(monkeypatch, default):
    assert limit_left(monkeypatch, default) is None
    assert limit_left(monkeypatch, None) is None


def test_a_cluster_is_not_flooded(monkeypatch, default):
    assert limit_left(monkeypatch, default, local=False).max_jobs == default.max_jobs


def test_a_limit_that_was_set_is_kept(monkeypatch):
    limit = MaxJobsPerTimespan.parse_choice("60/1m")
    assert limit_left(monkeypatch, limit).max_jobs == 60


def test_jobs_are_in_groups_where_they_are_submitted(monkeypatch):
    monkeypatch.setattr(Rule, "expand_group", Rule.expand_group)
    plan_without_idle_groups()

    def group(*, local):
        workflow = SimpleNamespace(local_exec=local, parent_groupids={})
        rule = SimpleNamespace(workflow=workflow, group="forecaster")
        return Rule.expand_group(rule, {})

    assert group(local=False) == "forecaster"
    assert group(local=True) is None
