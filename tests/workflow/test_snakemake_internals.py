"""What burstcast needs of Snakemake beyond its documented interface: it is there, and does it."""

import hashlib
import re
import sys

from helpers_configs import ROOT

from helpers_library import said_by

SNAKEFILE = """
from burstcast_workflow import snakemake_internals as internals

campaign = stages = None
calls = []


def look(rule, wildcards):
    if not calls:
        internals.at_start(workflow, lambda: print("before onstart"))
    outputs = [str(path) for path in internals.outputs_of(rule, wildcards)]
    recorded = internals.recorded(workflow, internals.outputs_of(rule, wildcards)[0])
    print("planned", *outputs, recorded, internals.parameters_of(rule, wildcards))
    calls.append(rule.name)
    if config.get("forced") in outputs:
        internals.force(workflow, outputs)


onstart:
    print("onstart")
    internals.without_rate_limit(workflow)
    print("jobs", sorted(job.rule.name for job in internals.planned_jobs(workflow)))
    print("reasons", [reason[:7] for _, reason in internals.reasons_of_jobs(workflow)])
    print("storage", internals.is_in_storage(workflow))


rule wanted:
    input: "b/1.txt"

wanted = [*rules.wanted.input]

rule all:
    default_target: True
    input: lambda wildcards: internals.all_files(workflow, wanted)

rule a:
    output: "a/{n}.txt", "a/{n}.log"
    params: lambda wildcards: f"n = {wildcards.n}"
    shell: "touch {output}"

rule b:
    input: first="a/{n}.txt"
    output: "b/{n}.txt"
    shell: "cp {input.first} {output}"

internals.for_each_job(workflow, look)
print("place", internals.path_of_results(workflow, "results"))
print("names", internals.names_of_rules(workflow)["calls"])
"""
MODULE = """
module inner:
    snakefile: "Snakefile"
    prefix: "below"

use rule * from inner
"""


def run(directory, *options):
    command = [sys.executable, "-m", "snakemake", "--cores", "1", *options]
    return said_by(command, directory, PYTHONPATH=str(ROOT / "src"))


def test_hooks_and_records(tmp_path):
    (tmp_path / "Snakefile").write_text(SNAKEFILE)
    first = run(tmp_path)
    assert "place results\nnames []\n" in first
    for output in ("a/1.txt a/1.log ([], {}) ['n = 1']", "b/1.txt ([], {}) []"):
        assert f"planned {output}\n" in first
    assert "before onstart\nonstart\njobs ['a', 'all', 'b']\n" in first
    assert "reasons ['Missing', 'Missing', 'Input f']\nstorage False\n" in first
    second = run(tmp_path)
    assert "Nothing to be done" in second
    assert """a/1.log (["'n = 1'"], {}) ['n = 1']""" in second
    # with the checksums of what an output was made from
    empty = hashlib.sha256(b"").hexdigest()
    assert re.search(rf"b/1.txt \(\[\], \{{'a/1.txt': '(sha256:)?{empty}'\}}\)", second)
    # a file that nobody reads is made again, and so is one that is forced
    (tmp_path / "a" / "1.log").unlink()
    assert "jobs ['a'" in run(tmp_path)
    assert "Nothing to be done" in run(tmp_path)
    assert "Forced execution" in run(tmp_path, "--config", "forced=b/1.txt")


def test_as_a_module_below_a_prefix(tmp_path):
    (tmp_path / "Snakefile").write_text(SNAKEFILE)
    (tmp_path / "outer.smk").write_text(MODULE)
    said = run(tmp_path, "-s", "outer.smk")
    assert "place below/results\n" in said
    assert "before onstart\n" in said  # and the module's own handler is not called
    assert "\nonstart" not in said
    assert (tmp_path / "below" / "b" / "1.txt").exists()
    (tmp_path / "below" / "a" / "1.log").unlink()
    assert "below/a/1.log" in run(tmp_path, "-s", "outer.smk", "-n")
