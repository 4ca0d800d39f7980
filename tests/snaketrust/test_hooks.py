"""What is done to Snakemake, that Snakemake is still as it is taken for, and parameters."""

import asyncio
import inspect
import io
import logging
import math
import signal
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from snakemake.cli import get_argument_parser
from snakemake.iocontainers import Namedlist
from snakemake.jobs import Job
from snakemake.persistence import PersistenceBase
from snakemake.scheduling.job_scheduler import JobRateLimiter, JobScheduler
from snakemake.script import PythonScript
from snakemake.settings.types import MaxJobsPerTimespan
from snakemake.workflow import Workflow

from snaketrust import hooks
from snaketrust.checks import RefusedError
from snaketrust.files import digest
from snaketrust.hooks import FIRST_LINE, HOOKS, UnfitSnakemakeError, install
from snaketrust.plain import groups, named, plain
from snaketrust.planning import KnownResults
from snaketrust.records import Records, shape
from snaketrust.run import VARIABLE


def known_as(monkeypatch, name, function):
    """Let a function of Snakemake be another one."""
    changed = [hook._replace(own=function) if hook.name == name else hook for hook in hooks.HOOKS]
    monkeypatch.setattr(hooks, "HOOKS", changed)


@pytest.fixture(autouse=True)
def snakemakes_own(monkeypatch):
    """Functions of Snakemake are put back after each test."""
    for hook in HOOKS:
        monkeypatch.setattr(hook.owner, hook.name, hook.own)
    monkeypatch.setenv(VARIABLE, "")


# -- Snakemake is as it is taken for ---------------------------------------------------------------
@pytest.mark.parametrize("hook", HOOKS, ids=lambda hook: f"{hook.owner.__name__}.{hook.name}")
def test_snakemake_has_the_functions_that_are_replaced(hook):
    assert hook.fits()


def test_snakemake_asks_the_metadata_and_makes_its_scheduler_between_planning_and_the_first_job():
    # all that reruns rest on goes through the function that is replaced
    for name in ("params", "input", "rule", "code", "software_stack_hash", "has_metadata"):
        assert "self.metadata(" in inspect.getsource(getattr(PersistenceBase, name)), name
    source = inspect.getsource(Workflow.execute)
    steps = ["self._build_dag()", "postprocess(", "JobScheduler(", "self.scheduler.schedule()"]
    places = [source.index(step) for step in steps]
    assert places == sorted(places)


# -- with another release --------------------------------------------------------------------------
@pytest.fixture
def another(monkeypatch, caplog):
    """Install with some functions that are not as they were; return what is said."""

    def said(*changed):
        monkeypatch.setattr(hooks, "__version__", "99.0")
        for name in changed:
            known_as(monkeypatch, name, lambda self, surprise: None)
        with caplog.at_level(logging.WARNING):
            install(KnownResults("results"), print)
        return caplog.text

    return said


def test_a_release_that_was_not_tested_is_told(another):
    assert "Snakemake 99.0 is none of the tested releases (9.20.0" in another()


def test_what_is_not_needed_is_left_out(another):
    text = another("incomplete", "write_script")
    assert "another PersistenceBase.incomplete now: such jobs run again" in text
    assert "tracebacks on the terminal" in text
    assert PersistenceBase.incomplete == HOOKS[-2].own
    assert PythonScript.write_script == HOOKS[-1].own


@pytest.mark.parametrize("name", ["metadata", "params_changed", "_input_changed", "__init__"])
def test_without_what_all_rests_on_nothing_starts(another, name):
    with pytest.raises(UnfitSnakemakeError, match=r"has another .*install one of the releases 9"):
        another(name)


# -- what Snakemake is told of results -------------------------------------------------------------
def test_snakemake_is_told_what_records_say(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    source, made, records = Path("series.csv"), Path("results/a.nc"), Records("results")
    made.parent.mkdir()
    source.write_text("series")
    made.write_text("a")
    inputs = {str(source): digest(source)}
    records.write([str(made)], {"rule": "train"}, {"seed": 1}, inputs, "results/a.log", 5.0)
    changed = made.stat().st_mtime
    install(KnownResults("results"), print)

    def known(path=made):
        return PersistenceBase.metadata(None, str(path))

    assert known("results/b.nc") is None
    found = known()
    assert (found.rule, found.log) == ("train", ["results/a.log"])
    assert (found.starttime, found.endtime) == pytest.approx((changed - 5, changed), abs=1e-3)
    checksums = found.input_checksums
    for spelling in ("series.csv", "./series.csv", str(source.absolute())):
        assert checksums.get(spelling) == f"sha256:{inputs['series.csv']}"


def listed(*items, lists=True):
    """A list of Snakemake's of values, names with a value, and names with a list."""
    found = Namedlist()
    for item in items:
        name, value = item if isinstance(item, tuple) else (None, item)
        start, several = len(found), isinstance(value, list) and lists
        found.extend(value if several else [value])
        if name:
            found._set_name(name, start, end=len(found) if several else None)
    return found


def job(inputs=(), params=(), outputs=("results/a.nc",), **wildcards):
    """A planned job: pairs of names and values, or values without a name."""
    lists = {"input": listed(*inputs), "output": listed(*outputs)}
    lists["params"] = listed(*params, lists=False)
    return SimpleNamespace(**lists, wildcards_dict=wildcards, rule=SimpleNamespace(name="train"))


@pytest.fixture
def made(tmp_path, monkeypatch):
    """A result of a job, and what keeps its record."""
    monkeypatch.chdir(tmp_path)
    Path("results").mkdir()
    Path("results/a.nc").write_text("equal")
    return Records("results")


A, B = ("a", "x.csv"), ("b", "y.csv")
PLANNED = job(inputs=[A, B], params=[("low", 1), ("high", 2)], case="one")


@pytest.mark.parametrize(
    ("other", "runs"),
    [
        (PLANNED, False),
        (job([A, B], [("low", 1.0), ("high", np.int64(2))], case="one"), False),
        (job([("a", "./x.csv"), B], [("low", 1), ("high", 2)], case="one"), False),
        (job([("a", "results/../x.csv"), B], [("low", 1), ("high", 2)], case="one"), False),
        (job([A, B], [("low", 1), ("high", 2)], [f"{'./' * 2}results/a.nc"], case="one"), False),
        (job([A, B], [("low", 2), ("high", 1)], case="one"), True),
        (job([A, B], [("high", 2), ("low", 1)], case="one"), True),
        (job([A, B], [("low", True), ("high", 2)], case="one"), True),
        (job([A, B], [1, 2], case="one"), True),
        (job([("a", "y.csv"), ("b", "x.csv")], [("low", 1), ("high", 2)], case="one"), True),
        (job([B, A], [("low", 1), ("high", 2)], case="one"), True),
        (job([("b", "x.csv"), ("a", "y.csv")], [("low", 1), ("high", 2)], case="one"), True),
        (job([("a", ["x.csv"]), B], [("low", 1), ("high", 2)], case="one"), True),
        (job(["x.csv", "y.csv"], [("low", 1), ("high", 2)], case="one"), True),
        (job([A, B, A[1]], [("low", 1), ("high", 2)], case="one"), True),
        (job([A, B], [("low", 1), ("high", 2)], [("o", "results/a.nc")], case="one"), True),
        (job([A, B], [("low", 1), ("high", 2)], case="other"), True),
    ],
)
def test_names_and_order_count_and_spellings_do_not(made, other, runs):
    for path in ("x.csv", "y.csv"):
        Path(path).write_text("equal")
    digests = {path: digest(path) for path in ("x.csv", "y.csv")}
    names = [made.name(path) for path in PLANNED.input]
    told = shape(PLANNED.input, names, PLANNED.output, ["a.nc"], PLANNED.wildcards_dict)
    values = {"low": 1, "high": 2}
    made.write(["results/a.nc"], {"rule": "train"}, values, digests, "", 1.0, shape=told)
    install(KnownResults("results"), print)
    path = other.output[0]
    changed = PersistenceBase.params_changed(None, other, path)
    assert (bool(changed) or PersistenceBase._input_changed(None, other, path)) == runs


@pytest.mark.parametrize(
    "value", [(1, (2,)), {1: "a", 20: "b"}, {"b": 1, "a": 4.0}, np.float64(0.5), [np.int8(3)], ""]
)
def test_parameters_of_any_plain_kind_settle(made, value):
    kept = {"settings": plain(value)}
    made.write(["results/a.nc"], {"rule": "train"}, kept, {}, "", 1.0)
    install(KnownResults("results"), print)
    planned = job(params=[("settings", value)])
    assert not PersistenceBase.params_changed(None, planned, "results/a.nc")
    planned = job(params=[("settings", {"1": "a", "20": "b"})])
    assert PersistenceBase.params_changed(None, planned, "results/a.nc")


def test_a_damaged_result_says_so(made):
    made.write(["results/a.nc"], {"rule": "train"}, {}, {}, "", 1.0)
    Path("results/a.nc").write_text("b")
    install(KnownResults("results"), print)
    changed = PersistenceBase.params_changed(None, job())
    assert changed.only_old == {"results/a.nc is not what its job wrote"}


def test_outputs_without_a_record_are_incomplete(tmp_path, monkeypatch):
    """Of those that Snakemake marked; one of an earlier run that has its record is whole."""
    made = [tmp_path / "results" / f"{name}.nc" for name in ("whole", "half", "missing")]

    async def marked(self, job):
        return [str(path) for path in made]

    known_as(monkeypatch, "incomplete", marked)
    made[0].parent.mkdir()
    for path in made[:2]:
        path.write_text("content")
    records = Records(str(tmp_path / "results"))
    records.write([str(made[0])], {"rule": "train"}, {}, {}, "a.log", 1.0)
    install(KnownResults(str(tmp_path / "results")), print)
    found = asyncio.run(PersistenceBase.incomplete(None, None))
    assert found == [str(path) for path in made[1:]]


# -- what Snakemake removes ------------------------------------------------------------------------
def removed(monkeypatch, name, *arguments):
    """Outputs that a function of Snakemake's jobs is left to remove."""
    told = []

    async def own(self, skip_outputs=()):
        told.extend(path for path in self.output if path not in skip_outputs)

    signature = inspect.signature(getattr(Job, name))
    own.__signature__ = signature
    known_as(monkeypatch, name, own)
    install(KnownResults("results"), print)
    asyncio.run(getattr(Job, name)(job(outputs=["results/a.nc", "results/b.nc"]), *arguments))
    return told


def run_as(monkeypatch, token):
    Path("results/.run.json").write_text('{"token": "new"}')
    monkeypatch.setenv(VARIABLE, f"{token} results")


def test_a_failed_job_leaves_results_and_what_a_newer_run_makes(made, monkeypatch):
    Path("results/b.nc").write_text("half")
    made.write(["results/a.nc"], {"rule": "train"}, {}, {}, "", 1.0)
    assert removed(monkeypatch, "cleanup", ()) == ["results/b.nc"]
    run_as(monkeypatch, "new")
    assert removed(monkeypatch, "cleanup", ()) == ["results/b.nc"]
    run_as(monkeypatch, "old")
    assert removed(monkeypatch, "cleanup", ()) == []


def test_a_job_keeps_what_its_run_has_made_and_an_overtaken_one_stops(made, monkeypatch):
    outputs = ["results/a.nc", "results/b.nc"]
    Path("results/b.nc").write_text("b")
    run_as(monkeypatch, "new")
    made.write(outputs, {"rule": "train"}, {}, {}, "", 1.0, run="old")
    assert removed(monkeypatch, "remove_existing_output") == outputs
    made.write(outputs, {"rule": "train"}, {}, {}, "", 1.0, run="new")
    assert removed(monkeypatch, "remove_existing_output") == []
    Path("results/b.nc").write_text("damaged")
    assert removed(monkeypatch, "remove_existing_output") == outputs
    run_as(monkeypatch, "old")
    with pytest.raises(RefusedError, match="belongs to a newer run now"):
        removed(monkeypatch, "remove_existing_output")


# -- when planning is over -------------------------------------------------------------------------
def limit_left(monkeypatch, limit, local=True):
    """Limit that a scheduler keeps."""
    told = []

    def make(self, workflow, executor_plugin, scheduler, greedy_scheduler_settings):
        assert told == [workflow]
        self.job_rate_limiter = limit and JobRateLimiter(limit)

    known_as(monkeypatch, "__init__", make)
    install(KnownResults("results"), told.append)
    workflow = SimpleNamespace(local_exec=local)
    return JobScheduler(workflow, "plugin", "scheduler", "greedy").job_rate_limiter


@pytest.fixture
def default():
    """What Snakemake's command line has where nobody says otherwise."""
    text = get_argument_parser().get_default("max_jobs_per_timespan")
    return MaxJobsPerTimespan.parse_choice(text)


def test_jobs_of_this_machine_start_at_once_and_other_limits_are_kept(monkeypatch, default):
    assert limit_left(monkeypatch, default) is None
    assert limit_left(monkeypatch, None) is None
    assert limit_left(monkeypatch, default, local=False).max_jobs == default.max_jobs
    limit = MaxJobsPerTimespan.parse_choice("60/1m")
    assert limit_left(monkeypatch, limit).max_jobs == 60


# -- an interruption that meets a job while it imports ---------------------------------------------
WAITS = "import sys, time; print('ready', flush=True); time.sleep(60)"


def interrupted(first_line, patience=20.0, disposition=signal.SIG_DFL):
    """Status of a Python process that SIGINT meets, None if it goes on; and what it says.

    What runs in a shell's background ignores SIGINT, and hands that on: so the process is told.
    """
    process = subprocess.Popen(
        [sys.executable, "-c", first_line + WAITS],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        preexec_fn=lambda: signal.signal(signal.SIGINT, disposition),
    )
    assert process.stdout.readline() == "ready\n"
    process.send_signal(signal.SIGINT)
    try:
        status = process.wait(patience)
    except subprocess.TimeoutExpired:
        status = None
    process.kill()
    return status, process.communicate()[1]


def test_a_process_ends_at_once_and_says_nothing_unless_it_ignores_interruptions():
    assert interrupted(FIRST_LINE.decode()) == (-signal.SIGINT, "")
    assert "KeyboardInterrupt" in interrupted("")[1]
    assert interrupted(FIRST_LINE.decode(), 0.5, signal.SIG_IGN) == (None, "")


def test_scripts_of_snakemake_begin_with_it():
    install(KnownResults("results"), print)
    script = PythonScript.__new__(PythonScript)
    script.source = "print(1)"
    file = io.BytesIO()
    script.write_script("preamble\n", file)
    assert file.getvalue() == FIRST_LINE + b"preamble\nprint(1)"


# -- parameters in plain form ----------------------------------------------------------------------


@pytest.mark.parametrize(
    ("value", "expected"),
    [
        ((1, [2.0, (3,)]), [1, [2, [3]]]),
        ({"b": 1, "a": np.float64(0.5)}, {"a": 0.5, "b": 1}),
        ({2: np.bool_(True), "x": None}, {"x": None, 2: True}),
        (np.int8(3), 3),
        (-0.0, 0),
    ],
)
def test_what_means_the_same_is_the_same(value, expected):
    assert repr(plain(value)) == repr(expected)


@pytest.mark.parametrize(
    ("value", "words"),
    [
        ({1, 2}, "set"),
        (Path("x"), "Path"),
        (np.zeros(2), "ndarray"),
        (math.nan, "params is nan"),
        ({"a": [math.inf]}, r"params.a\[0\] is inf"),
        ({1.5: 0}, "the key 1.5"),
        (b"bytes", "bytes"),
        (1j, "complex"),
    ],
)
def test_what_cannot_be_compared_is_refused_by_its_place(value, words):
    with pytest.raises((TypeError, ValueError), match=words):
        plain(value, "params")


def test_parameters_and_files_are_told_by_names_and_places():
    assert named(listed(1, ("low", 2))) == {"0": 1, "low": 2}
    # outputs ``a=[x, y], a1=z`` are none of ``a=[x], a1=[y, z]``
    x, y, z = "xyz"
    assert groups(listed(("a", [x, y]), ("a1", z)), [x, y, z]) == {"a": [0, 1], "a1": 2}
    assert groups(listed(("a", [x]), ("a1", [y, z])), [x, y, z]) == {"a": [0], "a1": [1, 2]}
    assert groups(listed(x, ("a", y), ("b", x)), [x, y, x]) == {"": [0], "a": 1, "b": 0}
