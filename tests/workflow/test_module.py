"""Using burstcast from elsewhere: as a module, in another directory, by workflow/Snakefile."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

PROJECT = Path(__file__).parents[2]
TINY = PROJECT / "workflow" / "presets" / "tiny.yaml"

MODULE = f"""
configfile: {str(TINY)!r}

module burstcast:
    snakefile: {str(PROJECT / "Snakefile")!r}
    config: config

use rule * from burstcast"""


def planned_jobs(directory, *arguments):
    """How many jobs of each rule Snakemake plans in a directory."""
    command = [sys.executable, "-m", "snakemake", "--dry-run", "--cores", "1", *arguments]
    result = subprocess.run(command, cwd=directory, capture_output=True, text=True, check=False)
    assert result.returncode == 0, result.stdout + result.stderr
    found = re.findall(r"^(\w+) +(\d+)$", result.stdout + result.stderr, re.MULTILINE)
    return {rule: int(count) for rule, count in found}


@pytest.fixture(scope="module")
def expected(tmp_path_factory):
    """What is planned where nothing has been computed yet, with the project's own Snakefile."""
    arguments = ["-s", PROJECT / "Snakefile", "--configfile", TINY]
    jobs = planned_jobs(tmp_path_factory.mktemp("elsewhere"), *arguments)
    assert jobs["total"] > 50
    return jobs


@pytest.mark.parametrize("prefix", ["", "flow_"])
def test_another_workflow_takes_it_as_a_module(tmp_path, expected, prefix):
    naming = f" as {prefix}*" if prefix else ""
    (tmp_path / "Snakefile").write_text(f"{MODULE}{naming}\n", encoding="utf-8")
    assert planned_jobs(tmp_path) == {
        rule if rule == "total" else prefix + rule: count for rule, count in expected.items()
    }


def test_a_snakefile_below_workflow(tmp_path, expected):
    arguments = ["-s", PROJECT / "workflow" / "Snakefile", "--configfile", TINY]
    assert planned_jobs(tmp_path, *arguments) == expected
