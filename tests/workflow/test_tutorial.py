"""The tutorial of a system of one's own, as it is written."""

import doctest
import re
from dataclasses import replace
from pathlib import Path

import pytest
from helpers_rebuilds import Project

from burstcast.files.tables import read_table
from burstcast_workflow.commands.command_line import main

TEXT = (Path(__file__).parents[2] / "docs" / "tutorial.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"^```(\w*)\n(.*?)^```$", TEXT, re.MULTILINE | re.DOTALL)
(MODULE,) = (text for language, text in BLOCKS if language == "python")
CONFIGS = {
    text.splitlines()[0].removeprefix("# "): text for language, text in BLOCKS if language == "yaml"
}
COMMANDS = [
    line.partition("  #")[0].strip()
    for language, text in BLOCKS
    for line in text.splitlines()
    if language == "sh" and line.startswith(("snakemake ", "burstcast "))
]


@pytest.fixture
def directory(tmp_path, monkeypatch):
    """The user's directory, with all files of the tutorial."""
    (tmp_path / "my_flows.py").write_text(MODULE)
    for name, text in CONFIGS.items():
        (tmp_path / name).write_text(text)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_the_tutorial_has_the_parts_that_are_run_here():
    assert list(CONFIGS) == ["roessler.yaml", "small.yaml"]
    assert [command.split()[0] for command in COMMANDS] == ["burstcast", *["snakemake"] * 3]
    assert "class Roessler(DynamicalSystem)" in MODULE


def test_the_look_at_the_system(directory, capsys, monkeypatch):
    monkeypatch.syspath_prepend(directory)
    (command,) = (command for command in COMMANDS if command.startswith("burstcast"))
    _, *arguments = command.split()
    assert arguments[0] == "check-system"
    assert main(arguments) == 0
    said = capsys.readouterr().out
    assert all(line in TEXT.splitlines() for line in said.splitlines())
    (session,) = (text for language, text in BLOCKS if language == "pycon")
    parsed = doctest.DocTestParser().get_doctest(session, {}, "tutorial", None, 0)
    assert doctest.DocTestRunner().run(parsed) == (0, len(parsed.examples))


def run(command, directory, tmp_path_factory, job_server, *targets):
    """A command of the tutorial, in the user's directory."""
    project = Project.create(tmp_path_factory.mktemp("burstcast") / "project", job_server)
    own = replace(project, directory=directory)
    arguments = command.replace("path/to/burstcast", str(project.directory)).split()[1:]
    environment = {**own.environment(), "PYTHONPATH": project.environment()["PYTHONPATH"]}
    # targets come before the configs, whose list has no end
    outcome = own._request({"arguments": [*arguments[:2], *targets, *arguments[2:]]}, environment)
    assert outcome.status == 0, outcome.text[-3000:]
    return outcome


def test_the_plan(directory, tmp_path_factory, job_server):
    (command,) = (command for command in COMMANDS if command.endswith(" -n"))
    outcome = run(command, directory, tmp_path_factory, job_server)
    assert outcome.jobs["train"] == 20
    assert outcome.jobs["event_threshold"] == 1


def test_the_small_campaign_up_to_its_scores(directory, tmp_path_factory, job_server):
    (command,) = (command for command in COMMANDS if "small.yaml" in command)
    table = "results/roessler_small/tables/classification.csv"
    run(command, directory, tmp_path_factory, job_server, table)
    scores = read_table(directory / table)
    assert set(scores["forecaster"]) == {"esn", "equations_noisy", "permanent_alarm"}
    assert "reynolds" not in (directory / table).read_text()


@pytest.mark.long
def test_the_small_campaign(directory, tmp_path_factory, job_server):
    (command,) = (command for command in COMMANDS if "small.yaml" in command)
    run(command, directory, tmp_path_factory, job_server)
    results = directory / "results" / "roessler_small"
    figures = {path.stem for path in (results / "figures").glob("*.png")}
    assert {"observable_and_density", "prediction_examples", "long_term_density"} <= figures
    assert not {"profile_errors", "midplane_mean_square", "by_reynolds"} & figures
    headers = [path.read_text().splitlines()[0] for path in (results / "tables").glob("*.csv")]
    assert len(headers) > 20
    for word in ("reynolds", "kinetic", "nrmse", "_paper"):
        assert not [header for header in headers if word in header]
