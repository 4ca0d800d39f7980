"""Using burstcast from elsewhere: as a module, in another directory, by workflow/Snakefile."""

import re
import shutil
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
    if "Nothing to be done" in result.stdout + result.stderr:
        return {}
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


FLOWS = "Re400/control/esn-N40-RV-seed0/prediction_triggered-prediction_time1-window1/flows.nc"


@pytest.mark.long
@pytest.mark.parametrize("prefix", ["", "below"])
def test_a_module_runs_and_its_results_are_known(tmp_path, finished, prefix):
    """Files say the stages that made them, whatever the rules are called; where they are, too."""
    where = f"\n    prefix: {prefix!r}" if prefix else ""
    module = MODULE.replace("    config: config", f"    config: config{where}")
    (tmp_path / "Snakefile").write_text(f"{module} as flow_*\n", encoding="utf-8")
    results = tmp_path / prefix / "results" / "tiny"
    # what another rule has made, under its own name, is taken over with its records
    shutil.copytree(finished.project.results, results)
    table = results / "tables" / "control.csv"
    assert planned_jobs(tmp_path, str(table.relative_to(tmp_path))) == {}
    before = table.read_bytes()
    for path in (table, results / FLOWS):
        path.unlink()
    command = [sys.executable, "-m", "snakemake", "--cores", "1", table.relative_to(tmp_path)]
    result = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert result.returncode == 0, result.stdout + result.stderr
    assert table.read_bytes() == before
    assert planned_jobs(tmp_path, str(table.relative_to(tmp_path))) == {}
