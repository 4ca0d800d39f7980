"""The run that a results directory belongs to."""

import json
import os
import shutil
from pathlib import Path

import pytest

from burstcast_workflow.tracking.results import digest, note
from burstcast_workflow.tracking.run import (
    CLAIM,
    VARIABLE,
    OvertakenError,
    begin,
    check_ownership,
    is_known,
    plan,
)


@pytest.fixture(autouse=True)
def directory(tmp_path, monkeypatch):
    monkeypatch.setenv(VARIABLE, "")
    monkeypatch.delenv(VARIABLE)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def begun(results="results/tiny"):
    begin(results, {"results": results}, ["a @1"], ["/own"], "abc")


def result(path="results/tiny/table.csv"):
    Path(path).write_text("1")
    note(path, digest(path))


def metadata(path=".snakemake/metadata"):
    Path(path).mkdir(parents=True, exist_ok=True)
    (Path(path) / "one").touch()


def test_jobs_know_what_their_run_has_planned():
    begun()
    claim = plan()
    assert claim["config"] == {"results": "results/tiny"}
    assert (claim["code"], claim["directories"], claim["revision"]) == (["a @1"], ["/own"], "abc")
    check_ownership()


def test_a_job_whose_run_was_overtaken_writes_nothing(directory, monkeypatch):
    begun()
    former = os.environ[VARIABLE]
    begun()
    check_ownership()
    monkeypatch.setenv(VARIABLE, former)
    for look in (plan, check_ownership):
        with pytest.raises(OvertakenError, match="results/tiny belongs to a newer run"):
            look()
    shutil.rmtree(directory / "results")
    with pytest.raises(OvertakenError):
        plan()


def test_without_a_run_nobody_owns_anything_and_no_job_runs():
    check_ownership()
    with pytest.raises(OvertakenError, match="does not reach jobs"):
        plan()


def test_results_are_known_where_they_were_made_and_nowhere_else(directory, monkeypatch):
    assert is_known("results/tiny")  # there are none
    begun()
    Path("results/tiny/job.log").touch()
    assert is_known("results/tiny")  # no job has ended: there is nothing to believe
    result()
    assert not is_known("results/tiny")
    metadata()
    assert is_known("results/tiny")
    assert is_known("results/other")
    # who made them is not known: they were copied here
    result("results/bare.csv")
    assert not is_known("results")
    Path("results/bare.csv").unlink()
    # another campaign of the same directory
    begun("results/other")
    assert is_known("results/tiny")
    assert is_known("results/other")
    # a copy of everything knows them, a copy of the results alone does not
    whole, bare = directory / "whole", directory / "bare"
    for part in ("results", ".snakemake"):
        shutil.copytree(directory / part, whole / part)
    shutil.copytree(directory / "results", bare / "results")
    monkeypatch.chdir(whole)
    assert is_known("results/tiny")
    monkeypatch.chdir(bare)
    assert not is_known("results/tiny")
    metadata()
    assert not is_known("results/tiny")
    # and whoever has made them last, knows them alone
    begun()
    shutil.copy(bare / "results/tiny" / CLAIM, directory / "results/tiny" / CLAIM)
    monkeypatch.chdir(directory)
    assert not is_known("results/tiny")


def test_a_damaged_claim_is_none(directory):
    begun()
    metadata()
    for text in ("", "[]", json.dumps({"token": None})):
        (directory / "results" / "tiny" / CLAIM).write_text(text)
        with pytest.raises(OvertakenError):
            plan()
