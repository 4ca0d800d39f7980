"""What any workflow may do: what counts reruns, what does not settles, and the rest is refused."""

import os

import pytest
from helpers_toy import Toy

SNAKEFILE = """
from pathlib import Path

import numpy as np

from snaketrust.project import Project
from snaketrust.start import start


configfile: "config.yaml"


ROOT = Path(str(workflow.current_basedir))
PROJECT = Project(root=ROOT, scripts=ROOT / "scripts", sources=ROOT / "lib", packages=("toy",))
started = start(workflow, PROJECT, lambda config: config["results"], lambda: dict(config))
config, sources = started.config, started.sources
RESULTS = config["results"]


rule join:
    input:
        config["list"],
        a=config["first"],
        b=config["second"],
    output:
        f"{RESULTS}/joined.txt",
    params:
        settings=SETTINGS,
        low=config["low"],
        high=config["high"],
        code=sources.fingerprint("join.py"),
    script:
        "scripts/join.py"


MORE
"""
SCRIPT = """
import json
from pathlib import Path

import common
from snaketrust.job import run_job
from toy import settled


def compute():
    named = snakemake.input.a, snakemake.input.b
    texts = [Path(path).read_text() for path in [*snakemake.input[:-2], *named]]
    limits = snakemake.params.low, snakemake.params.high
    said = common.join([*texts, str(limits), json.dumps(snakemake.params.settings), settled()])
    Path(snakemake.output[0]).write_text(said)


run_job(snakemake, compute)
"""
CONFIG = """
results: results
first: x.txt
second: y.txt
list: [x.txt, y.txt]
low: 1
high: 2
"""
FILES = {
    "Snakefile": SNAKEFILE,
    "config.yaml": CONFIG,
    "scripts/join.py": SCRIPT,
    "scripts/common.py": "def join(texts):\n    return ' '.join(texts)\n",
    "scripts/words.py": "def word():\n    return 'word'\n",
    "lib/toy/__init__.py": "from other import more\n\n\ndef settled():\n    return more()\n",
    "lib/other.py": "from bare.part import part\n\n\ndef more():\n    return f'more {part()}'\n",
    "lib/bare/part.py": "def part():\n    import words\n\n    return f'part {words.word()}'\n",
    "x.txt": "x",
    "y.txt": "y",
}
SETTINGS = '{"odd": (1, [2.0]), 3: {"b": np.float64(0.5), "a": 4.0}}'


def foreign(directory, settings=SETTINGS, more="", **changes):
    snakefile = SNAKEFILE.replace("SETTINGS", settings).replace("MORE", more)
    return Toy(directory, {**FILES, "Snakefile": snakefile, **changes})


@pytest.fixture(scope="module")
def workflow(tmp_path_factory):
    toy = foreign(tmp_path_factory.mktemp("foreign"))
    assert toy.run() == {"join": 1}
    return toy


def content(toy):
    return (toy.directory / "results" / "joined.txt").read_text()


@pytest.mark.parametrize(
    ("name", "old", "new"),
    [
        ("config.yaml", "first: x.txt\nsecond: y.txt", "first: y.txt\nsecond: x.txt"),
        ("config.yaml", "[x.txt, y.txt]", "[y.txt, x.txt]"),
        ("config.yaml", "low: 1\nhigh: 2", "low: 2\nhigh: 1"),
        ("scripts/common.py", "' '", "'-'"),
        ("scripts/words.py", "'word'", "'text'"),
        ("lib/other.py", "'more", "'less"),
        ("lib/bare/part.py", "'part", "'rest"),
        ("Snakefile", "[2.0]", "[2.5]"),
        ("x.txt", "x", "z"),
    ],
)
def test_whatever_changes_the_result_makes_it_again(workflow, name, old, new):
    before, path = content(workflow), workflow.directory / name
    times = path.stat()
    workflow.edit(name, old, new)
    if name.endswith(".py"):  # Python alone would run what it had compiled
        os.utime(path, ns=(times.st_atime_ns, times.st_mtime_ns))
    assert workflow.run() == {"join": 1}
    assert content(workflow) != before
    workflow.edit(name, new, old)
    assert workflow.run() == {"join": 1}
    assert content(workflow) == before


@pytest.mark.parametrize(
    "spellings",
    [
        {
            "first: x.txt": "first: ./x.txt",
            "[x.txt, y.txt]": "[{directory}/x.txt, ./y.txt]",
            "low: 1": "low: 1.0",
            "results: results": "results: ./results",
        },
        {
            "first: x.txt": "first: {directory}/x.txt",
            "low: 1\nhigh: 2": "high: 2\nlow: 1",
            "results: results": "results: {directory}/results",
        },
    ],
)
def test_another_spelling_of_the_same_runs_nothing(workflow, spellings):
    before, config = content(workflow), (workflow.directory / "config.yaml").read_text()
    for old, new in spellings.items():
        workflow.edit("config.yaml", old, new.format(directory=workflow.directory))
    assert workflow.run() == {}
    assert workflow.run("--forceall") == {"join": 1}
    assert content(workflow) == before
    (workflow.directory / "config.yaml").write_text(config)
    assert workflow.run() == {}


def test_the_same_file_twice_settles(tmp_path):
    toy = foreign(tmp_path)
    toy.edit("config.yaml", "[x.txt, y.txt]", "[x.txt, x.txt]")
    assert toy.run() == {"join": 1}
    assert toy.run() == {}


CHECKPOINT = """
checkpoint split:
    output: f"{RESULTS}/number.txt"
    params: code=sources.fingerprint("write.py"), said=config["low"]
    script: "scripts/write.py"


def parts(wildcards):
    number = int(Path(checkpoints.split.get().output[0]).read_text())
    return [f"{RESULTS}/part{place}.txt" for place in range(number)]


rule part:
    output: f"{RESULTS}/part{{place}}.txt"
    params: code=sources.fingerprint("write.py"), said=config["high"]
    script: "scripts/write.py"


rule gather:
    input: parts
    output: f"{RESULTS}/gathered.txt"
    params: code=sources.fingerprint("write.py"), said=lambda wildcards, input: [*input]
    script: "scripts/write.py"
"""
WRITE = """
from pathlib import Path
from snaketrust.job import run_job


def compute():
    read = [Path(path).read_text() for path in snakemake.input]
    Path(snakemake.output[0]).write_text(" ".join([*read, str(snakemake.params.said)]))


run_job(snakemake, compute)
"""


def test_what_a_checkpoint_finds_is_made_once(tmp_path):
    toy = foreign(tmp_path, more=CHECKPOINT, **{"scripts/write.py": WRITE})
    target = "--nocolor", "results/gathered.txt"
    assert toy.run(*target) == {"part": 1, "gather": 1}
    assert toy.run(*target) == {}
    toy.edit("config.yaml", "low: 1", "low: 3")
    assert toy.run(*target) == {"part": 2, "gather": 1}
    assert toy.run(*target) == {}
    gathered = toy.directory / "results" / "gathered.txt"
    assert gathered.read_text().startswith("2 2 2 ['results/part0.txt'")
    toy.edit("config.yaml", "high: 2", "high: 5")
    assert toy.run(*target) == {"part": 3, "gather": 1}
    assert gathered.read_text().startswith("5 5 5 ")


CODED, JOINED = 'params: code=sources.fingerprint("join.py")', 'script: "scripts/join.py"'
READER = (
    'rule reader:\n    input: f"{RESULTS}/3.txt"\n    output: "read.txt"\n    shell: "cat {input}"'
)
# What is said of a rule: its output, with {} for a file of its own in the results, and other lines.
REFUSED = {
    "shell:": ("{}", 'shell: "touch {output}"'),
    "run:": ("{}", "run: Path(output[0]).touch()"),
    "the output directory()": ("directory({})", CODED, JOINED),
    "the output pipe()": ("pipe({})", CODED, f"{JOINED}\n\n\n{READER}"),
    "the output touch()": ("touch({})", CODED, JOINED),
    "the output ensure()": ("ensure({}, non_empty=True)", CODED, JOINED),
    "no parameter code": ("{}", JOINED),
    "but its code is the fingerprint of join.py": ("{}", CODED, 'script: "scripts/common.py"'),
    "elsewhere": ('{}, "else.txt"', CODED, JOINED),
    "writes outside of results": ('"else2.txt"', CODED, JOINED),
    "parameters that cannot be compared": ("{}", f"{CODED}, some={{1, 2}}", JOINED),
    "params.some is PosixPath": ("{}", f'{CODED}, some=Path("x.txt")', JOINED),
    "derives low from threads": ("{}", f"{CODED}, low=lambda wildcards, threads: threads", JOINED),
    "has shadow:": ("{}", CODED, 'shadow: "minimal"', JOINED),
    "runs scripts/join.R": ("{}", CODED, 'script: "scripts/join.R"'),
    "has a module called py": ("{}", *(one.replace("join", "odd") for one in (CODED, JOINED))),
}


def test_rules_without_records_are_refused_before_any_job_in_a_sentence_each(tmp_path):
    rules = []
    for place, (output, *lines) in enumerate(REFUSED.values()):
        own = output.replace("{}", f'f"{{RESULTS}}/{place}.txt"')
        rules.append("\n    ".join([f"rule odd{place}:", f"output: {own}", *lines]) + "\n")
    odd = {"scripts/odd.py": "import toy.py\n", "lib/toy/py.py": "", "scripts/join.R": ""}
    toy = foreign(tmp_path, more="\n\n".join(rules), **odd)
    names = [f"odd{place}" for place in range(len(REFUSED))]
    said = toy.run("--dry-run", *names, "reader", fails=True)
    for name, words in zip(names, REFUSED, strict=True):
        assert any(f"the rule {name} " in line and words in line for line in said.splitlines()), (
            name,
            words,
        )
    assert said.count("the rule ") == len(REFUSED)
    assert "Traceback" not in said
    assert "checks.py" not in said
    assert not (toy.directory / "results").exists()


@pytest.mark.parametrize(
    "code",
    [
        "exec(Path('x.txt').read_text())",
        "__import__(snakemake.params.low)",
        "Path('x.txt').read_text()",
        "snakemake.config['low']",
        "getattr(snakemake, 'con' + 'fig')",
        "eval('1')",
    ],
)
def test_what_fingerprints_do_not_see_is_refused(tmp_path, code):
    toy = foreign(tmp_path)
    toy.edit("scripts/join.py", "def compute():\n", f"def compute():\n    {code}\n")
    said = toy.run("--dry-run", fails=True)
    assert "join.py, line 11: " in said
    assert "fingerprints do not see what is there" in said


def test_two_workflows_in_one_snakefile_are_refused(tmp_path):
    more = """
module again:
    snakefile: "Again"
    prefix: "again"


use rule * from again as again_*
"""
    toy = foreign(tmp_path, more=more)
    again = (toy.directory / "Snakefile").read_text().replace(more, "").replace("MORE", "")
    (toy.directory / "Again").write_text(again)
    said = toy.run("--dry-run", fails=True)
    assert "one run owns one results directory" in said
    assert "run the two workflows one after the other" in said
