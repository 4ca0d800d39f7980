"""What jobs really run is in the code that they are planned with: every script of a campaign."""

import ast
import json
from functools import cache
from pathlib import Path

import pytest
import yaml
from helpers_rebuilds import RESULTS, TINY, Project

from burstcast_workflow.campaign.campaign import Campaign
from burstcast_workflow.campaign.loading import load
from burstcast_workflow.figures.registry import figure_case
from burstcast_workflow.harness.call import is_script
from burstcast_workflow.project import UNTRACKED
from burstcast_workflow.tracking.code import Sources

# Imported by each process of Python: those of scripts write down which functions they call.
RECORDER = """
import atexit, json, os, sys, threading

called = set()

def profile(frame, event, argument):
    code = frame.f_code
    if event == "call" and code.co_flags & 1 and "burstcast" in code.co_filename:  # of a function
        place = code.co_filename, code.co_firstlineno, code.co_name
        if (place, None) not in called:
            called.add((place, reason_of(frame.f_back)))

def reason_of(frame):
    # None for what the script's function calls; else the line of a module that is imported
    while frame is not None:
        file, name = frame.f_code.co_filename, frame.f_code.co_name
        if name == "<module>" and "/src/burstcast" in file:
            return file, frame.f_lineno
        if file.endswith("harness/call.py") and name in ("__init__", "__call__"):
            return None
        if file.endswith("harness/running.py"):
            return file, 0
        frame = frame.f_back

def write():
    sys.setprofile(None)
    snakemake = sys.modules["__main__"].snakemake
    record = {"rule": snakemake.rule, "wildcards": dict(snakemake.wildcards.items()),
              "maker": snakemake.params.get("maker"), "code": snakemake.params.code,
              "called": sorted(called, key=str)}
    with open(os.path.join(os.environ["RECORDS"], f"{os.getpid()}.json"), "w") as file:
        json.dump(record, file)

if "/.snakemake/scripts/" in " ".join(sys.orig_argv):
    atexit.register(write)
    threading.setprofile(profile)
    sys.setprofile(profile)
"""


@cache
def definition_at(path: Path, line: int) -> str:
    """Definition of a module that the function in a line belongs to; "" if it runs at import."""
    for node in ast.parse(path.read_bytes()).body:
        first = min([node.lineno, *(each.lineno for each in getattr(node, "decorator_list", []))])
        if first <= line <= (node.end_lineno or first):
            names = [getattr(target, "id", "") for target in getattr(node, "targets", [])]
            target = getattr(getattr(node, "target", None), "id", "")
            return getattr(node, "name", "") or target or "".join(names[:1])
    return ""


def by_name(campaign: Campaign, record: dict) -> dict[str, list[str]]:
    """Modules that the registries find for a job."""
    if figure := record["wildcards"].get("figure"):
        case = figure_case(campaign, figure, record["wildcards"]["of_case"])
        return {**campaign.modules({"case": case}), "burstcast.figures": [figure]}
    makers = {"burstcast.tables.makers": [record["maker"]]} if record["maker"] else {}
    return {**campaign.modules(record["wildcards"]), **makers}


def is_used(source: Path, used: dict, file: str, line: int) -> bool:
    """Whether a line is in code that a job uses, or in what is in no code."""
    parts = Path(file).relative_to(source).with_suffix("").parts
    module = ".".join(parts).removesuffix(".__init__")
    is_outside = f"{module}.".startswith(UNTRACKED)
    return is_outside or definition_at(Path(file), line) in used.get(module, {})


def unplanned(directory: Path, records: Path) -> dict[str, list[str]]:
    """Functions that jobs have called, and that are not in the code of these, by the rule."""
    source, scripts = directory / "src", directory / "workflow" / "scripts"
    preset = directory / TINY
    config = load(yaml.safe_load(preset.read_text()), [preset], defaults=directory / "config.yaml")
    campaign = Campaign(config)
    sources = Sources(lambda name: scripts / name, source, {})
    missing: dict[str, set[str]] = {}
    for path in records.glob("*.json"):
        record = json.loads(path.read_text())
        (script,) = filter(is_script, record["code"])
        # the definitions are those of the job
        assert record["code"] == sources.code(script, by_name(campaign, record))
        used = sources.definitions(script, by_name(campaign, record))
        for (file, line, name), importing in record["called"]:
            # what makes a constant that the job does not use is no code of it
            concerned = importing is None or (importing[1] and is_used(source, used, *importing))
            if file.startswith(str(source)) and concerned and not is_used(source, used, file, line):
                missing.setdefault(record["rule"], set()).add(f"{file}:{line} {name}")
    return {rule: sorted(names) for rule, names in missing.items()}


@pytest.mark.long
def test_every_function_that_ran_is_in_the_code_of_its_job(tmp_path):
    project = Project.create(tmp_path / "project")
    records, recorder = tmp_path / "records", tmp_path / "recorder"
    records.mkdir()
    recorder.mkdir()
    (recorder / "sitecustomize.py").write_text(RECORDER)
    path = f"{project.directory / 'src'}:{recorder}"
    outcome = project.snakemake(PYTHONPATH=path, RECORDS=str(records), BURSTCAST_CACHE="")
    assert outcome.status == 0, outcome.text[-3000:]
    jobs = len([*(project.directory / RESULTS / "logs").rglob("*.log")])
    assert jobs == len([*records.glob("*.json")]) > 100
    assert unplanned(project.directory, records) == {}
