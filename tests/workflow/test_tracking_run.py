"""The run that a results directory belongs to."""

import json
import os
import shutil

import pytest

from burstcast_workflow.tracking.run import (
    CLAIM,
    VARIABLE,
    OvertakenError,
    begin,
    check_ownership,
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


def test_without_the_environment_jobs_belong_to_the_newest_run(monkeypatch):
    check_ownership()
    with pytest.raises(
        OvertakenError, match=r"results/tiny/\.run\.json, which a run writes, is not"
    ):
        plan("results/tiny")
    begun()
    monkeypatch.delenv(VARIABLE)
    assert plan("results/tiny")["config"] == {"results": "results/tiny"}
    check_ownership()


@pytest.mark.parametrize("text", ["", "[]", json.dumps({"token": None})])
def test_a_damaged_claim_is_none(directory, text):
    begun()
    (directory / "results" / "tiny" / CLAIM).write_text(text)
    with pytest.raises(OvertakenError):
        plan()
