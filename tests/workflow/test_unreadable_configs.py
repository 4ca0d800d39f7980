"""A config file that cannot be read is told in one line, with its name."""

import subprocess
import sys
from pathlib import Path

import pytest

from snakemake_logger_plugin_burstcast.config_files import unreadable_config

ROOT = Path(__file__).parents[2]


@pytest.fixture
def directory(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "good.yaml").write_text("results: results/x\n")
    (tmp_path / "bad.yaml").write_text("results: results/x\ncampaign: [\n  - a: b: c\n")
    (tmp_path / "tab.yaml").write_text("search:\n\tgrid: 3\n")
    (tmp_path / "empty.yaml").write_text("# nothing\n")
    return tmp_path


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["-n"], None),
        (["--configfile", "good.yaml", "-n"], None),
        (["table", "--cores", "2", "--configfiles", "good.yaml"], None),
        (["--configfile", "none.yaml"], "--configfile none.yaml: there is no file of this name"),
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
def test_what_is_wrong_is_said_in_one_line(directory, arguments, said):
    found = unreadable_config(arguments)
    if said is None:
        assert found is None
    else:
        assert found.startswith(said)
        assert "\n" not in found


def test_the_workflows_own_config_is_looked_at_too(directory):
    (directory / "config.yaml").write_text("a: 1\nb: {\n")
    assert unreadable_config([]).startswith("config.yaml, line 3, column 1: no valid YAML: ")
    (directory / "config.yaml").write_bytes(b"a: \xff\n")
    assert unreadable_config([]).startswith("config.yaml: cannot be read: ")
    (directory / "config.yaml").write_text("a: 1\n")
    assert unreadable_config([]) is None


def test_snakemake_says_it_without_a_traceback(directory):
    run = [str(Path(sys.executable).with_name("snakemake")), "-n", "--configfile"]
    outcome = subprocess.run(
        [*run, str(directory / "bad.yaml")], cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert outcome.returncode == 1
    assert "Traceback" not in outcome.stderr
    assert f"{directory / 'bad.yaml'}, line 3, column 3: no valid YAML: " in outcome.stderr
