"""docs/real_records.md as it is written: its commands in a fresh environment, its scores."""

import os
import re
import shutil
import subprocess

import pytest
from helpers_rebuilds import ROOT, THREADS

TEXT = (ROOT / "docs" / "real_records.md").read_text(encoding="utf-8")
COMMANDS = [
    line for block in re.findall(r"```sh\n(.*?)```", TEXT, re.S) for line in block.splitlines()
]
NAMES = ("glucose", "fulda")
NUMBER = re.compile(r"-?\d+\.\d+")


def of(name):
    """Commands that are about one record."""
    return [command for command in COMMANDS if name in command]


def run(command, directory):
    """Run a command of the page as a reader would, with one core."""
    environment = {name: text for name, text in os.environ.items() if name != "VIRTUAL_ENV"}
    result = subprocess.run(
        ["bash", "-ec", command],
        cwd=directory,
        env={**environment, **THREADS},
        capture_output=True,
        text=True,
        check=False,
    )
    assert result.returncode == 0, f"{command}: {result.stdout[-2000:]}{result.stderr[-3000:]}"
    return result.stdout


def rows(text):
    """Scores of a table in Markdown by its first two cells, the numbers of each row in turn."""
    found = {}
    for line in text.splitlines():
        if line.startswith("|") and NUMBER.search(line):
            source, time, *cells = [cell.strip() for cell in line.strip("| ").split("|")]
            found[source, time] = [
                float(number) for cell in cells for number in NUMBER.findall(cell)
            ]
    return found


def shown(name):
    """Table of a record on the page."""
    heading = {"glucose": "## Low glucose", "fulda": "## High water"}[name]
    return rows(TEXT.partition(heading)[2].partition("\n## ")[0])


def test_the_page_names_what_there_is():
    assert len(COMMANDS) == len(set(COMMANDS))
    for name in NAMES:
        config, scores = of(name)
        assert (ROOT / config.rpartition(" ")[2]).is_file()
        assert f"scores.py results/{name} " in scores
        assert len(shown(name)) > 5
    lock = (ROOT / "requirements-records.lock").read_text(encoding="utf-8")
    for package in re.findall(r"^([\w-]+)==", lock, re.M):
        assert package in TEXT


@pytest.fixture(scope="module")
def directory(tmp_path_factory):
    """A fresh copy of the repository with its own environment and the extracted records."""
    directory = tmp_path_factory.mktemp("records") / "burstcast"
    directory.mkdir()
    listed = ["git", "ls-files", "--cached", "--others", "--exclude-standard"]
    files = subprocess.run(listed, cwd=ROOT, capture_output=True, text=True, check=True).stdout
    for file in files.splitlines():
        (directory / file).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy2(ROOT / file, directory / file)
    for command in COMMANDS:
        if not any(name in command for name in NAMES):
            run(command, directory)
    return directory


@pytest.mark.long
@pytest.mark.parametrize("name", NAMES)
def test_the_campaigns_give_the_scores_of_the_page(directory, name):
    campaign, scores = of(name)
    run(f"{campaign} --cores 1", directory)
    found = rows(run(scores, directory))
    expected = shown(name)
    assert list(found) == list(expected)
    for key, numbers in expected.items():
        # other kernels of linear algebra round otherwise, and trees and optimisers follow
        assert found[key] == pytest.approx(numbers, abs=0.05), key
