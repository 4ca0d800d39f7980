"""Random edits of random workflows of other projects, compared with runs from scratch.

Everything that a job could depend on is in its result: names, order and content of inputs, names,
order and values of parameters, wildcards, names of outputs, values of modules.
``SNAKETRUST_SEED`` and ``SNAKETRUST_WORKFLOWS`` choose which workflows, and how many.
"""

import os
import random
import shutil
import sys
import threading
import traceback
from dataclasses import dataclass, field
from pathlib import Path

import numpy  # noqa: F401 - imported here once, for all forks
import pytest
import smart_open  # noqa: F401
from snakemake import cli
from snakemake.script import PythonScript

from snaketrust import job, start  # noqa: F401

TRIGGERS = "--rerun-triggers", "mtime", "params", "input", "software-env"
OPTIONS = ("--cores", "1", "--scheduler", "greedy", *TRIGGERS)

SNAKEFILE = """
from pathlib import Path
import numpy as np
from snaketrust.project import Project
from snaketrust.start import start

configfile: "config.yaml"

ROOT = Path(str(workflow.current_basedir))
PROJECT = Project(root=ROOT, scripts=ROOT / "scripts", sources=ROOT / "lib", packages=("pack",))
started = start(workflow, PROJECT, lambda config: config["results"], lambda: dict(config))
sources, RESULTS = started.sources, started.config["results"]
"""

SCRIPT = """
import hashlib
from pathlib import Path
IMPORTS
from snaketrust.job import run_job


def compute():
    def content(files):
        return [Path(path).read_text() for path in ([files] if isinstance(files, str) else files)]

    code = snakemake.params.code
    told = [
        [(name, content(files)) for name, files in snakemake.input.items()],
        [isinstance(files, str) for _, files in snakemake.input.items()],
        content([*snakemake.input]),
        [repr(value) for value in snakemake.params if value is not code],
        [name for name, _ in snakemake.params.items()],
        sorted(snakemake.wildcards.items()),
        VALUES,
    ]
    for place, path in enumerate(snakemake.output):
        names = [name for name, _ in snakemake.output.items()]
        said = repr([told, names, place])
        Path(path).write_text(hashlib.sha256(said.encode()).hexdigest())
    with open("ran.txt", "a") as file:
        file.write("/".join(Path(snakemake.output[0]).parts[-2:]) + "\\n")


run_job(snakemake, compute)
"""


KINDS = (
    *("source", "order", "names", "value", "exchange", "rename", "module", "way"),
    *("input", "case", "output", "script"),
    *("spelling", "style", "comment", "threads", "results"),
)
"""What is edited; the last five mean the same."""


@dataclass
class Module:
    """A module with a value: beside the scripts, or below ``lib``."""

    path: str
    value: int
    imports: list["Module"] = field(default_factory=list)
    ways: list[int] = field(default_factory=list)
    comment: int = 0

    @property
    def name(self):
        return ".".join(Path(self.path).with_suffix("").parts[1:]).removesuffix(".__init__")

    def text(self):
        lines, values = imported(self.imports, self.ways)
        total = " + ".join([str(self.value), *values])
        return f"# {self.comment}\n{lines}\n\ndef value():\n    return {total}\n"


def imported(modules, ways):
    """Lines that import modules in several ways, and expressions of their values."""
    lines, values = [], []
    for place, (module, way) in enumerate(zip(modules, ways, strict=True)):
        package, _, last = module.name.rpartition(".")
        if way == 0:
            lines.append(f"import {module.name}")
            values.append(f"{module.name}.value()")
        elif way == 1:
            lines.append(f"from {module.name} import value as value{place}")
            values.append(f"value{place}()")
        elif way == 2:
            lines.append(
                f"import importlib\nlate{place} = importlib.import_module('{module.name}')"
            )
            values.append(f"late{place}.value()")
        elif way == 3 and package:
            lines.append(f"from {package} import {last} as part{place}")
            values.append(f"part{place}.value()")
        else:
            lines.append(
                f"def inside{place}():\n    import {module.name} as it\n    return it.value()"
            )
            values.append(f"inside{place}()")
    return "\n".join(lines), values


@dataclass
class Rule:
    """A rule; files are numbers of sources (negative) or of rules; names may be None."""

    name: str
    wild: bool
    inputs: list[list]  # name, and a list of files, or a file
    outputs: list[str | None]  # names
    params: list[list]  # name and value
    script: int
    derived: bool
    threads: int = 1


class Workflow:
    """A random workflow, which edits change."""

    def __init__(self, seed):
        self.random = chance = random.Random(seed)
        self.results, self.cases, self.style = "results", ["a", "b"], 0
        self.sources = {-1 - place: f"source {place}" for place in range(chance.randint(2, 4))}
        self.spelling = dict.fromkeys(self.sources, 0)
        paths = [f"scripts/helper{place}.py" for place in range(chance.randint(1, 3))]
        paths += ["lib/pack/__init__.py", "lib/pack/one.py", "lib/pack/two.py"]
        paths += ["lib/more/__init__.py", "lib/more/deep.py", "lib/single.py", "lib/bare/part.py"]
        chance.shuffle(paths)
        self.modules = []
        for path in paths:
            known = [one for one in self.modules if not one.path.endswith("__init__.py")]
            used = chance.sample(known, min(len(known), chance.choice([0, 0, 1, 2])))
            used = [] if path.endswith("__init__.py") else used
            ways = [chance.randrange(5) for _ in used]
            self.modules.append(Module(path, chance.randrange(10, 99), used, ways))
        self.scripts = []
        for _ in range(chance.randint(1, 4)):
            used = chance.sample(self.modules, chance.randint(1, 3))
            self.scripts.append([used, [chance.randrange(5) for _ in used], 0])
        self.rules = []
        for place in range(chance.randint(3, 8)):
            files = [*self.sources, *range(place)]
            used = [chance.choice(files) for _ in range(chance.randint(1, 4))]
            inputs, names = [], iter(["x", "y", "z", "w"])
            while used:
                count = chance.choice([0, 0, 1, 2])
                group, used = used[: count or 1], used[count or 1 :]
                name = next(names) if chance.random() < 0.6 else None
                inputs.append([name, group if count and name else group[0]])
                if count and name is None:
                    inputs += [[None, one] for one in group[1:]]
            outputs = chance.choice(
                [[None], ["made"], [None, None], ["made", "too"], [None, "too"]]
            )
            params = [[None, self.value()] for _ in range(chance.choice([0, 0, 1]))]
            params += [
                [name, self.value()] for name in ("low", "high", "some")[: chance.randrange(4)]
            ]
            wild, script = chance.random() < 0.4, chance.randrange(len(self.scripts))
            derived = chance.random() < 0.3
            self.rules.append(Rule(f"r{place}", wild, inputs, [*outputs], params, script, derived))

    def value(self, depth=0):
        """A random value of plain data."""
        chance = self.random
        kind = chance.randrange(8 if depth < 2 else 5)
        if kind < 5:
            kinds = chance.randint(-9, 9), chance.random(), "text", None, True
            return kinds[kind]
        items = [self.value(depth + 1) for _ in range(chance.randrange(4))]
        if kind == 5:
            keys = [chance.choice([place, f"k{place}"]) for place in range(len(items))]
            return dict(zip(keys, items, strict=True))
        return items

    # -- what Snakemake reads ----------------------------------------------------------------------

    def texts(self, directory):
        """Texts of all files, by name."""
        texts = {"config.yaml": f"results: {self.results.format(directory=directory)}\n"}
        texts |= {f"data/s{-one}.txt": text for one, text in self.sources.items()}
        texts |= {module.path: module.text() for module in self.modules}
        for place, (used, ways, comment) in enumerate(self.scripts):
            lines, values = imported(used, ways)
            text = SCRIPT.replace("IMPORTS", lines).replace("VALUES", f"[{', '.join(values)}]")
            texts[f"scripts/script{place}.py"] = f"# {comment}\n{text}"
        texts["Snakefile"] = SNAKEFILE + "\n".join([self.all(), *self.ruled(directory)])
        return texts

    def write(self, directory):
        """Write all files whose text is not there."""
        for name, text in self.texts(directory).items():
            path = directory / name
            path.parent.mkdir(parents=True, exist_ok=True)
            if not path.exists() or path.read_text() != text:
                state = path.stat() if path.exists() and path.suffix == ".py" else None
                path.write_text(text)
                if state:  # Python alone would run what it had compiled
                    os.utime(path, ns=(state.st_atime_ns, state.st_mtime_ns))

    def made(self, rule):
        """Names of the files of a rule, from the results directory."""
        cases = self.cases if rule.wild else ["all"]
        return [
            f"{rule.name}/{case}{place}.txt" for case in cases for place in range(len(rule.outputs))
        ]

    def all(self):
        files = [f'f"{{RESULTS}}/{name}"' for rule in self.rules for name in self.made(rule)]
        return f"rule all:\n    input: {', '.join(files)}\n"

    def file(self, number, consumer, directory):
        """Expressions of the files that a number stands for."""
        if number < 0:
            path = f"data/s{-number}.txt"
            return [repr([path, f"./{path}", f"{directory}/{path}"][self.spelling[number]])]
        rule = self.rules[number]
        if rule.wild and consumer.wild:
            return [f'f"{{RESULTS}}/{rule.name}/{{{{case}}}}0.txt"']
        return [f'f"{{RESULTS}}/{name}"' for name in self.made(rule) if name.endswith("0.txt")]

    def ruled(self, directory):
        for rule in self.rules:
            unnamed, known = [], []
            for name, files in rule.inputs:
                one = not isinstance(files, list)
                found = [self.file(file, rule, directory) for file in ([files] if one else files)]
                flat = [path for paths in found for path in paths]
                if name is None:
                    unnamed += flat
                else:
                    listed = f"[{', '.join(flat)}]"
                    known.append(f"{name}={flat[0] if one and len(flat) == 1 else listed}")
            case = "{{case}}" if rule.wild else "all"
            outputs = [
                f'f"{{RESULTS}}/{rule.name}/{case}{at}.txt"' for at in range(len(rule.outputs))
            ]
            outputs = [f"{n}={o}" if n else o for n, o in zip(rule.outputs, outputs, strict=True)]
            params = [f"{f'{name}=' if name else ''}{self.spelt(one)}" for name, one in rule.params]
            if rule.derived:
                params.append("derived=lambda wildcards, input: [Path(one).name for one in input]")
            script = f"script{rule.script}.py"
            params.append(f'code=sources.fingerprint("{script}")')
            yield (
                f"rule {rule.name}:\n    input: {', '.join(unnamed + known)}\n"
                f"    output: {', '.join(outputs)}\n    params: {', '.join(params)}\n"
                f"    threads: {rule.threads}\n    resources: mem_mb={rule.threads * 100}\n"
                f'    script: "scripts/{script}"\n'
            )

    def spelt(self, value):
        """A value as Python: the style chooses among the forms that mean the same."""
        style = random.Random(f"{self.style} {value!r}").randrange(3) if self.style else 0
        if type(value) is dict:
            items = [f"{key!r}: {self.spelt(one)}" for key, one in value.items()]
            return f"{{{', '.join(items[::-1] if style else items)}}}"
        if type(value) is list:
            items = ", ".join(self.spelt(one) for one in value)
            return f"({items}{',' * (len(value) == 1)})" if style else f"[{items}]"
        if type(value) is int:
            return [repr(value), f"{value}.0", f"np.int64({value})"][style]
        if type(value) is float:
            return f"np.float64({value!r})" if style else repr(value)
        return repr(value)

    # -- edits: each says whether it may change anything -------------------------------------------

    def edit(self, kind=""):
        """Change something; return what, and whether results may change by it."""
        chance = self.random
        rule = chance.choice(self.rules)
        kind = kind or chance.choice(KINDS)
        if kind == "source":
            place = chance.choice([*self.sources])  # no two are alike: their order would not tell
            self.sources[place] = f"source {place}, {chance.randrange(9)}"
        elif kind == "order":
            chance.shuffle(rule.inputs)
        elif kind == "names":
            places = [place for place, (name, _) in enumerate(rule.inputs) if name]
            names = [rule.inputs[place][0] for place in places]
            chance.shuffle(names)
            for place, name in zip(places, names, strict=True):
                rule.inputs[place][0] = name
        elif kind == "value" and rule.params:
            chance.choice(rule.params)[1] = self.value()
        elif kind == "exchange" and len(rule.params) > 1:
            one, other = chance.sample(rule.params, 2)
            one[1], other[1] = other[1], one[1]
        elif kind == "rename" and rule.params and rule.params[-1][0]:
            rule.params[-1][0] = chance.choice(["last", "least"])
        elif kind == "module":
            module = chance.choice(self.modules)
            module.value = chance.randrange(10, 99)
            if module.path.endswith("__init__.py"):
                return kind, None  # imports run it, and may not use its value
        elif kind == "way":
            used = chance.choice(self.scripts)
            used[1] = [chance.randrange(5) for _ in used[0]]
            return kind, None  # the code is another, the result the same
        elif kind == "input":
            rule.inputs.append([None, chance.choice([*self.sources])])
        elif kind == "case":
            self.cases = chance.choice([["a"], ["a", "b"], ["b", "a"], ["a", "b", "c"]])
        elif kind == "output":
            rule.outputs = ["other" if name == "made" else name and "made" for name in rule.outputs]
            if len({*rule.outputs} - {None}) < len([one for one in rule.outputs if one]):
                rule.outputs = [None] * len(rule.outputs)
            rule.outputs.sort(key=lambda name: name is not None)
        elif kind == "script":
            rule.script = chance.randrange(len(self.scripts))
            return kind, None  # scripts of the same modules have the same result
        else:
            self._same(kind, rule)
            return kind, False
        return kind, True

    def _same(self, kind, rule):
        """What means the same."""
        chance = self.random
        if kind == "spelling":
            self.spelling[chance.choice([*self.sources])] = chance.randrange(3)
        elif kind == "style":
            self.style = chance.randrange(99)
        elif kind == "comment":
            number = chance.randrange(99)
            chance.choice(self.modules).comment = chance.choice(self.scripts)[2] = number
        elif kind == "threads":
            rule.threads = chance.randint(1, 4)
        elif kind == "results":
            self.results = chance.choice(["results", "./results", "{directory}/results"])

    def damage(self, directory, former):
        """Damage results in a directory, or restore some of a former state; return what."""
        chance, results = self.random, directory / "results"
        made = sorted(results.glob("r*/*.txt"))
        kind = chance.choice(["emptied", "edited", "exchanged", "removed", "record", "restored"])
        one, other = chance.sample(made, 2)
        state = one.stat()
        if kind == "emptied":
            one.write_text("")
        elif kind == "edited":
            text = one.read_text() or "0"
            one.write_text(f"{text[:-1]}{'0' if text[-1] == '1' else '1'}")
        elif kind == "exchanged":
            shutil.copy2(other, one)
        elif kind == "removed":
            one.unlink()
        elif kind == "record":
            (results / ".records" / f"{one.relative_to(results)}.json").unlink()
        elif former.exists():
            shutil.copytree(former, results, dirs_exist_ok=True)
        if one.exists() and kind != "restored" and chance.random() < 0.7:
            os.utime(one, ns=(state.st_atime_ns, state.st_mtime_ns))
        return kind


# -- runs ------------------------------------------------------------------------------------------


_parser = cli.get_argument_parser()
cli.get_argument_parser = lambda profiles=None: _parser


def _in_a_fork(function):
    """Run a function in a process of its own; return its status."""
    child = os.fork()
    if child == 0:
        status = 1
        try:
            status = function() or 0
        except SystemExit as stop:
            status = stop.code if isinstance(stop.code, int) else int(bool(stop.code))
        except BaseException:
            traceback.print_exc()
        finally:
            sys.stdout.flush()
            sys.stderr.flush()
            os._exit(status)
    return os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])


def _execute_script(self, fname, edit=False):
    """Run a script in a fork of this process, which has imported everything."""
    source = Path(fname).read_text()

    def script():
        threading.current_thread().__class__ = threading._MainThread
        exec(compile(source, fname, "exec"), {"__name__": "__main__", "__file__": fname})

    if _in_a_fork(script):
        raise RuntimeError("the script failed")


def run(directory, *arguments):
    """Run Snakemake in a fork; the jobs that ran, and what was said where it failed."""
    ran, log = directory / "ran.txt", directory / "log.txt"
    ran.unlink(missing_ok=True)

    def work():
        os.chdir(directory)
        file = os.open(log, os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
        for number in (1, 2):
            os.dup2(file, number)
        sys.stdout, sys.stderr = os.fdopen(1, "w"), os.fdopen(2, "w")
        os.environ["SNAKETRUST_RUN"], sys.dont_write_bytecode = "", False
        sys.path.insert(0, str(directory / "lib"))
        PythonScript.execute_script = _execute_script
        cli.main([*OPTIONS, *arguments])

    status = _in_a_fork(work)
    jobs = ran.read_text().split() if ran.exists() else []
    return jobs, log.read_text() if status else ""


def contents(workflow, directory):
    """Texts of all results that the workflow makes now, by name."""
    paths = {
        name: directory / "results" / name for one in workflow.rules for name in workflow.made(one)
    }
    return {name: path.read_text() if path.exists() else None for name, path in paths.items()}


def trial(seed, edits, place):
    """Edit a random workflow; yield what was done, and what is wrong (empty if nothing is)."""
    workflow, directory = Workflow(seed), place / "project"
    former, told = place / "former", []
    shutil.rmtree(place, ignore_errors=True)
    chance = random.Random(f"steps {seed}")
    workflow.write(directory)
    _, said = run(directory)
    if said:
        yield ["first"], said
        return
    for _ in range(edits):
        before, told, may = contents(workflow, directory), [], set()
        for _ in range(chance.choice([1, 1, 1, 2, 3])):
            if chance.random() < 0.2:
                told.append(workflow.damage(directory, former))
                may.add("damage")
            else:
                kind, changes = workflow.edit()
                told.append(kind)
                may.add(changes)
        if chance.random() < 0.1:
            shutil.rmtree(former, ignore_errors=True)
            shutil.copytree(directory / "results", former)
        workflow.write(directory)
        yield told, _problem(workflow, directory, place / "scratch", before, may)


def _problem(workflow, directory, scratch, before, may):
    ran, said = run(directory)
    if said:
        return said
    if may <= {False}:
        expected = before
        if ran:
            return f"what means the same runs {ran}"
    else:
        shutil.rmtree(scratch, ignore_errors=True)
        workflow.write(scratch)
        if said := run(scratch)[1]:
            return f"from scratch: {said}"
        expected = contents(workflow, scratch)
    found = contents(workflow, directory)
    if wrong := [name for name in expected if found[name] != expected[name]]:
        return f"unlike a run from scratch: {wrong}"
    changed = {name for name in expected if before.get(name) != expected[name]}
    if may <= {True, False} and (idle := [one for one in ran if one not in changed]):
        return f"ran in vain: {idle}"
    if twice := run(directory)[0]:
        return f"runs twice: {twice}"
    return ""


SEED = int(os.environ.get("SNAKETRUST_SEED", "0"))
WORKFLOWS = int(os.environ.get("SNAKETRUST_WORKFLOWS", "20"))
EDITS = 10


@pytest.mark.long
@pytest.mark.parametrize("seed", range(SEED, SEED + WORKFLOWS))
def test_random_edits_give_the_results_of_a_run_from_scratch_and_settle(seed, tmp_path):
    done = []
    for told, problem in trial(seed, EDITS, tmp_path / "trial"):
        done.append(told)
        assert not problem, (seed, done, problem)
    assert len(done) == EDITS


def test_every_kind_of_edit_gives_the_results_of_a_run_from_scratch_and_settles(tmp_path):
    workflow, directory = Workflow(1), tmp_path / "project"
    workflow.write(directory)
    assert run(directory)[1] == ""
    modules = [module.path for module in workflow.modules]
    for what in [*dict.fromkeys(KINDS), *modules]:
        before, texts = contents(workflow, directory), workflow.texts(directory)
        while workflow.texts(directory) == texts:
            if what in modules:
                module = workflow.modules[modules.index(what)]
                module.value, changes = module.value + 1, "__init__" not in what or None
            else:
                _, changes = workflow.edit(what)
        workflow.write(directory)
        problem = _problem(workflow, directory, tmp_path / "scratch", before, {changes})
        assert not problem, (what, problem)
