"""The provenance of an archive: what the records say, in a crate that a validator accepts."""

import json
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

from burstcast_workflow.commands.archive import contents, write_archive
from burstcast_workflow.commands.crate import METADATA, metadata
from snaketrust.records import Record

ROOT = Path(__file__).parents[2]
SECOND = 10**9
DAY = 1_700_000_000


def record(path, rule, inputs=(), written=DAY, seconds=2.0, **wildcards):
    return Record(
        path=path,
        digest=f"digest of {path}",
        stamp=[1, written * SECOND, 0, 0],
        identity={"rule": rule, **wildcards},
        parameters={},
        inputs={name: f"digest of {name}" for name in inputs},
        log="",
        seconds=seconds,
        revision="abc",
    )


RECORDS = [
    record("Re400/a b.nc", "simulate", case="Re400"),
    record("Re400/summary.json", "simulate", written=DAY + 1, case="Re400"),
    record("Re600/a b.nc", "simulate", ["../data.csv"], case="Re600"),
    record("tables/x.csv", "table", ["Re400/a b.nc", "Re600/a b.nc"], DAY + 60, 5.0),
]
FILES = ["Snakefile", "config.yaml", "README.md", "tables/x.csv"]


def graph(content):
    return {one["@id"]: one for one in json.loads(content)["@graph"]}


def made(records=RECORDS):
    return metadata("paper", FILES, records, revision="abc", licence="MIT")


def references(value):
    if isinstance(value, dict):
        if set(value) == {"@id"}:
            yield value["@id"]
        else:
            for one in value.values():
                yield from references(one)
    elif isinstance(value, list):
        for one in value:
            yield from references(one)


def many(value):
    return [one["@id"] for one in (value if isinstance(value, list) else [value])]


def test_each_job_has_its_rule_inputs_outputs_and_time():
    found = graph(made())
    jobs = {one["name"]: one for key, one in found.items() if key.startswith("#job-")}
    assert set(jobs) == {"simulate, case Re400", "simulate, case Re600", "table"}
    table = jobs["table"]
    assert table["instrument"] == {"@id": "#rule-table"}
    assert many(table["object"]) == ["#file-Re400/a%20b.nc", "#file-Re600/a%20b.nc"]
    assert many(table["result"]) == ["tables/x.csv"]
    assert table["endTime"] == "2023-11-14T22:14:20+00:00"
    assert table["startTime"] == "2023-11-14T22:14:15+00:00"
    first = jobs["simulate, case Re400"]
    assert many(first["result"]) == ["#file-Re400/a%20b.nc", "#file-Re400/summary.json"]
    assert first["endTime"] == "2023-11-14T22:13:21+00:00"  # of its last file
    assert found["#file-Re400/a%20b.nc"]["identifier"] == "sha256:digest of Re400/a b.nc"
    assert many(jobs["simulate, case Re600"]["object"]) == ["#file-../data.csv"]
    assert found["#run"]["startTime"] == "2023-11-14T22:13:18+00:00"
    assert found["./"]["datePublished"] == found["#run"]["endTime"] == table["endTime"]
    assert len(many(found["#organise"]["object"])) == 3


def test_all_that_is_named_is_there():
    content = made()
    found = graph(content)
    assert len(found) == len(json.loads(content)["@graph"])
    named = {name for one in found.values() for key in one for name in references(one[key])}
    elsewhere = {name for name in named - set(found) if name.startswith("https://")}
    assert named - set(found) == elsewhere
    assert many(found["./"]["hasPart"]) == sorted(FILES)


def test_the_order_of_the_records_does_not_count():
    assert made() == made(RECORDS[::-1])
    assert made() != made(RECORDS[:-1])


@pytest.fixture
def archived(finished, tmp_path):
    """Archive of the tiny campaign, unpacked."""
    results = finished.project.results
    config = json.loads((results / ".run.json").read_bytes())["config"]
    files = contents(results, config, "nothing")
    write_archive(tmp_path / "tiny.zip", files)
    with zipfile.ZipFile(tmp_path / "tiny.zip") as archive:
        archive.extractall(tmp_path)
    return tmp_path / results.name


def test_an_archive_of_a_campaign_is_a_crate(archived, finished):
    found = graph((archived / METADATA).read_bytes())
    there = {str(path.relative_to(archived)) for path in archived.rglob("*") if path.is_file()}
    assert set(many(found["./"]["hasPart"])) == there - {METADATA}
    rules = {one["name"] for key, one in found.items() if key.startswith("#rule-")}
    assert {"simulate", "train", "forecast", "classification_table"} <= rules
    assert str(finished.project.directory) not in (archived / METADATA).read_text()


@pytest.mark.long  # installs the validator
def test_a_validator_accepts_the_crate(archived, tmp_path):
    """roc-validator: all that the Provenance Run Crate profile and those below it require."""
    subprocess.run([sys.executable, "-m", "venv", tmp_path / "venv"], check=True)
    python = tmp_path / "venv" / "bin" / "python"
    lock = ["-r", ROOT / "requirements-provenance.lock"]
    install = ["-m", "pip", "install", "-q", "--disable-pip-version-check", "--no-deps"]
    subprocess.run([python, *install, *lock], check=True)
    script = Path(__file__).with_name("validate_crate.py")

    def validated():
        return subprocess.run([python, script, archived], capture_output=True, text=True)

    result = validated()
    assert (result.returncode, result.stdout) == (0, ""), result.stdout + result.stderr[-2000:]
    # it sees what is wrong: a step that no workflow has
    document = json.loads((archived / METADATA).read_bytes())
    (workflow,) = (one for one in document["@graph"] if one["@id"] == "Snakefile")
    workflow["step"] = workflow["step"][1:]
    (archived / METADATA).write_text(json.dumps(document))
    result = validated()
    assert result.returncode == 1
    assert "A HowToStep must be referred to" in result.stdout
