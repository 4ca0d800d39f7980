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


def installed(planning_is_over=print):
    install(KnownResults("results"), planning_is_over)


# -- Snakemake is as it is taken for ---------------------------------------------------------------
def test_snakemake_has_the_functions_that_are_replaced_and_uses_them_as_it_is_thought():
    assert [hook.name for hook in HOOKS if not hook.fits()] == []
    # all that reruns rest on goes through the function that is replaced
    for name in ("params", "input", "rule", "code", "software_stack_hash", "has_metadata"):
        assert "self.metadata(" in inspect.getsource(getattr(PersistenceBase, name)), name
    # its scheduler is made between planning and the first job
    source = inspect.getsource(Workflow.execute)
    steps = ["self._build_dag()", "postprocess(", "JobScheduler(", "self.scheduler.schedule()"]
    places = [source.index(step) for step in steps]
    assert places == sorted(places)


NEEDED = "metadata", "params_changed", "_input_changed", "__init__"


@pytest.mark.parametrize("name", [hook.name for hook in HOOKS])
def test_install_leaves_out_what_is_not_needed_in_another_release(name, monkeypatch, caplog):
    monkeypatch.setattr(hooks, "__version__", "99.0")
    known_as(monkeypatch, name, lambda self, surprise: None)
    with caplog.at_level(logging.WARNING):
        if name in NEEDED:
            with pytest.raises(UnfitSnakemakeError, match=r"another .*install one of the releases"):
                installed()
            return
        installed()
    assert "Snakemake 99.0 is none of the tested releases (9.20.0" in caplog.text
    (hook,) = [hook for hook in HOOKS if hook.name == name]
    assert f"another {hook.owner.__name__}.{name} now: {hook.without}" in caplog.text
    assert [one.name for one in HOOKS if getattr(one.owner, one.name) == one.own] == [name]


# -- what Snakemake is told of results -------------------------------------------------------------
@pytest.fixture
def made(tmp_path, monkeypatch):
    """Records of results, of which one is there."""
    monkeypatch.chdir(tmp_path)
    Path("results").mkdir()
    Path("results/a.nc").write_text("equal")
    return Records("results")


def test_metadata_are_what_records_say(made):
    source, result = Path("series.csv"), Path("results/a.nc")
    source.write_text("series")
    inputs = {str(source): digest(source)}
    made.write([str(result)], {"rule": "train"}, {"seed": 1}, inputs, "results/a.log", 5.0)
    installed()
    assert PersistenceBase.metadata(None, "results/b.nc") is None
    found, changed = PersistenceBase.metadata(None, str(result)), result.stat().st_mtime
    assert (found.rule, found.log) == ("train", ["results/a.log"])
    assert (found.starttime, found.endtime) == pytest.approx((changed - 5, changed), abs=1e-3)
    for spelling in ("series.csv", "./series.csv", str(source.absolute())):
        assert found.input_checksums.get(spelling) == f"sha256:{inputs['series.csv']}"


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


A, B = ("a", "x.csv"), ("b", "y.csv")
LOW, HIGH = ("low", 1), ("high", 2)
PLANNED = {"inputs": [A, B], "params": [LOW, HIGH], "case": "one"}
SAME = [
    *({}, {"params": [("low", 1.0), ("high", np.int64(2))]}, {"outputs": ["././results/a.nc"]}),
    *({"inputs": [("a", path), B]} for path in ("./x.csv", "results/../x.csv")),
]
OTHER = [
    *({"params": params} for params in ([("low", 2), ("high", 1)], [HIGH, LOW], [1, 2])),
    {"params": [("low", True), HIGH]},
    *({"inputs": inputs} for inputs in ([B, A], ["x.csv", "y.csv"], [A, B, A[1]])),
    *({"inputs": [one, B]} for one in (("a", "y.csv"), ("a", ["x.csv"]), ("c", "x.csv"))),
    *({"inputs": [("a", "y.csv"), ("b", "x.csv")]}, {"inputs": [("b", "x.csv"), ("a", "y.csv")]}),
    *({"outputs": [("o", "results/a.nc")]}, {"case": "other"}),
]


@pytest.mark.parametrize(
    ("other", "runs"), [*((one, False) for one in SAME), *((one, True) for one in OTHER)]
)
def test_params_changed_and_input_changed_by_names_and_order_but_not_by_spelling(made, other, runs):
    for path in ("x.csv", "y.csv"):
        Path(path).write_text("equal")
    digests = {path: digest(path) for path in ("x.csv", "y.csv")}
    planned, names = job(**PLANNED), [made.name(path) for path in digests]
    told = shape(planned.input, names, planned.output, ["a.nc"], planned.wildcards_dict)
    values = dict(PLANNED["params"])
    made.write(["results/a.nc"], {"rule": "train"}, values, digests, "", 1.0, shape=told)
    installed()
    now = job(**PLANNED | other)
    path = now.output[0]
    changed = PersistenceBase.params_changed(None, now, path)
    assert (bool(changed) or PersistenceBase._input_changed(None, now, path)) == runs


@pytest.mark.parametrize(
    "value", [(1, (2,)), {1: "a", 20: "b"}, {"b": 1, "a": 4.0}, np.float64(0.5), [np.int8(3)], ""]
)
def test_parameters_of_any_plain_kind_settle(made, value):
    kept = {"settings": plain(value)}
    made.write(["results/a.nc"], {"rule": "train"}, kept, {}, "", 1.0)
    installed()
    planned = job(params=[("settings", value)])
    assert not PersistenceBase.params_changed(None, planned, "results/a.nc")
    planned = job(params=[("settings", {"1": "a", "20": "b"})])
    assert PersistenceBase.params_changed(None, planned, "results/a.nc")


def test_a_damaged_result_says_so(made):
    made.write(["results/a.nc"], {"rule": "train"}, {}, {}, "", 1.0)
    Path("results/a.nc").write_text("b")
    installed()
    changed = PersistenceBase.params_changed(None, job())
    assert changed.only_old == {"results/a.nc is not what its job wrote"}


def test_outputs_without_a_record_are_incomplete(made, monkeypatch):
    """Of those that Snakemake marked; one of an earlier run that has its record is whole."""
    outputs = [f"results/{name}.nc" for name in ("a", "half", "missing")]

    async def marked(self, job):
        return outputs

    known_as(monkeypatch, "incomplete", marked)
    Path(outputs[1]).write_text("content")
    made.write(outputs[:1], {"rule": "train"}, {}, {}, "a.log", 1.0)
    installed()
    assert asyncio.run(PersistenceBase.incomplete(None, None)) == outputs[1:]


# -- what Snakemake removes ------------------------------------------------------------------------
def removed(monkeypatch, name, *arguments):
    """Outputs that a function of Snakemake's jobs is left to remove."""
    told = []

    async def own(self, skip_outputs=()):
        told.extend(path for path in self.output if path not in skip_outputs)

    signature = inspect.signature(getattr(Job, name))
    own.__signature__ = signature
    known_as(monkeypatch, name, own)
    installed()
    asyncio.run(getattr(Job, name)(job(outputs=["results/a.nc", "results/b.nc"]), *arguments))
    return told


def run_as(monkeypatch, token):
    Path("results/.run.json").write_text('{"token": "new"}')
    monkeypatch.setenv(VARIABLE, f"{token} results")


def test_cleanup_leaves_results_and_what_a_newer_run_makes(made, monkeypatch):
    Path("results/b.nc").write_text("half")
    made.write(["results/a.nc"], {"rule": "train"}, {}, {}, "", 1.0)
    assert removed(monkeypatch, "cleanup", ()) == ["results/b.nc"]
    for token, expected in {"new": ["results/b.nc"], "old": []}.items():
        run_as(monkeypatch, token)
        assert removed(monkeypatch, "cleanup", ()) == expected


def test_remove_existing_output_keeps_what_this_run_has_made_and_stops_an_overtaken_one(
    made, monkeypatch
):
    outputs = ["results/a.nc", "results/b.nc"]
    Path("results/b.nc").write_text("b")
    run_as(monkeypatch, "new")
    for run, expected in {"old": outputs, "new": []}.items():
        made.write(outputs, {"rule": "train"}, {}, {}, "", 1.0, run=run)
        assert removed(monkeypatch, "remove_existing_output") == expected
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
    installed(told.append)
    workflow = SimpleNamespace(local_exec=local)
    return JobScheduler(workflow, "plugin", "scheduler", "greedy").job_rate_limiter


def test_jobs_of_this_machine_start_at_once_and_other_limits_are_kept(monkeypatch):
    # what Snakemake's command line has where nobody says otherwise
    text = get_argument_parser().get_default("max_jobs_per_timespan")
    default, other = map(MaxJobsPerTimespan.parse_choice, (text, "60/1m"))
    assert limit_left(monkeypatch, default) is None
    assert limit_left(monkeypatch, None) is None
    assert limit_left(monkeypatch, default, local=False).max_jobs == default.max_jobs
    assert limit_left(monkeypatch, other).max_jobs == 60


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
    installed()
    script = PythonScript.__new__(PythonScript)
    script.source = "print(1)"
    file = io.BytesIO()
    script.write_script("preamble\n", file)
    assert file.getvalue() == FIRST_LINE + b"preamble\nprint(1)"


# -- parameters in plain form ----------------------------------------------------------------------


def test_plain_values_that_mean_the_same_are_the_same_and_others_are_refused_by_their_place():
    for value, expected in [
        ((1, [2.0, (3,)]), [1, [2, [3]]]),
        ({"b": 1, "a": np.float64(0.5)}, {"a": 0.5, "b": 1}),
        ({2: np.bool_(True), "x": None}, {"x": None, 2: True}),
        (np.int8(3), 3),
        (-0.0, 0),
    ]:
        assert repr(plain(value)) == repr(expected)
    for value, words in [
        *(({1, 2}, "set"), (Path("x"), "Path"), (np.zeros(2), "ndarray"), (b"bytes", "bytes")),
        *((math.nan, "params is nan"), ({"a": [math.inf]}, r"params.a\[0\] is inf")),
        *(({1.5: 0}, "the key 1.5"), (1j, "complex")),
    ]:
        with pytest.raises((TypeError, ValueError), match=words):
            plain(value, "params")


def test_parameters_and_files_are_told_by_names_and_places():
    assert named(listed(1, ("low", 2))) == {"0": 1, "low": 2}
    # outputs ``a=[x, y], a1=z`` are none of ``a=[x], a1=[y, z]``
    x, y, z = "xyz"
    assert groups(listed(("a", [x, y]), ("a1", z)), [x, y, z]) == {"a": [0, 1], "a1": 2}
    assert groups(listed(("a", [x]), ("a1", [y, z])), [x, y, z]) == {"a": [0], "a1": [1, 2]}
    assert groups(listed(x, ("a", y), ("b", x)), [x, y, x]) == {"": [0], "a": 1, "b": 0}
