"""The command ``burstcast``, and burstcast as others install it."""

import json
import os
import re
import shutil
import sys
import sysconfig
import zipfile
from pathlib import Path

import pytest
import yaml

import burstcast_workflow
from burstcast_workflow.commands.archive import (
    NothingToArchiveError,
    _claim_of,
    contents,
    versions,
    write_archive,
)
from burstcast_workflow.commands.command_line import main
from burstcast_workflow.project import (
    PACKAGES,
    git_revision,
    packages_of,
    project_root,
    snakefile,
)
from helpers_library import copied_repository, said_by

ROOT = Path(__file__).parents[2]


# -- what is where ---------------------------------------------------------------------------------


def test_the_project_is_found(tmp_path):
    assert project_root() == ROOT
    assert Path(snakefile()) == ROOT / "Snakefile"
    assert packages_of(ROOT) == ROOT / "src" == Path(burstcast_workflow.__path__[0]).parent
    installed = tmp_path / "site-packages" / "burstcast_workflow" / "project"
    installed.mkdir(parents=True)
    assert packages_of(installed) == tmp_path / "site-packages"


def test_a_revision_says_whether_files_differ_from_it(tmp_path):
    assert git_revision(tmp_path) == "unknown"
    (tmp_path / "file").write_text("one")
    for arguments in (["init", "-q"], ["add", "file"], ["commit", "-qm", "first"]):
        said_by([*GIT, *arguments], tmp_path)
    revision = git_revision(tmp_path)
    assert re.fullmatch("[0-9a-f]{40}", revision)
    (tmp_path / "results").write_text("not known to git")
    assert git_revision(tmp_path) == revision
    (tmp_path / "file").write_text("two")
    assert git_revision(tmp_path) == f"{revision}-dirty"
    (tmp_path / "below").mkdir()
    assert git_revision(tmp_path / "below") == "unknown"  # it is not this repository's own


# -- the command -----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ([], "required: COMMAND"),
        (["wy"], "invalid choice: 'wy'"),
        (["check-system"], "the following arguments are required: system"),
        (["settings", "more"], "settings does not know more"),
        (["archive", "--configfile", "none.yaml"], "none.yaml: there is no file of this name"),
    ],
)
def test_a_mistake_is_told_in_a_line(arguments, message, capsys):
    with pytest.raises(SystemExit) as stop:
        main(arguments)
    assert stop.value.code == 2
    last = capsys.readouterr().err.strip().splitlines()[-1]
    assert last.startswith("burstcast")
    assert message in last


def test_settings_are_the_page_and_a_system_is_checked(tmp_path, monkeypatch, capsys):
    assert main(["settings"]) == 0
    assert capsys.readouterr().out == (ROOT / "docs" / "settings.md").read_text(encoding="utf-8")
    (tmp_path / "script_that_ends.py").write_text("raise SystemExit(3)")
    monkeypatch.chdir(tmp_path)
    for system, message in (
        ("lorentz63", "did you mean 'lorenz63'"),
        ("script_that_ends:Flow", "script_that_ends:Flow ends the program: SystemExit(3)"),
    ):
        assert main(["check-system", system]) == 1
        assert message in capsys.readouterr().err


COMMAND = [sys.executable, "-m", "burstcast_workflow"]
GIT = ["git", "-c", "user.name=a", "-c", "user.email=a@example.org"]
TINY = ROOT / "workflow" / "presets" / "tiny.yaml"


def test_cleaning_removes_what_make_has_made(tmp_path):
    """Not the environment that VENV names, and nothing of the directory that make is called in."""
    beside, here, mine = (tmp_path / name for name in ("beside", "here", "mine"))
    for directory in (beside / ".venv", here / ".venv", here / ".snakemake", mine):
        directory.mkdir(parents=True)
    shutil.copy(ROOT / "Makefile", beside)
    said_by(["make", "-f", "../beside/Makefile", "clean", f"VENV={mine}"], here)
    assert sorted(path.name for path in here.iterdir()) == [".snakemake", ".venv"]
    assert (list(beside.iterdir()), mine.exists()) == ([beside / "Makefile"], True)


PAGE = (ROOT / "docs" / "installing.md").read_text(encoding="utf-8")


def test_the_page_has_all_commands(capsys):
    with pytest.raises(SystemExit):
        main(["--help"])
    commands = re.findall(r"^    ([a-z-]+)(?: |$)", capsys.readouterr().out, re.MULTILINE)
    assert sorted(re.findall(r"^\| `burstcast ([a-z-]+)", PAGE, re.MULTILINE)) == sorted(commands)
    assert len(commands) == 7


def study(directory, change=("", "")):
    """A directory with the module of the page, changed, and the tiny preset as its config."""
    (module,) = re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL)
    (directory / "Snakefile").write_text(module.replace(*change))
    shutil.copy(TINY, directory / "config.yaml")


def test_the_module_of_the_page_plans_and_tells_mistakes(tmp_path, job_server):
    study(tmp_path)
    command = ["--dry-run", "--cores", "1", "results/tiny/tables/horizon.csv"]
    outcome = job_server.snakemake(tmp_path, *command)
    assert re.search(r"^burstcast_train +4$", outcome.text, re.MULTILINE)
    options = ["-s", snakefile(), "--configfile", TINY, "--config", "random_seed=-4"]
    outcome = job_server.snakemake(tmp_path, "-n", *options)
    assert outcome.status == 1
    assert "a mistake: random_seed: Input should be greater than or equal to 0" in outcome.text
    # no lines of the rules below it, and nothing is made
    assert not re.search(r"\.smk|Traceback", outcome.text)
    assert not (tmp_path / "results").exists()


@pytest.mark.long
def test_a_study_may_have_rules_of_its_own(tmp_path):
    rule = '\nrule own:\n    output: "own.txt"\n    shell: "echo done > {output}"\n'
    study(tmp_path, (" as burstcast_*\n", f"\n{rule}"))
    profile = ["--workflow-profile", ROOT / "profiles" / "default"]
    targets = ["results/tiny/tables/horizon.csv", "own.txt"]
    plan = said_by([sys.executable, "-m", "snakemake", "-n", *profile, *targets], tmp_path)
    assert " train (4)" in plan
    snakemake = [sys.executable, "-m", "snakemake", "--cores", "1", *profile]
    figure = "results/tiny/figures/validation_strategies.png"
    output = said_by([*snakemake, "own.txt", figure], tmp_path)
    assert "100%" in output  # the handlers of the module are called
    assert "Figures: results/tiny" in output
    output = said_by([*COMMAND, "archive", "--output", "x.zip"], tmp_path)
    assert "x.zip: 7 files" in output


@pytest.mark.parametrize("command", ["archive", "explain"])
def test_a_workflow_without_rules_of_burstcast_is_told_from_others(tmp_path, command):
    (tmp_path / "Snakefile").write_text("rule own:\n    output: 'b'\n    shell: 'touch b'\n")
    said = said_by([*COMMAND, command], tmp_path, status=2)
    assert said == "this workflow has no rules of burstcast\n"


def test_snakemake_finds_nothing_to_better(job_server):
    outcome = job_server.snakemake(ROOT, "--lint")
    assert outcome.status == 0, outcome.text


# -- the archive -----------------------------------------------------------------------------------


@pytest.fixture
def results(tmp_path):
    """Results of a few files."""
    directory = tmp_path / "results" / "quick"
    for name in (
        *("tables/scores.csv", "tables/scores.tex", "figures/scores.pdf", "Re400/ensemble.nc"),
        *("report.html", "tables/.scores.csv.1.partial", "tables/.scores.csv.sha256"),
        *("tables/former.csv", "tables/notes.txt", "figures/former.pdf", "figures/.former.pdf"),
    ):
        path = directory / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(name)
    return directory


CLAIM_OF_RUN = {"revision": "a1-dirty", "linear algebra": ["a kernel"]}
KEPT = ("tables/scores.csv", "tables/scores.tex", "figures/scores.pdf", "report.html")
LISTED = (*KEPT[:3], "tables/missing.csv", "Re400/ensemble.nc")
MADE = ("config.yaml", "versions.json", "why.txt", "README.md", "CITATION.cff")


def test_an_archive_has_what_can_be_cited(results, tmp_path):
    claim = {**CLAIM_OF_RUN, "config": {"results": str(results), "random_seed": 3}}
    files = contents(results, LISTED, claim, "nothing")
    assert set(files) == {f"quick/{name}" for name in (*KEPT, *MADE)}
    config = yaml.safe_load(files["quick/config.yaml"])
    assert config == {"results": "results/quick", "random_seed": 3}
    assert str(tmp_path) not in b"".join(files.values()).decode()
    stated = json.loads(files["quick/versions.json"])
    assert CLAIM_OF_RUN.items() <= stated.items()
    assert {"numpy", "scipy", "snakemake"} <= set(stated["libraries"])


def test_equal_results_make_equal_archives(results, tmp_path):
    claim = {**CLAIM_OF_RUN, "config": {"results": "results/quick"}}
    files = contents(results, LISTED, claim, "nothing")
    packed = []
    for number, order in enumerate((sorted(files), sorted(files, reverse=True))):
        path = tmp_path / f"{number}.zip"
        write_archive(path, {name: files[name] for name in order})
        packed.append(path.read_bytes())
    with zipfile.ZipFile(path) as archive:
        assert archive.namelist() == sorted(files)
        assert {name: archive.read(name) for name in files} == files
    assert packed[0] == packed[1]
    assert not list(tmp_path.glob(".*"))


def test_an_archive_replaces_archives_alone(tmp_path):
    archived, other = tmp_path / "one.zip", tmp_path / "config.yaml"
    for number in (b"1", b"2"):
        write_archive(archived, {"quick/versions.json": number})
        with zipfile.ZipFile(archived) as archive:
            assert archive.read("quick/versions.json") == number
    other.write_text("mine")
    with zipfile.ZipFile(tmp_path / "other.zip", "w") as archive:
        archive.writestr("mine", "")
    for path in (other, tmp_path / "other.zip", tmp_path):
        with pytest.raises(NothingToArchiveError, match="no archive of a campaign"):
            write_archive(path, {"quick/versions.json": b"3"})
    assert other.read_text() == "mine"


@pytest.mark.parametrize("damage", ['{"token": ', "[1]", "{}"])
def test_an_archive_of_nothing_or_with_a_damaged_claim_is_refused(damage, tmp_path):
    with pytest.raises(NothingToArchiveError, match="neither tables nor figures"):
        contents(tmp_path, (), {}, "")
    with pytest.raises(NothingToArchiveError, match=r"no results of a campaign: it has no \.run"):
        _claim_of(tmp_path)
    claim = tmp_path / ".run.json"
    claim.write_text(damage)
    with pytest.raises(NothingToArchiveError, match=r"\.run\.json is damaged"):
        _claim_of(tmp_path)


def test_a_directory_is_packed_with_what_its_config_makes(finished, tmp_path):
    """Not what an older config has left there, which is told."""
    project = finished.copy(tmp_path / "copy")
    shutil.copy(ROOT / "CITATION.cff", project.directory)
    for name in ("tables/former.csv", "tables/former.tex", "figures/horizon_former.pdf"):
        (project.results / name).parent.mkdir(exist_ok=True)
        (project.results / name).write_text("of an older config")
    pack = [*COMMAND, "archive", "--output", tmp_path / "x.zip"]
    options = ["--configfile", TINY]
    told = "left out, as the config does not make them: tables/former.csv, tables/former.tex, "
    for arguments in (["results/tiny/"], ["results/tiny", *options], options):
        output = said_by([*pack, *arguments], project.directory, **project.environment())
        packing, others = output.splitlines()
        assert packing.startswith(f"{tmp_path / 'x.zip'}: ")
        assert others == told + "figures/horizon_former.pdf"
        with zipfile.ZipFile(tmp_path / "x.zip") as archive:
            packed = {name: archive.read(f"tiny/{name}").decode() for name in PACKED}
            assert not [name for name in archive.namelist() if "former" in name]
        made = (project.results / "tables/horizon.csv").read_text()
        assert packed["tables/horizon.csv"] == made
        # the figures, which nobody has made yet, and nothing for another reason
        assert re.findall(r"^(.*?):", packed["why.txt"], re.M) == ["results are missing (Re400)"]
        assert yaml.safe_load(packed["config.yaml"])["results"] == "results/tiny"


PACKED = ("tables/horizon.csv", "why.txt", "config.yaml")


# -- rules -----------------------------------------------------------------------------------------


def test_a_rule_is_explained_with_its_settings_and_where_it_ends(finished):
    command = [*COMMAND, "explain", "horizon", "long_control", "--configfile", TINY]
    text = said_by(command, finished.directory, **finished.environment())
    horizon, long_control = text.replace("\n  ", " ").split("\n## long_control\n")
    assert "* makes `{case}/{family}/{forecaster}/horizon.nc`\n" in horizon
    assert "`event_threshold` (event_threshold), `forecaster` (fit, train), " in horizon
    assert "`horizon.longest_lead_time_lt`, `horizon.tolerance`, `random_seed`" in horizon
    assert "`burstcast.forecasts` (forecast_files, horizon)" in horizon
    assert re.search(r"\* ends in the tables horizon(, \w+)*; the figures ", horizon)
    assert "* no job in this campaign\n" in long_control
    # with how values follow that are not in the config as they are
    plans = [*COMMAND, "explain", "control", "--configfile", TINY]
    control = said_by(plans, finished.directory, **finished.environment()).replace("\n  ", " ")
    assert "* `control.run`: Plan of control; the noise is the case's if it has none" in control
    assert "* `control.flows`" not in control
    mistaken = [*COMMAND, "explain", "horizons", "--configfile", TINY]
    said = said_by(mistaken, finished.directory, status=2, **finished.environment())
    assert "there is no rule horizons (did you mean 'horizon'?)" in said


def test_the_page_of_rules_has_all_of_them_with_their_settings():
    text = (ROOT / "docs" / "rules.md").read_text(encoding="utf-8")
    rules = (ROOT / "workflow" / "rules").glob("*.smk")
    written = "".join(path.read_text(encoding="utf-8") for path in rules)
    for name, body in re.findall(r"^rule (\w+):\n((?: .*\n|\n)*)", written, re.M):
        if "script:" not in body:
            continue
        (section,) = re.findall(rf"^## {name}\n(.*?)(?=^## |\Z)", text, re.M | re.S)
        for settings in re.findall(r"settings=settings\((.*?)\n?\s*\)", body, re.S):
            for path in re.findall(r'^\s+"([\w.]+)",$', settings, re.M):
                assert f"`{path}`" in section, f"{name}: make pages"


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["a", "b"], "one directory at a time, not a, b"),
        (["a"], "a holds no results of a campaign: it has no .run.json"),
        (["a", "--configfile", TINY], "the config makes results/tiny, seen from ..., and not a"),
        (["--no-such-option"], "unrecognized arguments: --no-such-option"),
    ],
)
def test_a_directory_that_cannot_be_packed_is_told(arguments, message, tmp_path):
    for name in "ab":
        (tmp_path / name).mkdir()
    command = [*COMMAND, "archive", "-s", ROOT / "Snakefile", *arguments]
    output = said_by(command, tmp_path, status=2)
    assert message.replace("...", str(tmp_path)) in output


def test_a_run_says_its_revision_and_files_do_not(finished):
    """Equal runs of different revisions have the same bits: only the claim tells them apart."""
    claim = json.loads((finished.results / ".run.json").read_bytes())
    assert {name: versions(claim)[name] for name in CLAIM_OF_RUN} == {
        name: claim[name] for name in CLAIM_OF_RUN
    }
    path = finished.results / "Re400/networks/esn-N40-RV-seed0/forecaster.nc"
    if claim["revision"] != "unknown":
        assert claim["revision"][:40].encode() not in path.read_bytes()


# -- the wheel -------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def installed(tmp_path_factory):
    """The programs of an environment with a wheel of burstcast, and the libraries that are here."""
    directory = tmp_path_factory.mktemp("wheel")
    copy = copied_repository(directory / "source")
    for arguments in (["init", "-q"], ["add", "-A"], ["commit", "-qm", "sources"]):
        said_by([*GIT, *arguments], copy)
    pip = [sys.executable, "-m", "pip", "--disable-pip-version-check"]
    said_by([*pip, "wheel", "-q", "--no-deps", "-w", directory, copy], directory)
    (wheel,) = directory.glob("*.whl")
    said_by([sys.executable, "-m", "venv", directory / "venv"], directory)
    (site,) = (directory / "venv" / "lib").glob("python*/site-packages")
    (site / "environment.pth").write_text(sysconfig.get_path("purelib") + "\n")
    programs = directory / "venv" / "bin"
    install = [programs / "pip", "install", "-q", "--no-deps", "--no-index", wheel]
    said_by(install, directory)
    return programs


@pytest.mark.long
def test_the_tiny_campaign_runs_from_a_wheel_in_an_empty_directory(installed, tmp_path, finished):
    path = f"{installed}:{os.environ['PATH']}"
    environment = {"PATH": path, "PYTHONPATH": "", "PYTHONDONTWRITEBYTECODE": ""}
    python = installed / "python"
    code = "from burstcast_workflow.project import source_revision as f; print(f())"
    assert re.fullmatch("[0-9a-f]{40}\n", said_by([python, "-c", code], tmp_path, **environment))
    place = "import burstcast_workflow.project as p; print(p.project_root())"
    root = Path(said_by([python, "-c", place], tmp_path, **environment).strip())
    assert root.parents[1].name == "site-packages"
    study = tmp_path / "my-study"
    study.mkdir()
    options = ["-s", root / "Snakefile", "--configfile", root / "workflow/presets/tiny.yaml"]
    snakemake = [python, "-m", "snakemake", "--cores", "2"]
    said_by([*snakemake, "tables", *options], study, **environment)
    # the same numbers as from a working copy
    for name in ("tables/horizon.csv", "tables/classification.csv", "tables/control.csv"):
        expected = (finished.results / name).read_bytes()
        assert (study / "results" / "tiny" / name).read_bytes() == expected
    why = [python, "-m", "snakemake", "-n", "tables", *options]
    assert "Nothing to be done" in said_by(why, study, **environment)
    # sources are verified: those of the installed package, and of no other library
    claim = json.loads((study / "results" / "tiny" / ".run.json").read_bytes())
    packages = {
        entry.partition(" ")[0].partition(".")[0]
        for entry in claim["code"]
        if not entry.partition(" ")[0].endswith(".py")
    }
    assert packages == set(PACKAGES)
    edited = root.parents[1] / "burstcast" / "data" / "events.py"
    edited.write_text(edited.read_text().replace(">= threshold", "> threshold"))
    assert "code of burstcast.data.events (Re400)" in said_by(why, study, **environment)
    output = said_by(["burstcast", "archive", *options], study, **environment)
    assert re.search(r"tiny.zip: \d\d files", output)
