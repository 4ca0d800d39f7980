"""What `start`, `run_job` and `check_rules` do for a workflow of another project.

It is run where burstcast cannot be imported.
"""

import json
import os
import shutil
import subprocess
import sys
import time
from collections import Counter
from hashlib import sha256
from pathlib import Path

import pytest

import snaketrust
from snaketrust.files import digest

HERE = Path(__file__).parent
BLOCK = """
import sys
for name in ("burstcast", "burstcast_workflow"):
    sys.modules[name] = None
"""
OPTIONS = ("--cores", "1", "--rerun-triggers", "mtime", "params", "input", "software-env")


class Toy:
    """A copy of the toy, finished or not, and what Snakemake does in it."""

    def __init__(self, directory, toy=HERE / "toy"):
        self.directory = directory / "toy"
        shutil.copytree(toy, self.directory)
        place = directory / "path"
        place.mkdir()
        (place / "sitecustomize.py").write_text(BLOCK)
        (place / "snaketrust").symlink_to(Path(snaketrust.__path__[0]))
        path = f"{place}{os.pathsep}{self.directory / 'lib'}"
        self.environment = {**os.environ, "PYTHONPATH": path, "SNAKETRUST_RUN": ""}

    def run(self, *arguments, fails=False, **variables):
        """Rules of the jobs that ran, with their numbers; what is said, where the run fails."""
        done = subprocess.run(
            [sys.executable, "-m", "snakemake", *OPTIONS, *arguments],
            cwd=self.directory,
            env={**self.environment, **variables},
            capture_output=True,
            text=True,
        )
        said = done.stdout + done.stderr
        assert (done.returncode != 0) == fails, said
        if fails:
            return said
        return Counter(
            line.split()[1].rstrip(":")
            for line in said.splitlines()
            if line.startswith(("rule ", "localrule ")) and line.endswith(":") and "," not in line
        )

    def write(self, name, text):
        (self.directory / name).write_text(text)

    def edit(self, name, old, new):
        path = self.directory / name
        text = path.read_text()
        assert old in text
        path.write_text(text.replace(old, new))

    def total(self):
        return int((self.directory / "results" / "total.txt").read_text())


EVERYTHING = {"draw": 2, "double": 2, "total": 1}


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """The toy, run once."""
    toy = Toy(tmp_path_factory.mktemp("made"))
    assert toy.run() == EVERYTHING
    assert toy.total() == 6
    return toy


@pytest.fixture
def toy(made, tmp_path):
    """A copy of the toy that was run, in another directory."""
    return Toy(tmp_path, made.directory)


def test_what_is_finished_stays_and_may_be_moved(toy):
    assert toy.run() == {}
    shutil.rmtree(toy.directory / ".snakemake")  # the records belong to the results
    assert toy.run() == {}
    (toy.directory / "results").rename(toy.directory / "moved")
    toy.edit("config.yaml", "results: results", "results: moved")
    assert toy.run() == {}


@pytest.mark.parametrize(
    ("path", "old", "new", "jobs", "total"),
    [
        ("lib/toy/scaling.py", "number * factor", "number + factor", {"double": 2, "total": 1}, 7),
        ("lib/toy/texts.py", "{number}", "{number + 1}", EVERYTHING, 10),
        ("lib/toy/texts.py", "Text of", "Words for", {}, 6),
        ("lib/toy/scaling.py", "    return", "    # a comment\n    return", {}, 6),
        ("scripts/total.py", "sum(", "10 * sum(", {"total": 1}, 60),
        ("config.yaml", "two: 2", "two: 5", {"draw": 1, "double": 1, "total": 1}, 12),
        ("config.yaml", "factor: 2", "factor: 3", {"double": 2, "total": 1}, 9),
    ],
)
def test_an_edit_runs_the_jobs_that_use_it(toy, path, old, new, jobs, total):
    toy.edit(path, old, new)
    assert toy.run() == jobs
    assert toy.total() == total
    assert toy.run() == {}


def test_some_of_the_rules_run_on_the_results_of_the_others(toy):
    toy.edit("lib/toy/scaling.py", "number * factor", "number + factor")
    assert toy.run("--allowed-rules", "double", "total") == {"double": 2, "total": 1}
    assert toy.total() == 7


def test_what_is_damaged_or_exchanged_is_made_again(toy):
    result = toy.directory / "results" / "doubled" / "one.txt"
    state = result.stat()
    result.write_text("7\n")
    os.utime(result, ns=(state.st_atime_ns, state.st_mtime_ns))  # same size, same time
    assert toy.run() == {"double": 1, "total": 1}
    assert toy.total() == 6
    one, two = (toy.directory / "results" / "drawn" / f"{name}.txt" for name in ("one", "two"))
    one.rename(one.with_suffix(".txt.x"))
    two.rename(one)
    one.with_suffix(".txt.x").rename(two)
    assert toy.run() == EVERYTHING
    assert toy.total() == 6
    (toy.directory / "results" / ".records" / "total.txt.json").unlink()
    assert toy.run() == {"total": 1}


def test_a_deleted_intermediate_stays_away_until_it_is_needed(toy):
    drawn = toy.directory / "results" / "drawn" / "one.txt"
    drawn.unlink()
    assert toy.run() == {}
    assert not drawn.exists()
    toy.edit("config.yaml", "one: 1", "one: 4")
    assert toy.run() == {"draw": 1, "double": 1, "total": 1}
    assert toy.total() == 12


def test_another_directory_takes_results_from_the_cache(toy, tmp_path):
    shelf = {"TOY_CACHE": str(tmp_path / "cache")}
    toy.edit("config.yaml", "factor: 2", "factor: 5")
    toy.run(**shelf)
    (entry, _) = (tmp_path / "cache" / "entries").glob("*/*/0")
    entry.write_text("7\n")  # one of the two is damaged
    toy.edit("config.yaml", "results: results", "results: others")
    toy.run(**shelf)
    assert (toy.directory / "others" / "total.txt").read_text() == "15\n"
    touched = [path.stat().st_mtime_ns for path in (tmp_path / "cache").glob("entries/*/*")]
    assert len(touched) == 2
    toy.edit("lib/toy/scaling.py", "number * factor", "number * factor + 1")
    toy.run(**shelf)
    assert len([*(tmp_path / "cache").glob("entries/*/*")]) == 4


def test_code_that_is_edited_while_a_job_waits_fails_it(toy):
    toy.edit("config.yaml", "one: 1", "one: 3")
    # an edit by the first of the jobs that run
    toy.edit(
        "scripts/draw.py",
        "def compute():\n",
        "def compute():\n    scaling = Path('lib/toy/scaling.py')\n"
        "    scaling.write_text(scaling.read_text().replace('*', '+'))\n",
    )
    assert "scaling changed after the workflow was planned" in toy.run(fails=True)
    toy.edit("scripts/draw.py", "scaling.read_text().replace('*', '+')", "scaling.read_text()")
    toy.run()
    assert toy.total() == (3 + 2) + (2 + 2)


def test_a_job_of_a_cluster_does_what_was_planned(toy):
    claim = json.loads((toy.directory / "results" / ".run.json").read_bytes())
    assert "note" not in claim["config"]
    run = {"SNAKETRUST_RUN": f"{claim['token']} results"}
    on_a_node = (
        *("--mode", "remote", "--nolock", "--ignore-incomplete", "--force", "--no-hooks"),
        *("--target-jobs", "double:case=one", "--allowed-rules", "double"),
    )
    toy.edit("config.yaml", "factor: 2", "factor: 3")
    doubled = toy.directory / "results" / "doubled" / "one.txt"
    doubled.unlink()
    assert toy.run(*on_a_node, **run) == {"double": 1}
    assert doubled.read_text() == "2\n"
    # submitted again, it keeps what it has made, unless an input is another one now
    inode = doubled.stat().st_ino
    assert toy.run(*on_a_node, **run) == {"double": 1}
    assert doubled.stat().st_ino == inode
    drawn = toy.directory / "results" / "drawn" / "one.txt"
    record = toy.directory / "results" / ".records" / "drawn" / "one.txt.json"
    record.write_text(record.read_text().replace(digest(drawn), sha256(b"5\n").hexdigest()))
    drawn.write_text("5\n")
    toy.run(*on_a_node, **run)
    assert doubled.read_text() == "10\n"
    toy.edit("lib/toy/scaling.py", "number * factor", "number + factor")
    said = toy.run(*on_a_node, fails=True, **run)
    assert "toy.scaling changed after the workflow was planned" in said
    assert "does not reach jobs" in toy.run(*on_a_node, fails=True)


def test_a_result_of_a_machine_whose_clock_is_ahead_settles(toy):
    drawn = toy.directory / "results" / "drawn" / "one.txt"
    ahead = time.time() + 3600
    os.utime(drawn, (ahead, ahead))
    toy.edit("config.yaml", "factor: 2", "factor: 3")
    assert toy.run() == {"double": 2, "total": 1}
    assert toy.total() == 9
    assert toy.run() == {}


def test_what_nothing_makes_is_an_error(toy):
    toy.edit(
        "Snakefile",
        'drawn/{{case}}.txt",\n    output:\n        doubled',
        'else/{{case}}.txt",\n    output:\n        doubled',
    )
    (toy.directory / "results" / "else").mkdir()
    for name in ("one", "two"):
        (toy.directory / "results" / "else" / f"{name}.txt").write_text("1\n")
    for option in ((), ("--dry-run",)):
        said = toy.run(*option, fails=True)
        assert "results/else/one.txt is there, but nothing makes it, as 1 others" in said


def test_a_second_run_for_the_same_results_is_refused(toy):
    claim = toy.directory / "results" / ".run.json"
    alive = json.loads(claim.read_bytes())
    ticks = Path(f"/proc/{os.getpid()}/stat").read_text().rpartition(")")[2].split()[19]
    claim.write_text(json.dumps({**alive, "process": os.getpid(), "started": ticks}))
    toy.edit("config.yaml", "one: 1", "one: 3")
    assert f"another run, process {os.getpid()}, is at work in results" in toy.run(fails=True)
    assert toy.run("--dry-run")  # one may plan


def test_an_overtaken_run_removes_nothing_more(toy):
    toy.edit("config.yaml", "one: 1, two: 2", "one: 3, two: 4")
    toy.edit(
        "scripts/draw.py",
        "def compute():\n",
        "def compute():\n    Path('results/.run.json').write_text('{\"token\": \"newer\"}')\n",
    )
    drawn = toy.directory / "results" / "drawn"
    before = {path.name: path.read_text() for path in drawn.iterdir()}
    assert "results belongs to a newer run now" in toy.run("--keep-going", fails=True)
    after = {path.name: path.read_text() for path in drawn.iterdir()}
    assert len(before.items() & after.items()) == 1


def test_another_copy_of_the_packages_is_refused(toy, tmp_path):
    other = tmp_path / "other" / "toy"
    shutil.copytree(toy.directory / "lib" / "toy", other)
    path = toy.environment["PYTHONPATH"].replace(str(toy.directory / "lib"), str(other.parent))
    assert "another copy" in toy.run(fails=True, PYTHONPATH=path)


# -- what any workflow may have, and what is refused -----------------------------------------------


def test_the_same_file_twice_settles(toy):
    toy.edit("Snakefile", 'case=config["numbers"])', 'case=[*config["numbers"], "one"])')
    assert toy.run() == {"total": 1}
    assert toy.total() == 8
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


@pytest.fixture
def unchecked(tmp_path):
    """The toy as a project without tests that keep out what fingerprints cannot see."""
    toy = Toy(tmp_path)
    toy.edit("Snakefile", "    checked=True,\n", "")
    toy.edit("scripts/double.py", 'os.environ.get("TOY_CACHE")', "None")
    return toy


def test_what_a_checkpoint_finds_is_made_once(unchecked):
    unchecked.edit("Snakefile", "rule draw:", f"{CHECKPOINT}\n\nrule draw:")
    unchecked.edit("config.yaml", "factor: 2", "low: 1\nhigh: 2\nfactor: 2")
    unchecked.write("scripts/write.py", WRITE)
    target = "--nocolor", "results/gathered.txt"
    assert unchecked.run(*target) == {"part": 1, "gather": 1}
    assert unchecked.run(*target) == {}
    unchecked.edit("config.yaml", "low: 1", "low: 3")
    assert unchecked.run(*target) == {"part": 2, "gather": 1}
    assert unchecked.run(*target) == {}
    gathered = unchecked.directory / "results" / "gathered.txt"
    assert gathered.read_text().startswith("2 2 2 ['results/part0.txt'")
    unchecked.edit("config.yaml", "high: 2", "high: 5")
    assert unchecked.run(*target) == {"part": 3, "gather": 1}
    assert gathered.read_text().startswith("5 5 5 ")


CODED, TOTAL = 'params: code=sources.fingerprint("total.py")', 'script: "scripts/total.py"'
READER = (
    'rule reader:\n    input: f"{RESULTS}/3.txt"\n    output: "read.txt"\n    shell: "cat {input}"'
)
# What is said of a rule: its output, with {} for a file of its own in the results, and other lines.
REFUSED = {
    "shell:": ("{}", 'shell: "touch {output}"'),
    "run:": ("{}", "run: Path(output[0]).touch()"),
    "the output directory()": ("directory({})", CODED, TOTAL),
    "the output pipe()": ("pipe({})", CODED, f"{TOTAL}\n\n\n{READER}"),
    "the output touch()": ("touch({})", CODED, TOTAL),
    "the output ensure()": ("ensure({}, non_empty=True)", CODED, TOTAL),
    "no parameter code": ("{}", TOTAL),
    "but its code is the fingerprint of total.py": ("{}", CODED, 'script: "scripts/draw.py"'),
    "elsewhere": ('{}, "else.txt"', CODED, TOTAL),
    "writes outside of results": ('"else2.txt"', CODED, TOTAL),
    "parameters that cannot be compared": ("{}", f"{CODED}, some={{1, 2}}", TOTAL),
    "params.some is PosixPath": ("{}", f'{CODED}, some=Path("x.txt")', TOTAL),
    "derives low from threads": ("{}", f"{CODED}, low=lambda wildcards, threads: threads", TOTAL),
    "has shadow:": ("{}", CODED, 'shadow: "minimal"', TOTAL),
    "runs scripts/total.R": ("{}", CODED, 'script: "scripts/total.R"'),
    "has a module called py": ("{}", *(one.replace("total", "odd") for one in (CODED, TOTAL))),
}


def test_check_rules_refuses_rules_without_records_before_any_job_in_a_sentence_each(unchecked):
    rules = []
    for place, (output, *lines) in enumerate(REFUSED.values()):
        own = output.replace("{}", f'f"{{RESULTS}}/{place}.txt"')
        rules.append("\n    ".join([f"rule odd{place}:", f"output: {own}", *lines]) + "\n")
    unchecked.edit("Snakefile", "rule draw:", "\n\n".join([*rules, "rule draw:"]))
    for name, text in {"scripts/odd.py": "import toy.py\n", "lib/toy/py.py": ""}.items():
        unchecked.write(name, text)
    unchecked.write("scripts/total.R", "")
    names = [f"odd{place}" for place in range(len(REFUSED))]
    said = unchecked.run("--dry-run", *names, "reader", fails=True)
    for name, words in zip(names, REFUSED, strict=True):
        lines = [line for line in said.splitlines() if f"the rule {name} " in line]
        assert any(words in line for line in lines), (name, words)
    assert said.count("the rule ") == len(REFUSED)
    assert "Traceback" not in said
    assert "checks.py" not in said
    assert not (unchecked.directory / "results").exists()


@pytest.mark.parametrize(
    "code",
    [
        *("exec(Path('x.txt').read_text())", "__import__(snakemake.params.low)", "eval('1')"),
        *("Path('x.txt').read_text()", "snakemake.config['low']"),
        "getattr(snakemake, 'con' + 'fig')",
    ],
)
def test_what_fingerprints_do_not_see_is_refused(unchecked, code):
    unchecked.edit("scripts/total.py", "def compute():\n", f"def compute():\n    {code}\n")
    said = unchecked.run("--dry-run", fails=True)
    assert "total.py, line 7: " in said
    assert "fingerprints do not see what is there" in said


def test_two_workflows_in_one_snakefile_are_refused(unchecked):
    snakefile = (unchecked.directory / "Snakefile").read_text()
    unchecked.write("Again", snakefile)
    more = 'module again:\n    snakefile: "Again"\n    prefix: "again"\n\n\n'
    unchecked.write("Snakefile", f"{snakefile}\n\n{more}use rule * from again as again_*\n")
    said = unchecked.run("--dry-run", fails=True)
    assert "one run owns one results directory" in said
    assert "run the two workflows one after the other" in said
