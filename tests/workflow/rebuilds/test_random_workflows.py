"""Random edits of random workflows on the engine, compared with runs from scratch.

Everything that a job could depend on is in its results: contents of inputs by their names,
settings, wildcards, values of modules. ``BURSTCAST_SEED`` and ``BURSTCAST_WORKFLOWS`` choose which
workflows, and how many.
"""

import logging
import os
import random
import shutil
import sys
import traceback
from pathlib import Path

import numpy  # noqa: F401 - imported here once, for all forks
import pytest
from snakemake import cli
from snakemake.script import PythonScript

from burstcast_workflow.harness import job  # noqa: F401

OPTIONS = (
    *("--cores", "1", "--scheduler", "greedy", "--max-checksum-file-size", "1000000000"),
    *("--rerun-triggers", "mtime", "params", "input", "software-env"),
)
SNAKEFILE = """
from pathlib import Path
from burstcast_workflow.snakemake_internals import all_files
from burstcast_workflow.start import checked_notes, follow
from burstcast_workflow.tracking.cache import tidy
from burstcast_workflow.tracking.code import Sources
from burstcast_workflow.tracking.results import digest
from burstcast_workflow.tracking.run import begin

ROOT = Path(str(workflow.current_basedir))
campaign = stages = None  # as the project's rules have one
notes = checked_notes("results") if workflow.is_main_process else None
sources = Sources(lambda name: ROOT / "scripts" / name, ROOT / "none", {"own": ()})

def of_script(script, **settings):
    return {"settings": settings, "code": sources.code(script, {})}


def begin_run():
    notes.stamp()
    begin("results", {}, sources.whole(), [], "")
"""
SCRIPT = """
import hashlib
from pathlib import Path
from burstcast_workflow.harness.job import JobSettings, at, job, write_text
{imports}

class Settings(JobSettings):
    pass

@job
def compute(*, settings: Settings, made: str, too: str, **files):
    contents = [
        [name, [Path(file).read_text() for file in ([given] if isinstance(given, str) else given)]]
        for name, given in sorted(files.items())
    ]
    values = [settings.value_of(name) for name in {names}]
    text = repr([contents, values, settings.identity, [{values}]])
    for path in (made, too):
        write_text(path, hashlib.sha256(text.encode()).hexdigest())
    with open("ran.txt", "a") as file:
        file.write(f"{{Path(made).parent.name}} ")
"""
MODULES = ("lib/pack/one.py", "lib/pack/two.py", "lib/pack/deep/three.py")


class Workflow:
    """A random workflow, which edits change: rules in a chain of files, scripts that import."""

    def __init__(self, seed):
        self.random = chance = random.Random(seed)
        self.sources = [f"source {place}" for place in range(3)]
        self.values = {module: chance.randrange(9) for module in MODULES}
        self.imports = {
            module: chance.sample(MODULES[:place], min(place, 1))
            for place, module in enumerate(MODULES)
        }
        self.comment, self.cases = 0, ["a", "b"]
        self.rules = []
        for place in range(chance.randint(3, 6)):
            inputs = self.some_inputs(place)
            settings = {
                f"x.p{number}": chance.randrange(9) for number in range(chance.randrange(4))
            }
            used = chance.sample(MODULES, chance.randrange(3))
            rule = {"inputs": inputs, "settings": settings, "modules": used, "script": 0}
            self.rules.append(rule)
        self.former = [self.texts()]

    def some_inputs(self, place):
        """Numbers of sources, which are negative, and of earlier rules."""
        numbers = list(range(-len(self.sources), place))
        return self.random.sample(numbers, self.random.randint(1, min(4, len(numbers))))

    def texts(self):
        """Texts of all files, by name."""
        texts = {f"data/s{place}.txt": text for place, text in enumerate(self.sources)}
        for package in ("lib/pack", "lib/pack/deep"):
            texts[f"{package}/__init__.py"] = ""
        for module, value in self.values.items():
            lines, values = imported(self.imports[module])
            total = " + ".join([str(value), *values])
            texts[module] = f"{lines}\n# {self.comment}\nVALUE = {total}\n"
        rules, everything = [], []
        for place, rule in enumerate(self.rules):
            lines, values = imported(rule["modules"])
            names = sorted(rule["settings"])
            script = SCRIPT.format(imports=lines, names=names, values=", ".join(values))
            texts[f"scripts/s{place}.py"] = f"# {self.comment}\n{script}{rule['script'] or ''}\n"
            # Snakemake sees which inputs a job has, and neither their names nor their order
            files = [self.file(place) for place in sorted(rule["inputs"])]
            inputs = f"in0={files[::2]}, in1={files[1::2]}"
            # data files count by their contents, as parameters
            data = [name for name in files if name.startswith("data/")]
            settings = f"**{rule['settings']}, contents=[digest(path) for path in {data}]"
            rules.append(
                f"rule r{place}:\n    input: {inputs}\n"
                f"    output: made='results/{{case}}/r{place}.txt',\n"
                f"        too='results/{{case}}/t{place}.txt'\n"
                f"    log: 'results/logs/{{case}}{place}.log'\n"
                f"    params: **of_script('s{place}.py', {settings})\n"
                f"    script: 'scripts/s{place}.py'\n"
            )
            everything += [f"results/{case}/r{place}.txt" for case in self.cases]
        texts["Snakefile"] = (
            SNAKEFILE
            + f"rule all:\n    input: lambda wildcards: all_files(workflow, {everything})\n\n"
            + "\n".join(rules)
            + "\nfollow(workflow, notes, begin_run)\n"
        )
        return texts

    def file(self, number):
        return f"data/s{-number - 1}.txt" if number < 0 else f"results/{{case}}/r{number}.txt"

    def edit(self, kind, directory):
        """Change something of a kind."""
        chance, rule = self.random, self.random.choice(self.rules)
        if kind == "source":
            self.sources[chance.randrange(3)] = f"another {chance.randrange(4)}"
        elif kind == "module":
            self.values[chance.choice(MODULES)] = chance.randrange(9)
        elif kind == "setting" and rule["settings"]:
            rule["settings"][chance.choice(list(rule["settings"]))] = chance.randrange(9)
        elif kind == "more settings":
            rule["settings"][f"x.p{chance.randrange(6)}"] = chance.randrange(9)
        elif kind == "imports":
            rule["modules"] = chance.sample(MODULES, chance.randrange(3))
        elif kind == "inputs":
            rule["inputs"] = self.some_inputs(self.rules.index(rule))
        elif kind == "script":
            rule["script"] = f"\nCONSTANT = {chance.randrange(9)}"
        elif kind == "comment":
            self.comment += 1
        elif kind == "cases":
            self.cases = chance.choice([["a"], ["a", "b"], ["b", "c"]])
        elif kind in ("delete", "touch"):
            results = sorted(directory.glob("results/[abc]/*.txt"))
            for path in chance.sample(results, min(2, len(results))):
                path.unlink() if kind == "delete" else path.touch()
        elif kind == "touch a source":
            (directory / f"data/s{chance.randrange(3)}.txt").touch()
        elif kind == "older source":  # in the place of another one
            number = chance.randrange(3)
            self.sources[number] = f"another {chance.randrange(4)}"
            path = directory / f"data/s{number}.txt"
            path.write_text(self.sources[number])
            os.utime(path, (1e9, 1e9))
        elif kind == "save":
            shutil.rmtree(directory / "saved", ignore_errors=True)
            shutil.copytree(directory / "results", directory / "saved")
        elif kind == "restore" and (directory / "saved").exists():
            keep = chance.random() < 0.5  # all results, or over those that are there
            if not keep:
                shutil.rmtree(directory / "results")
            shutil.copytree(directory / "saved", directory / "results", dirs_exist_ok=True)
        elif kind == "forget":
            shutil.rmtree(directory / ".snakemake", ignore_errors=True)
        elif kind == "lose records":
            for record in sorted((directory / ".snakemake/metadata").rglob("*")):
                if record.is_file() and chance.random() < 0.3:
                    os.truncate(record, 0)


KINDS = (
    *("source", "module", "setting", "more settings", "imports", "inputs", "script", "comment"),
    *("cases", "delete", "touch", "touch a source", "back", "back", "forget"),
    *("older source", "save", "restore", "restore", "lose records"),
)
WITHOUT_EFFECT = {"comment", "delete", "touch", "touch a source", "forget", "save", "lose records"}


def imported(modules):
    """Lines that import modules, and the names of their values (other ways: test_tracking_code)."""
    names = [".".join(Path(path).with_suffix("").parts[1:]) for path in modules]
    values = [f"{name.rpartition('.')[2]}_value" for name in names]
    lines = [
        f"from {name} import VALUE as {value}" for name, value in zip(names, values, strict=True)
    ]
    return "\n".join(lines), values


def write(texts, directory):
    """Write what is not there, with new times; remove what belongs to no workflow."""
    for name, text in texts.items():
        path = directory / name
        path.parent.mkdir(parents=True, exist_ok=True)
        if not path.exists() or path.read_text() != text:
            path.write_text(text)


def execute_script(self, fname, edit=False):
    """Run a script as Snakemake does, in a fork instead of a new process."""
    child = os.fork()
    if child == 0:
        # a thread of Snakemake's may hold the locks of its streams, which are left as they are
        _streams = sys.stdout, sys.stderr
        sys.stdout, sys.stderr = (os.fdopen(os.dup(number), "w", buffering=1) for number in (1, 2))
        logging.root.handlers.clear()  # of other tests, whose streams may be closed
        try:
            sys.argv = [fname]
            sys.dont_write_bytecode = True
            exec(
                compile(Path(fname).read_text(), fname, "exec"),
                {"__name__": "__main__", "__file__": fname},
            )
        except SystemExit as leave:
            os._exit(int(bool(leave.code)))
        except BaseException:
            traceback.print_exc()
            os._exit(1)
        sys.stdout.flush()
        os._exit(0)
    assert os.waitpid(child, 0)[1] == 0


def run(directory, *arguments, cache=""):
    """Run the workflow in a fork: jobs that computed, and its output if it failed."""
    ran, log = directory / "ran.txt", directory / "output.txt"
    ran.unlink(missing_ok=True)
    child = os.fork()
    if child == 0:
        os.chdir(directory)
        file = os.open(log, os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
        for number in (1, 2):
            os.dup2(file, number)
        sys.stdout, sys.stderr = os.fdopen(1, "w"), os.fdopen(2, "w")
        os.environ["BURSTCAST_CACHE"] = cache
        sys.argv = ["snakemake", *arguments]
        sys.dont_write_bytecode = True
        sys.path.insert(0, str(directory / "lib"))
        PythonScript.execute_script = execute_script
        status = 1
        try:
            cli.main([*OPTIONS, *arguments])
        except SystemExit as leave:
            status = int(bool(leave.code))
        except BaseException:
            traceback.print_exc()
        sys.stdout.flush()
        os._exit(status)
    status = os.waitpid(child, 0)[1]
    return ran.read_text().split() if ran.exists() else [], log.read_text() if status else ""


def contents(directory, texts):
    """All results of the workflow, by name."""
    wanted = eval(texts["Snakefile"].partition("all_files(workflow, ")[2].partition(")\n")[0])
    files = wanted + [name.replace("/r", "/t") for name in wanted]
    return {name: (directory / name).read_text() for name in files}


def trial(seed, edits, place):
    """Edit a random workflow; yield what was done, and what is wrong, or nothing.

    ``edits``: kinds of edits before each run; None: some by chance.
    """
    workflow, directory, cache = Workflow(seed), place / "project", str(place / "cache")
    states = [workflow.texts()]
    write(states[0], directory)
    yield ["first"], run(directory, cache=cache)[1]
    for kinds in edits:
        kinds = kinds or workflow.random.choices(KINDS, k=workflow.random.choice([1, 1, 2]))
        for kind in kinds:
            workflow.edit(kind, directory)
        texts = workflow.texts()
        if back := "back" in kinds:
            texts = workflow.random.choice(states)
        write(texts, directory)
        computed, failure = run(directory, cache=cache)
        if failure:
            yield kinds, failure
            continue
        scratch = place / "scratch"
        shutil.rmtree(scratch, ignore_errors=True)
        write(texts, scratch)
        problem = run(scratch)[1]
        made = {} if problem else contents(directory, texts)
        expected = {} if problem else contents(scratch, texts)
        if wrong := [name for name in expected if made[name] != expected[name]]:
            problem = f"unlike a run from scratch: {wrong}"
        elif back and computed and kinds == ["back"]:
            problem = f"computed on the way back: {computed}"
        elif set(kinds) <= WITHOUT_EFFECT and computed:
            problem = f"computed in vain: {computed}"
        elif again := run(directory, cache=cache)[0]:
            problem = f"runs twice: {again}"
        if back:  # and here again
            write(workflow.texts(), directory)
            problem = problem or run(directory, cache=cache)[1]
        states.append(workflow.texts())
        yield kinds, problem


SEED = int(os.environ.get("BURSTCAST_SEED", "0"))
WORKFLOWS = int(os.environ.get("BURSTCAST_WORKFLOWS", "20"))


def check(seed, edits, place):
    done = []
    for kinds, problem in trial(seed, edits, place):
        done.append(kinds)
        assert not problem, (seed, done, problem)
    assert len(done) == len(edits) + 1


def test_some_edits_of_a_workflow_give_the_results_of_a_run_from_scratch(tmp_path):
    edits = [["save"], ["module"], ["restore"], ["back"], ["forget"], ["older source"]]
    check(1, [*edits, ["lose records"], ["delete", "comment"]], tmp_path)


@pytest.mark.long
@pytest.mark.parametrize("seed", range(SEED, SEED + WORKFLOWS))
def test_random_edits_give_the_results_of_a_run_from_scratch(seed, tmp_path):
    check(seed, [None] * 10, tmp_path)
