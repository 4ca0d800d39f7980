import os
import time

from burstcast_workflow.harness.failures import failure_summary


def write(path, text, age=0.0):
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text)
    os.utime(path, (time.time() - age, time.time() - age))
    return path


def test_nothing_failed(tmp_path):
    write(tmp_path / "logs" / "train" / "a.log", "starts\nINFO train (seed=1) is done: 1.00 s\n")
    assert failure_summary(tmp_path / "logs", tmp_path / "none", time.time() - 60) == ""


def test_ends_of_the_logs_of_failed_and_killed_jobs_in_the_order_of_time(tmp_path):
    lines = "".join(f"line {number}\n" for number in range(50))
    failed = write(tmp_path / "logs" / "b.log", lines + "ValueError: bad\n", age=20)
    killed = write(tmp_path / "logs" / "a.log", "", age=10)
    write(tmp_path / "logs" / "fine.log", "x is done: 1 s\n\n", age=5)
    of_slurm = write(tmp_path / "slurm" / "group" / "7.log", "exceeded memory limit\n")
    text = failure_summary(tmp_path / "logs", tmp_path / "slurm", time.time() - 60)
    assert text.index(str(failed)) < text.index(str(killed)) < text.index(str(of_slurm))
    assert "ValueError: bad" in text
    assert "(empty)" in text
    assert "exceeded memory limit" in text
    assert "line 49" in text
    assert "line 39\n" in text  # twelve lines in all
    assert "line 38\n" not in text
    assert "fine.log" not in text


def test_logs_of_earlier_runs_do_not_count(tmp_path):
    write(tmp_path / "logs" / "old.log", "ValueError: long ago\n", age=3600)
    assert failure_summary(tmp_path / "logs", tmp_path / "none", time.time() - 60) == ""


def test_many_failures_are_listed_by_name_only(tmp_path):
    for number in range(25):
        write(tmp_path / "logs" / f"{number}.log", f"reason {number}\n", age=100 - number)
    text = failure_summary(tmp_path / "logs", tmp_path / "none", time.time() - 1000)
    assert "reason 0" in text
    assert "15 more" in text
    assert "24.log" in text
    assert "reason 24" not in text
