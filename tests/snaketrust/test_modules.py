"""Python runs the code that is there, whatever it has compiled before."""

import os
import subprocess
import sys

import pytest

from snaketrust.modules import UnlikeCodeError, compile_by_content


@pytest.fixture
def module(tmp_path):
    """A module of a package, which Python has compiled once."""
    package = tmp_path / "example"
    package.mkdir()
    (package / "__init__.py").write_text("")
    path = package / "numbers.py"
    path.write_text("VALUE = 1\n")
    assert imported(tmp_path) == 1
    return path


def imported(sources) -> int:
    command = [sys.executable, "-c", "import example.numbers as n; print(n.VALUE)"]
    variables = {name: text for name, text in os.environ.items() if not name.startswith("PYTHON")}
    environment = {**variables, "PYTHONPATH": str(sources)}
    return int(subprocess.check_output(command, env=environment))


def edit_in_secret(path, text) -> None:
    """Edit a file, keeping its size and its time."""
    state = path.stat()
    assert len(text) == state.st_size
    path.write_text(text)
    os.utime(path, ns=(state.st_atime_ns, state.st_mtime_ns))


def test_an_edit_that_keeps_size_and_time_is_run(module, tmp_path):
    edit_in_secret(module, "VALUE = 2\n")
    assert imported(tmp_path) == 1  # what Python does by itself
    compile_by_content([module])
    assert imported(tmp_path) == 2
    edit_in_secret(module, "VALUE = 3\n")
    assert imported(tmp_path) == 3  # and from then on
    compile_by_content([module])
    assert imported(tmp_path) == 3


def test_a_process_that_runs_an_old_compiled_module_is_told(module, tmp_path, monkeypatch):
    loaded = type(sys)("example.numbers")
    loaded.__file__ = str(module)
    monkeypatch.setitem(sys.modules, "example.numbers", loaded)
    monkeypatch.setattr(sys, "pycache_prefix", None)
    compile_by_content([module])  # nothing is wrong
    for compiled in tmp_path.rglob("*.pyc"):
        compiled.unlink()
    assert imported(tmp_path) == 1
    edit_in_secret(module, "VALUE = 2\n")
    with pytest.raises(UnlikeCodeError, match=r"compiled numbers\.py from another"):
        compile_by_content([module])
    compile_by_content([module])
