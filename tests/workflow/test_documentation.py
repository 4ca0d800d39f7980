"""README and docs: every command is one that runs, every link leads somewhere, lines are short."""

import pkgutil
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
import yaml
from helpers_rebuilds import Project
from helpers_rules import predicted_costs

ROOT = Path(__file__).parents[2]
PAGES = sorted([ROOT / "README.md", *(ROOT / "docs").glob("*.md")])
NAMES = [str(page.relative_to(ROOT)) for page in PAGES]
# programs of the reader's system, which no test can run
OF_OTHERS = ("squeue", "scancel", "sacct", "tail", "ls", "find", "export", "git", "cd")
# what takes long by itself, and is run elsewhere or by hand
ELSEWHERE = ("tutorial.md",)  # it has a test of its own
TAKES_LONG = ("test", "test-long", "test-slurm", "bench", "check")


def blocks(language):
    """Blocks of code in a language, by their page."""
    for page in PAGES:
        for match in re.finditer(
            rf"^( *)```{language}\n(.*?)^ *```$", page.read_text(), re.S | re.M
        ):
            lines = [line.removeprefix(match[1]) for line in match[2].splitlines()]
            yield page, "\n".join(lines)


def commands():
    """All lines of shell in the documentation, without their comments."""
    for page, text in blocks("sh"):
        if page.name in ELSEWHERE:
            continue
        for line in text.replace("\\\n", " ").splitlines():
            command = re.sub(r"(^|\s+)# .*$", "", line).strip()
            if command:
                yield pytest.param(command, id=f"{page.name}: {command}")


@pytest.fixture(scope="module")
def project(tmp_path_factory):
    """The project's sources, with the files that the documentation has its readers write."""
    made = Project.create(tmp_path_factory.mktemp("documented") / "project")
    shutil.copy2(ROOT / "Makefile", made.directory)
    for _, text in blocks("yaml"):
        if name := re.match(r"# (\S+\.yaml)$", text.partition("\n")[0]):
            (made.directory / name[1]).parent.mkdir(exist_ok=True)
            (made.directory / name[1]).write_text(f"{text}\n")
    return made


def planned(project, arguments):
    """Plan what options of snakemake ask for; the text of the plan."""
    options = [word for word in arguments if word not in ("-n", "--dry-run")]
    result = subprocess.run(
        [sys.executable, "-m", "snakemake", *options, "-n", "--quiet", "rules"],
        cwd=project.directory,
        env=project.environment(),
        capture_output=True,
        text=True,
        check=False,
    )
    assert result.returncode == 0, result.stdout + result.stderr
    return result.stdout


def what_make_runs(project, words):
    """Lines of a target's recipe, which make would run."""
    result = subprocess.run(
        ["make", "-n", *words, "-o", ".venv/installed"],
        cwd=project.directory,
        capture_output=True,
        text=True,
        check=False,
    )
    assert result.returncode == 0, result.stderr
    return result.stdout.splitlines()


def tried(project, command):
    """Run a command as far as a test can: what Snakemake would do is planned."""
    words = shlex.split(command)
    while re.fullmatch(r"[A-Z_]+=\S*", words[0]):
        del words[0]
    program = words[0]
    if program == "make":
        lines = what_make_runs(project, words[1:])
        assert lines
        if not set(words) & set(TAKES_LONG):
            for line in lines:
                if line.startswith(".venv/"):
                    tried(project, line)
    elif program == ".venv/bin/snakemake":
        if "profiles/slurm" in words:  # its executor need not be there (tests/slurm)
            place = words.index("--workflow-profile")
            del words[place : place + 2]
        if "--unlock" not in words:
            planned(project, words[1:])
    elif words[:2] == [".venv/bin/python", "-m"] or program == ".venv/bin/burstcast":
        if program.endswith("burstcast"):
            words = ["", "-m", "burstcast_workflow.commands.command_line", *words[1:]]
        result = subprocess.run(
            [sys.executable, *words[1:]],
            cwd=project.directory,
            env=project.environment(),
            capture_output=True,
            text=True,
            check=False,
        )
        assert result.returncode == 0, result.stderr
    elif program.startswith(".venv/bin/"):  # pytest, pip: their files are there
        files = [word for word in words[1:] if word.startswith(("tests/", "benchmarks/"))]
        assert all((ROOT / name).exists() for name in files)
    elif program == "for":
        (loop,) = re.findall(r"do (.*?); done", command)
        tried(project, loop.replace("$part", "1"))
    else:
        assert program in OF_OTHERS, program


@pytest.mark.long
@pytest.mark.parametrize("command", list(commands()))
def test_every_command_runs(project, command):
    tried(project, command)


def test_there_are_commands_and_files_of_the_reader():
    assert len(list(commands())) > 15
    named = [text.partition("\n")[0] for _, text in blocks("yaml")]
    assert "# studies/more.yaml" in named
    for _, text in blocks("yaml"):
        yaml.safe_load(text)


@pytest.mark.parametrize("name", NAMES)
def test_lines_are_short(name):
    long = [
        f"{number}: {line}"
        for number, line in enumerate((ROOT / name).read_text().splitlines(), 1)
        if len(line) > 100 and not line.lstrip().startswith("|")
    ]
    assert long == []


def test_readme_is_short():
    assert len((ROOT / "README.md").read_text().splitlines()) < 100


@pytest.mark.parametrize("name", NAMES)
def test_links_lead_somewhere(name):
    page = ROOT / name
    links = re.findall(r"\]\(([^)#\s]+)\)|^\[[^\]]+\]: (\S+)", page.read_text(), re.M)
    for link in (first or second for first, second in links):
        if not link.startswith("http"):
            assert (page.parent / link).exists(), link


def test_every_page_is_in_the_index():
    index = (ROOT / "docs" / "README.md").read_text()
    pages = {page.name for page in (ROOT / "docs").glob("*.md")} - {"README.md"}
    assert pages == set(re.findall(r"\]\((\S+\.md)\)", index))


def test_what_the_demo_is_said_to_take():
    """A few minutes on two cores, by the cost model."""
    jobs = predicted_costs(["--configfile", str(ROOT / "workflow/presets/quick.yaml")])
    assert jobs["predicted_minutes"].sum() < 8


@pytest.mark.parametrize("name", NAMES)
def test_what_pages_name_in_the_library_is_there(name):
    """``burstcast.statistics.neighbour_divergence``, whatever room it has moved to."""
    for dotted in set(re.findall(r"\bburstcast(?:\.[A-Za-z_]\w*){2,}", (ROOT / name).read_text())):
        assert pkgutil.resolve_name(dotted) is not None, dotted
