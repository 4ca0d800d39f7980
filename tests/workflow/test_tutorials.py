"""Tutorials and records of docs as they are written."""

import doctest
import re
from pathlib import Path

import pytest
import yaml
from helpers_rebuilds import ROOT, THREADS, Project

from burstcast.base.files.netcdf import read_netcdf
from burstcast.base.files.tables import read_table
from burstcast_workflow.commands.command_line import main
from burstcast_workflow.harness.storage import read_json
from helpers_library import copied_repository, said_by

# -- a system of one's own -------------------------------------------------------------------------

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


@pytest.mark.long
def test_the_look_at_the_system(directory, capsys, monkeypatch):
    monkeypatch.syspath_prepend(directory)
    (command,) = (command for command in COMMANDS if command.startswith("burstcast"))
    _, *arguments = command.split()
    assert arguments[0] == "check-system"
    assert main(arguments) == 0
    output = capsys.readouterr().out
    assert all(line in TEXT.splitlines() for line in output.splitlines())
    (session,) = (text for language, text in BLOCKS if language == "pycon")
    parsed = doctest.DocTestParser().get_doctest(session, {}, "tutorial", None, 0)
    assert doctest.DocTestRunner().run(parsed) == (0, len(parsed.examples))


def run(command, directory, job_server, *targets):
    """A command of the tutorial, in the user's directory."""
    arguments = command.replace("path/to/burstcast", str(ROOT)).split()[1:]
    # targets come before the configs, whose list has no end
    outcome = job_server.snakemake(directory, *arguments[:2], *targets, *arguments[2:])
    assert outcome.status == 0, outcome.text[-3000:]
    return outcome


def test_the_plan(directory, job_server):
    (command,) = (command for command in COMMANDS if command.endswith(" -n"))
    outcome = run(command, directory, job_server, "--verbose")
    assert outcome.jobs["train"] == 20
    assert outcome.jobs["event_threshold"] == 1


@pytest.mark.long
def test_the_small_campaign(directory, job_server):
    (command,) = (command for command in COMMANDS if "small.yaml" in command)
    run(command, directory, job_server)
    results = directory / "results" / "roessler_small"
    figures = {path.stem for path in (results / "figures").glob("*.png")}
    assert {"observable_and_density", "prediction_examples", "long_term_density"} <= figures
    assert not {"profile_errors", "midplane_mean_square", "by_reynolds"} & figures
    headers = [path.read_text().splitlines()[0] for path in (results / "tables").glob("*.csv")]
    assert len(headers) > 20
    for word in ("reynolds", "kinetic", "nrmse", "_paper"):
        assert not [header for header in headers if word in header]


# -- own data --------------------------------------------------------------------------------------

DATA_TEXT = (ROOT / "docs" / "tutorial_data.md").read_text(encoding="utf-8")
(PYTHON,) = re.findall(r"```python\n(.*?)```", DATA_TEXT, re.DOTALL)
DATA_CONFIGS = re.findall(r"```yaml\n(.*?)```", DATA_TEXT, re.DOTALL)


@pytest.fixture
def project(tmp_path, job_server, monkeypatch):
    """A working copy with the tutorial's numbers and its config."""
    project = Project.create(tmp_path / "project", job_server, "lab.yaml")
    monkeypatch.chdir(project.directory)
    exec(PYTHON, {})
    (project.directory / "lab.yaml").write_text(DATA_CONFIGS[0])
    return project


def test_from_numbers_to_events(project):
    assert (project.directory / "lab.csv").open().readline() == "time,x,y,z\n"
    project.made("results/lab/lab/lyapunov.json", "results/lab/lab/events.json")
    lab = project.directory / "results/lab/lab"
    assert read_netcdf(lab / "ensemble.nc", "state")["state"].shape == (40, 2001, 3)
    assert read_json(lab / "lyapunov.json")["leading"]["mean"] == pytest.approx(0.906, rel=0.1)
    assert read_json(lab / "events.json")["usable_events"] > 100


def test_the_parts_of_a_state_and_a_known_exponent_are_a_config(project):
    config, exponent, parts = map(yaml.safe_load, DATA_CONFIGS[:3])
    forecasters, names = config["campaign"][0]["forecasters"], list(parts["cases"])
    config["campaign"].append({"reynolds": [400], "cases": names, "forecasters": forecasters})
    config["cases"] |= parts["cases"]
    project.configure(config)
    planned = project.dry_run("results/lab/two_modes/evaluation_set.nc")
    assert planned == {"simulate": 1, "import_data": 1, "time_unit": 1, "evaluation_set": 1}
    project.made("-n", "results/lab/two_modes_and_their_past/evaluation_set.nc")
    # the second run counts in what it is told
    config["cases"]["lab"] |= exponent["cases"]["lab"]
    project.configure(config | {"results": "results/lab_again"})
    planned = project.dry_run("results/lab_again/lab/evaluation_set.nc")
    assert planned == {"import_data": 1, "time_unit": 1, "evaluation_set": 1}  # no estimate


@pytest.mark.long
def test_the_whole_tutorial(project):
    outcome = project.made()
    assert "lab: measured series; off: " in outcome.text
    table = read_table(project.directory / "results/lab/tables/classification.csv")
    at_one = table[table["prediction_time_lt"] == 1].groupby("forecaster")["f_score"].median()
    assert at_one["esn"] > 0.9
    assert at_one["quadratic_filtered"] > 0.9
    assert at_one["persistence"] < 0.1


# -- real records ----------------------------------------------------------------------------------

RECORDS = (ROOT / "docs" / "real_records.md").read_text(encoding="utf-8")
OF_RECORDS = [
    line for block in re.findall(r"```sh\n(.*?)```", RECORDS, re.S) for line in block.splitlines()
]
NAMES = ("glucose", "fulda")
NUMBER = re.compile(r"-?\d+\.\d+")


def of(name):
    """The campaign of one record, and what shows its scores."""
    return [
        command
        for command in OF_RECORDS
        if name in command and re.search("snakemake|scores.py", command)
    ]


def shell(command, records):
    """Run a command of the page as a reader would, with one core."""
    return said_by(["env", "-u", "VIRTUAL_ENV", "bash", "-ec", command], records, **THREADS)


def rows(text):
    """Scores of a table in Markdown by its first two cells, the numbers of each row in turn."""
    scores = {}
    for line in text.splitlines():
        if line.startswith("|") and NUMBER.search(line):
            source, time, *cells = [cell.strip() for cell in line.strip("| ").split("|")]
            scores[source, time] = [
                float(number) for cell in cells for number in NUMBER.findall(cell)
            ]
    return scores


def shown(name):
    """Table of a record on the page."""
    heading = {"glucose": "## Low glucose", "fulda": "## High water"}[name]
    return rows(RECORDS.partition(heading)[2].partition("\n## ")[0])


def test_the_page_names_what_there_is():
    assert len(OF_RECORDS) == len(set(OF_RECORDS))
    for name in NAMES:
        config, scores = of(name)
        assert (ROOT / config.rpartition(" ")[2]).is_file()
        assert f"scores.py results/{name} " in scores
        assert len(shown(name)) > 5
    lock = (ROOT / "requirements-records.lock").read_text(encoding="utf-8")
    for package in re.findall(r"^([\w-]+)==", lock, re.M):
        assert package in RECORDS


@pytest.fixture(scope="module")
def records(tmp_path_factory):
    """A fresh copy of the repository with its own environment and the extracted records."""
    records = copied_repository(tmp_path_factory.mktemp("records") / "burstcast")
    for command in OF_RECORDS:
        if not any(name in command for name in NAMES):
            shell(command, records)
    return records


@pytest.mark.long
@pytest.mark.parametrize("name", NAMES)
def test_the_campaigns_give_the_scores_of_the_page(records, name):
    campaign, scores = of(name)
    shell(f"{campaign} --cores 1", records)
    computed = rows(shell(scores, records))
    expected = shown(name)
    assert list(computed) == list(expected)
    for key, numbers in expected.items():
        # other kernels of linear algebra round otherwise, and trees and optimisers follow
        assert computed[key] == pytest.approx(numbers, abs=0.05), key
