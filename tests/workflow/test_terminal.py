"""What a person sees of a run: progress, failures, and configs that cannot be read."""

import io
import logging
from types import SimpleNamespace

import pytest
from helpers_configs import ROOT
from snakemake.persistence import ParamsChange
from snakemake.settings.enums import Quietness
from snakemake_interface_logger_plugins.common import LogEvent

from snakemake_logger_plugin_burstcast import terminal
from snakemake_logger_plugin_burstcast.config_files import unreadable_config
from snakemake_logger_plugin_burstcast.terminal import (
    Progress,
    TerminalHandler,
    counted,
    duration,
)


def test_durations_and_numbers_in_words():
    words = {0.2: "0 s", 59.4: "59 s", 61: "1 min 01 s", 3599.6: "1 h 00 min", 7500: "2 h 05 min"}
    assert {seconds: duration(seconds) for seconds in words} == words
    assert [counted(number) for number in (0, 1, 2)] == ["0 jobs", "1 job", "2 jobs"]


def jobs(*seconds, rule="train"):
    return {number: (rule, time) for number, time in enumerate(seconds, 1)}


def finished(progress, *intervals):
    for job, (begin, end) in intervals:
        progress.start(job, begin)
        progress.finish(job, end)


def test_time_left_goes_from_earlier_seconds_to_measured_ones():
    progress = Progress(jobs(20.0, 20.0, 20.0), cores=2, started=0.0)
    assert progress.remaining(0.0) == pytest.approx(30.0)
    finished(progress, (1, (0.0, 20.0)), (2, (0.0, 80.0)))
    # two jobs took 100 seconds on one of the cores: the third will take 50, on two cores 25; by the
    # pace of the run, 100 seconds of work in 80, it will take 40
    assert progress.share(80.0) == pytest.approx(2 / 3)
    assert progress.remaining(80.0) == pytest.approx(25.0 / 3 + 40.0 * 2 / 3)
    assert progress.line(80.0) == " 67%  2 of 3 jobs, about 35 s left"
    progress.finish(3, 100.0)
    assert progress.line(100.0) == "100%  3 of 3 jobs"


def test_finished_jobs_correct_the_time_of_their_own_rule_and_the_share_never_falls():
    progress = Progress({**jobs(1.0, 1.0), 3: ("search", 8.0)}, cores=1, started=0.0)
    progress.start(1, 0.0)
    assert [progress.remaining(now) for now in (0.0, 0.5)] == [10.0, 9.5]
    progress.finish(1, 2.0)
    assert progress.share(2.0) == pytest.approx(2 / (2 + 2 + 8))
    finished(progress, (2, (2.0, 60.0)))
    assert progress.share(60.0) == pytest.approx(60 / 68)
    progress.start(3, 60.0)
    assert progress.remaining(64.0) == pytest.approx(4.0)
    unequal = Progress(jobs(1.0, 1.0, 1.0), cores=1, started=0.0)
    shares = []
    for job, now in ((1, 1.0), (2, 100.0), (3, 101.0)):
        finished(unequal, (job, (0.0, now)))
        shares.append(unequal.share(now))
    assert shares == sorted(shares)


def test_nothing_is_said_before_anything_is_known():
    progress = Progress({1: ("train", None), 2: ("scan", None), 3: ("scan", 5.0)}, 1, 0.0)
    assert progress.remaining(0.0) is None
    assert progress.line(0.0) == "  0%  0 of 3 jobs"
    finished(progress, (1, (0.0, 3.0)))
    # of a rule of which nothing is known: as all jobs in the mean
    assert progress.share(3.0) == pytest.approx(3 / (3 + 3 + 5))


@pytest.fixture
def handler(monkeypatch):
    monkeypatch.setattr(terminal, "_interruption", type(terminal._interruption)())
    rule = SimpleNamespace(name="train")
    expected = [SimpleNamespace(jobid=number, rule=rule, output=["a"]) for number in range(1, 101)]
    terminal.expect(expected, {"train": 1.0})
    settings = SimpleNamespace(quiet=None, stdout=False, dryrun=False, verbose=False)
    made = TerminalHandler(settings, None)
    made._stream = io.StringIO()
    made._live = False
    yield made
    terminal.expect([], {})


def send(handler, message="", event=None, level=logging.INFO, **fields):
    record = logging.LogRecord("snakemake", level, "", 0, message, None, None)
    record.__dict__.update(fields, **({} if event is None else {"event": event}))
    handler.emit(record)


def run_of_a_hundred_jobs(handler, failing=()):
    send(handler, "Provided cores: 4", LogEvent.RESOURCES_INFO, cores=4)
    for number in range(1, 101):
        label = {"jobid": number, "rule_name": "train", "output": ["network.nc"]}
        label["wildcards"] = {"case": "Re400", "number": number}
        send(handler, event=LogEvent.JOB_INFO, **label)
        if number in failing:
            error = {**label, "log": ["logs/train.log"]}
            send(handler, "", LogEvent.JOB_ERROR, logging.ERROR, **error)
            send(handler, "CalledProcessError in file x, line 3", level=logging.ERROR)
        else:
            send(handler, event=LogEvent.JOB_FINISHED, job_id=number)
    target = {"jobid": 0, "rule_name": "all", "output": []}
    send(handler, event=LogEvent.JOB_INFO, **target)
    send(handler, event=LogEvent.JOB_FINISHED, job_id=0)
    return handler._stream.getvalue().splitlines()


@pytest.mark.parametrize("failing", [(), (7,)])
def test_a_hundred_jobs_are_a_few_lines_and_a_failure_is_said_once(handler, failing):
    lines = run_of_a_hundred_jobs(handler, failing)
    assert lines[0] == "100 jobs, about 25 s on 4 cores"
    assert len(lines) <= 27
    expected = [f"FAILED  train Re400 {number} (log: logs/train.log)" for number in failing]
    assert [line for line in lines if "FAILED" in line] == expected
    assert not any("CalledProcessError" in line for line in lines)
    if not failing:
        assert [line for line in lines if "100%" in line] == ["100%  100 of 100 jobs"] == lines[-1:]


def test_messages_that_a_person_wants(handler):
    send(handler, "Building DAG of jobs...")
    send(handler, "Nothing to be done (all requested files are present and up to date).")
    send(handler, "the disk is nearly full", level=logging.WARNING)
    assert handler._stream.getvalue().splitlines() == [
        "Nothing to be done (all requested files are present and up to date).",
        "the disk is nearly full",
    ]


@pytest.mark.parametrize(("verbose", "one_job"), [(False, True), (True, True), (False, False)])
def test_a_dry_run_is_its_reasons_and_all_jobs_on_demand(handler, verbose, one_job):
    handler.common_settings.dryrun, handler.common_settings.verbose = True, verbose
    change = ParamsChange({repr({"a": 1})}, {repr({"a": 2})}, {"a"})
    reason = f"Params have changed since last execution: {change}"
    job = {**JOB, "input": [], "reason": reason}
    if one_job:
        send(handler, event=LogEvent.JOB_INFO, **job, **OTHERS)
    send(handler, event=LogEvent.JOB_INFO, **{**job, "output": [], "rule_name": "all"}, **OTHERS)
    send(handler, "a warning", level=logging.WARNING)
    send(handler, "Job stats: ...", LogEvent.RUN_INFO, stats={"total": 1})
    send(handler, "This was a dry-run (flag -n). The order of jobs ...")
    output = handler._stream.getvalue()
    assert ("This was a dry-run" in output) == verbose
    reasons = "a 1 -> 2 (Re400): train (1)\nin all 1 job\n" if one_job else "Nothing to be done\n"
    assert (reasons in output) == (not verbose)
    assert "a warning" in output


def test_a_dry_run_that_tells_no_jobs_counts_them(handler):
    handler.common_settings.dryrun, handler.common_settings.verbose = True, False
    handler.common_settings.quiet = {Quietness.RULES}
    table = "Job stats:\njob      count\n-----  -------\ntrain        2\ntotal        2\n"
    send(handler, table, LogEvent.RUN_INFO, stats={"train": 2, "total": 2})
    send(handler, "This was a dry-run (flag -n). The order of jobs ...")
    output = handler._stream.getvalue()
    assert "train        2\ntotal        2\n" in output
    assert "Nothing to be done" not in output
    assert "in all" not in output


# what else Snakemake says of a job
OTHERS = dict.fromkeys(("rule_msg", "log", "benchmark", "threads", "resources", "priority"))
OTHERS |= dict.fromkeys(("local", "indent", "is_checkpoint", "is_handover", "shellcmd"), False)


def test_an_interruption_is_one_line(handler):
    assert not terminal.interrupted()
    send(handler, "Terminating processes on user request, this might take some time.")
    job = {"jobid": 3, "rule_name": "train", "log": ["a.log"]}
    send(handler, "", LogEvent.JOB_ERROR, logging.ERROR, **job)
    send(handler, "Cancelling snakemake on user request.", level=logging.ERROR)
    send(handler, "CalledProcessError in file x", level=logging.ERROR)
    assert terminal.interrupted()
    assert handler._stream.getvalue().splitlines() == [
        "interrupted; what is done stays, the same command goes on from here"
    ]


JOB = {"jobid": 1, "rule_name": "train", "output": ["a"], "wildcards": {"case": "Re400"}}


def test_the_line_of_a_terminal_renews_itself(handler):
    handler._live = True
    send(handler, event=LogEvent.JOB_INFO, **JOB)
    send(handler, "something is odd", level=logging.WARNING)
    text = handler._stream.getvalue()
    assert "train Re400" in text
    assert text.endswith("\r\x1b[Ksomething is odd\n")
    assert text.count("\n") == 2  # the plan and the warning


def test_a_silent_minute_ends_with_what_runs(handler, monkeypatch):
    send(handler, event=LogEvent.JOB_INFO, **JOB)
    before = handler._stream.getvalue()
    handler.beat()
    assert handler._stream.getvalue() == before  # a line has just been written
    now = terminal.time.monotonic()
    monkeypatch.setattr(terminal.time, "monotonic", lambda: now + 61.0)
    handler.beat()
    (line,) = handler._stream.getvalue().removeprefix(before).splitlines()
    assert line.endswith("left  train Re400 (1 min 01 s)")


# -- configs that cannot be read -------------------------------------------------------------------


@pytest.fixture
def directory(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "good.yaml").write_text("results: results/x\n")
    (tmp_path / "bad.yaml").write_text("results: results/x\ncampaign: [\n  - a: b: c\n")
    (tmp_path / "tab.yaml").write_text("search:\n\tgrid: 3\n")
    (tmp_path / "empty.yaml").write_text("# nothing\n")
    return tmp_path


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["-n"], None),
        (["--configfile", "good.yaml", "-n"], None),
        (["table", "--cores", "2", "--configfiles", "good.yaml"], None),
        (["--configfile", "."], "--configfile .: there is a directory of this name"),
        (["--configfile=none.yaml"], "--configfile none.yaml: there is no file of this name"),
        (
            ["--configfile", "good.yaml", "tables"],
            "--configfile tables: there is no file of this name; --configfile takes all words "
            "after it: put targets before it",
        ),
        (["--configfile", "good.yaml", "bad.yaml"], "bad.yaml, line 3, column 3: no valid YAML: "),
        (["--configfile", "tab.yaml"], "tab.yaml, line 2, column 1: no valid YAML: there is a tab"),
        (["--configfile", "empty.yaml"], "empty.yaml: holds no settings: a config is lines such"),
    ],
)
def test_what_is_wrong_is_said_in_one_line(directory, arguments, message):
    problem = unreadable_config(arguments)
    assert problem is None if message is None else problem.startswith(message)
    assert "\n" not in (problem or "")
    # the workflow's own config is looked at, too
    (directory / "config.yaml").write_bytes(b"a: \xff\n")
    assert unreadable_config([]).startswith("config.yaml: cannot be read: ")


def test_snakemake_says_it_without_a_traceback(directory, job_server):
    outcome = job_server.snakemake(ROOT, "-n", "--configfile", directory / "bad.yaml")
    assert outcome.status == 1
    assert "Traceback" not in outcome.text
    assert f"{directory / 'bad.yaml'}, line 3, column 3: no valid YAML: " in outcome.text
