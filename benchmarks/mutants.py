"""Mutants that the tests kill, and those that survive: a sample of small changes of the sources.

::

    pip install coverage
    python benchmarks/mutants.py map PATHS...     # which test runs which line
    python benchmarks/mutants.py run --seed 1 --number 300 --modules src/burstcast/control
    python benchmarks/mutants.py report

One operator, bound, constant, default or result is changed at a time, at a place that is drawn at
random, and the tests that run this line are run until one fails (``--every``: all of them, so that
each test that notices is known); then, before a mutant counts as a survivor, those that run any
line of the module, and those that ``--all`` names. Sources are edited in place: work in a clone of
its own, nowhere else. What was found is kept in ``mutants/`` there: a sample may be continued, and
its survivors be tried again (``--again``) once there are more tests. ``--only`` tries what a sample
has below some paths.
"""

import argparse
import ast
import json
import os
import random
import signal
import sys
import time
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
FOUND = ROOT / "mutants"
WHERE, TIMES, DRAWN = FOUND / "coverage", FOUND / "seconds.json", FOUND / "mutants.jsonl"
QUIET = ("-p", "no:cacheprovider", "--tb=line", "--hypothesis-profile=mutants")
LONGEST = 40.0  # seconds of tests that run the line; of the others as many as --longest says

SWAPS: dict[type[ast.AST], str] = {
    **{ast.Lt: "<=", ast.LtE: "<", ast.Gt: ">=", ast.GtE: ">", ast.Eq: "!=", ast.NotEq: "=="},
    **{ast.Is: "is not", ast.IsNot: "is", ast.In: "not in", ast.NotIn: "in"},
    **{ast.Add: "-", ast.Sub: "+", ast.Mult: "/", ast.Div: "*", ast.FloorDiv: "*"},
    **{ast.Mod: "*", ast.Pow: "*", ast.BitAnd: "|", ast.BitOr: "&", ast.And: "or", ast.Or: "and"},
}
NAMES = {"min": "max", "max": "min", "any": "all", "all": "any", "argmin": "argmax"}
NAMES |= {"argmax": "argmin", "floor": "ceil", "ceil": "floor", "minimum": "maximum"}
NAMES |= {"maximum": "minimum", "sum": "max", "mean": "max", "zeros": "ones", "ones": "zeros"}


@dataclass(frozen=True)
class Mutant:
    """A change of one place.

    Attributes
    ----------
    path
        Of the source, from the root of the project.
    start, end
        Bytes that are replaced.
    new
        What stands there then.
    line, last
        Lines of the statement, by which its tests are found; 0 of what runs on import.
    what
        In words.
    """

    path: str
    start: int
    end: int
    new: str
    line: int
    last: int
    what: str


class Places:
    """Where a source may be changed, and into what."""

    def __init__(self, path: Path) -> None:
        self.path = str(path.relative_to(ROOT))
        self.source = path.read_bytes()
        lengths = [len(line) for line in self.source.splitlines(keepends=True)]
        self.offsets = [sum(lengths[:number]) for number in range(len(lengths))]
        self.tree = ast.parse(self.source)

    def mutants(self) -> list[Mutant]:
        """All of them, in the order of the source."""
        return [mutant for node in self.tree.body for mutant in self._of_statement(node, False)]

    def _of_statement(self, node: ast.stmt, inside: bool) -> Iterator[Mutant]:
        if isinstance(node, ast.Raise | ast.Assert | ast.Import | ast.ImportFrom):
            return  # what is said of mistakes is no science
        if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant):
            return  # docstring
        if isinstance(node, ast.Expr) and ast.unparse(node).startswith("logger."):
            return
        if isinstance(node, ast.If) and "TYPE_CHECKING" in ast.unparse(node.test):
            return
        definition = isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef)
        deeper = inside or definition
        span = (node.lineno, node.end_lineno or node.lineno) if inside else (0, 0)
        blocks = ("body", "orelse", "finalbody", "handlers", "cases")
        if any(hasattr(node, name) for name in blocks) and inside:
            span = node.lineno, node.lineno
        if isinstance(node, ast.Return) and not isinstance(node.value, ast.Constant | None):
            yield self._change(node.value, node.value, "None", span)
        if isinstance(node, ast.Expr) and isinstance(node.value, ast.Call):
            yield self._change(node, node, "pass", span)
        if isinstance(node, ast.If | ast.While):
            yield self._change(node.test, node.test, f"not ({self._text(node.test)})", span)
        if isinstance(node, ast.Break | ast.Continue):
            other = "continue" if isinstance(node, ast.Break) else "break"
            yield self._change(node, node, other, span)
        if isinstance(node, ast.AugAssign) and type(node.op) in SWAPS:
            yield from self._between(node.target, node.value, "=", f"{SWAPS[type(node.op)]}=", span)
        for name, value in ast.iter_fields(node):
            if name in ("annotation", "returns", "decorator_list", "bases", "keywords"):
                continue
            for child in value if isinstance(value, list) else [value]:
                if isinstance(child, ast.stmt):
                    yield from self._of_statement(child, deeper)
                elif isinstance(child, ast.ExceptHandler | ast.match_case):
                    for entry in child.body:
                        yield from self._of_statement(entry, deeper)
                elif isinstance(child, ast.arguments):
                    for default in [*child.defaults, *child.kw_defaults]:
                        if default is not None:
                            yield from self._of_expression(default, (0, 0))
                elif isinstance(child, ast.AST):
                    yield from self._of_expression(child, span)

    def _of_expression(self, node: ast.AST, span: tuple[int, int]) -> Iterator[Mutant]:
        if isinstance(node, ast.JoinedStr):
            return
        if isinstance(node, ast.Call) and "Error" in ast.unparse(node.func):
            return
        if isinstance(node, ast.Compare):
            for left, operator, right in zip(
                [node.left, *node.comparators], node.ops, node.comparators, strict=False
            ):
                yield from self._between(left, right, "", SWAPS[type(operator)], span)
        elif isinstance(node, ast.BinOp) and type(node.op) in SWAPS:
            yield from self._between(node.left, node.right, "", SWAPS[type(node.op)], span)
        elif isinstance(node, ast.BoolOp):
            for left, right in zip(node.values, node.values[1:], strict=False):
                yield from self._between(left, right, "", SWAPS[type(node.op)], span)
        elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.Not | ast.USub | ast.Invert):
            yield self._change(node, node, f"({self._text(node.operand)})", span)
            if isinstance(node.operand, ast.Constant):
                return
        elif isinstance(node, ast.IfExp):
            yield self._change(node.test, node.test, f"not ({self._text(node.test)})", span)
        elif isinstance(node, ast.Constant):
            new = _other(node.value)
            if new is not None:
                yield self._change(node, node, new, span)
        elif isinstance(node, ast.Slice):
            yield from self._of_slice(node, span)
        elif isinstance(node, ast.comprehension):
            for test in node.ifs:
                yield self._change(test, test, "True", span)
        elif isinstance(node, ast.Call):
            name = node.func
            called = name.id if isinstance(name, ast.Name) else getattr(name, "attr", "")
            if called in NAMES and name.end_col_offset is not None:
                end = self._at(name.end_lineno or 0, name.end_col_offset)
                yield self._mutant(end - len(called), end, NAMES[called], span)
        for child in ast.iter_child_nodes(node):
            yield from self._of_expression(child, span)

    def _of_slice(self, node: ast.Slice, span: tuple[int, int]) -> Iterator[Mutant]:
        """A bound that is off by one."""
        for bound in (node.lower, node.upper):
            if bound is not None and not isinstance(bound, ast.Constant):
                yield self._change(bound, bound, f"({self._text(bound)}) + 1", span)

    def _between(
        self, left: ast.AST, right: ast.AST, ending: str, new: str, span: tuple[int, int]
    ) -> Iterator[Mutant]:
        """Another operator between two expressions."""
        start = self._at(left.end_lineno, left.end_col_offset)
        end = self._at(right.lineno, right.col_offset)
        between = self.source[start:end].decode()
        operator = between.strip("() \n\t\\").removesuffix(ending) + ending
        if operator and "#" not in between and between.count(operator) == 1:
            at = start + len(between[: between.index(operator)].encode())
            yield self._mutant(at, at + len(operator.encode()), new, span)

    def _change(self, first: ast.AST, last: ast.AST, new: str, span: tuple[int, int]) -> Mutant:
        start = self._at(first.lineno, first.col_offset)
        return self._mutant(start, self._at(last.end_lineno, last.end_col_offset), new, span)

    def _mutant(self, start: int, end: int, new: str, span: tuple[int, int]) -> Mutant:
        line = self.source[:start].count(b"\n")
        old = " ".join(self.source[start:end].decode().split())
        what = f"line {line + 1}: {old} -> {new}"
        return Mutant(self.path, start, end, new, *span, what)

    def _at(self, line: int, column: int) -> int:
        return self.offsets[line - 1] + column

    def _text(self, node: ast.AST) -> str:
        start = self._at(node.lineno, node.col_offset)
        return self.source[start : self._at(node.end_lineno, node.end_col_offset)].decode()


def _other(value: object) -> str | None:
    """Another constant; None for texts, which are names."""
    if isinstance(value, bool):
        return repr(not value)
    if isinstance(value, int):
        return repr(value + 1)
    if isinstance(value, float):
        return repr(value * 1.25 if value else 0.01)
    return None


# -- which tests -----------------------------------------------------------------------------------


class Recorder:
    """Tells coverage which test runs, and keeps how long each took."""

    def __init__(self, coverage: object) -> None:
        self.coverage, self.seconds = coverage, dict[str, float]()

    def pytest_runtest_logstart(self, nodeid: str, location: object) -> None:
        """Name what runs from now on after a test."""
        self.coverage.switch_context(nodeid)

    def pytest_runtest_logreport(self, report: object) -> None:
        """Note how long setting up, running or cleaning up took."""
        self.seconds[report.nodeid] = self.seconds.get(report.nodeid, 0.0) + report.duration


def record(paths: Sequence[str]) -> int:
    """Run tests once, and note which runs what."""
    import coverage
    import pytest

    FOUND.mkdir(exist_ok=True)
    measured = coverage.Coverage(WHERE, source=[str(ROOT / "src")], config_file=False)
    recorder = Recorder(measured)
    with measured.collect():
        status = pytest.main(["-q", "-p", "no:cacheprovider", *paths], [recorder])
    measured.save()
    TIMES.write_text(json.dumps(recorder.seconds))
    return int(status)


class Tests:
    """Tests of each line, the fastest first."""

    def __init__(self) -> None:
        from coverage import CoverageData

        self.seconds: dict[str, float] = json.loads(TIMES.read_text())
        self.data = CoverageData(str(WHERE))
        self.data.read()

    def of(self, mutant: Mutant) -> tuple[list[str], list[str]]:
        """Tests that run the line, and the others of its module."""
        by_line = self.data.contexts_by_lineno(str(ROOT / mutant.path))
        module = {test for tests in by_line.values() for test in tests if test}
        lines = range(mutant.line, mutant.last + 1)
        near = {test for line in lines for test in by_line.get(line, []) if test}
        if not mutant.line:
            near = module
        return self.ordered(near), self.ordered(module - near)

    def ordered(self, tests: set[str]) -> list[str]:
        """The fastest first."""
        return sorted(tests, key=lambda test: (self.seconds.get(test, 0.0), test))

    def within(self, tests: list[str], seconds: float) -> list[str]:
        """As many as take no longer than this."""
        taken, total = [], 0.0
        for test in tests:
            total += self.seconds.get(test, 0.0)
            if total > seconds and taken:
                break
            taken.append(test)
        return taken


# -- trying ----------------------------------------------------------------------------------------


def load_libraries() -> None:
    """What every test imports: processes that are forked have it."""
    import hypothesis
    import llvmlite.binding  # noqa: F401
    import netCDF4  # noqa: F401
    import numpy  # noqa: F401
    import pandas  # noqa: F401
    import pytest  # noqa: F401
    import scipy.integrate
    import scipy.linalg
    import scipy.sparse.linalg
    import scipy.stats  # noqa: F401
    import skopt  # noqa: F401

    phases = [hypothesis.Phase.explicit, hypothesis.Phase.generate]
    # no failure is made small here, and none is kept
    hypothesis.settings.register_profile(
        "mutants", phases=phases, database=None, derandomize=True, deadline=None
    )
    hypothesis.settings.load_profile("mutants")


def passes(tests: Sequence[str], seconds: float, every: bool = False) -> tuple[bool, list[str]]:
    """Whether tests pass in a process of their own, and the failures that they tell."""
    output = FOUND / "output.txt"
    child = os.fork()
    if child == 0:
        os.setsid()
        sys.dont_write_bytecode = True  # what is compiled of a mutant must not outlive it
        os.environ["PYTHONDONTWRITEBYTECODE"] = "1"
        with output.open("w") as file:
            os.dup2(file.fileno(), 1)
            os.dup2(file.fileno(), 2)
        import pytest

        status = 70
        try:
            status = int(pytest.main([*([] if every else ["-x"]), "-q", *QUIET, *tests]))
        finally:
            sys.stdout.flush()
            os._exit(status)
    end = time.monotonic() + seconds
    while True:
        done, status = os.waitpid(child, os.WNOHANG)
        if done:
            break
        if time.monotonic() > end:
            os.killpg(child, signal.SIGKILL)
            os.waitpid(child, 0)
            return False, ["takes too long"]
        time.sleep(0.02)
    lines = [line for line in output.read_text(errors="replace").splitlines() if line.strip()]
    if any(line.startswith("ERROR: not found") for line in lines) and "::" in "".join(tests):
        # the name of a test has the number of a process in it, say: all tests of the files
        return passes(sorted({test.partition("::")[0] for test in tests}), seconds, every)
    failures = [line for line in lines if line.startswith(("FAILED", "ERROR", "INTERNALERROR"))]
    reasons = failures or lines[-1:] or ["nothing"]
    return os.waitstatus_to_exitcode(status) == 0, [failure[:200] for failure in reasons]


def outcome(mutant: Mutant, tests: Tests, options: argparse.Namespace) -> tuple[str, list[str]]:
    """Whether a mutant is killed or survives, and what it is killed by."""
    near, module = tests.of(mutant)
    stages = [tests.within(near, LONGEST), tests.within(module, options.longest)]
    stages.append(list(options.all))
    path = ROOT / mutant.path
    source, state = path.read_bytes(), path.stat()
    try:
        path.write_bytes(source[: mutant.start] + mutant.new.encode() + source[mutant.end :])
        for stage in filter(None, stages):
            seconds = sum(tests.seconds.get(test, 60.0) for test in stage)
            passed, reasons = passes(stage, 30.0 + 4.0 * seconds, options.every)
            if not passed:
                return "killed", reasons
    finally:
        path.write_bytes(source)
        os.utime(path, ns=(state.st_atime_ns, state.st_mtime_ns))
    return "survived", [f"{len(near)} tests run the line, {len(module)} others the module"]


def sample(modules: Sequence[str], seed: int, number: int) -> list[Mutant]:
    """Mutants of modules, drawn at random, one of each place at most."""
    paths = [ROOT / module for module in modules]
    files = sorted(
        {file for path in paths for file in ([path] if path.is_file() else path.rglob("*.py"))}
    )
    every = [mutant for file in files for mutant in Places(file).mutants()]
    chance = random.Random(seed)
    chance.shuffle(every)
    first_of_place = {(mutant.path, mutant.start): mutant for mutant in reversed(every)}
    return list(first_of_place.values())[::-1][:number]


def run(options: argparse.Namespace) -> None:
    """Try a sample, and note each outcome."""
    load_libraries()
    tests = Tests()
    mutants = sample(options.modules, options.seed, options.number)
    done = {json.dumps(entry["mutant"]): entry for entry in tried()}
    for number, mutant in enumerate(mutants):
        before = done.get(json.dumps(asdict(mutant)))
        if before and not (options.again and before["outcome"] == "survived"):
            continue
        if options.only and not mutant.path.startswith(tuple(options.only)):
            continue
        start = time.monotonic()
        how, why = outcome(mutant, tests, options)
        entry = {"mutant": asdict(mutant), "outcome": how, "by": why, "seed": options.seed}
        with DRAWN.open("a") as file:
            file.write(json.dumps(entry) + "\n")
        taken = time.monotonic() - start
        print(
            f"{number:4d} {taken:5.1f} s {how:8s} {mutant.path} {mutant.what} | {why[0]}",
            flush=True,
        )


def tried() -> list[dict]:
    """What was tried, the last outcome of each mutant."""
    lines = DRAWN.read_text().splitlines() if DRAWN.exists() else []
    entries = [json.loads(line) for line in lines]
    return list({json.dumps(entry["mutant"]): entry for entry in entries}.values())


def report() -> None:
    """How many were killed, and which survived."""
    entries = tried()
    survivors = [entry for entry in entries if entry["outcome"] == "survived"]
    print(
        f"{len(entries)} mutants, {len(entries) - len(survivors)} killed, {len(survivors)} survived"
    )
    survivors.sort(key=lambda entry: (entry["mutant"]["path"], entry["mutant"]["start"]))
    for entry in survivors:
        print(f"{entry['mutant']['path']} {entry['mutant']['what']} | {entry['by'][0]}")


def main() -> int:
    """Do what the command line says."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    commands = parser.add_subparsers(dest="command", required=True)
    commands.add_parser("map").add_argument("paths", nargs="+")
    commands.add_parser("report")
    runs = commands.add_parser("run")
    runs.add_argument("--modules", nargs="+", required=True)
    runs.add_argument("--seed", type=int, required=True)
    runs.add_argument("--number", type=int, default=300)
    runs.add_argument("--longest", type=float, default=60.0)
    runs.add_argument("--all", nargs="*", default=[])
    runs.add_argument("--only", nargs="*", default=[])
    runs.add_argument("--again", action="store_true")
    runs.add_argument("--every", action="store_true")
    options = parser.parse_args()
    os.chdir(ROOT)
    os.environ.setdefault("OMP_NUM_THREADS", "1")
    if options.command == "map":
        return record(options.paths)
    run(options) if options.command == "run" else report()
    return 0


if __name__ == "__main__":
    sys.exit(main())
