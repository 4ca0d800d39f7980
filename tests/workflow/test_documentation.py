"""README, docs and site: commands run, links lead somewhere, pages show what is kept."""

import pkgutil
import re
import shutil
import sys
from textwrap import dedent

import numpy as np
import pandas as pd
import pytest
import yaml
from helpers_configs import ROOT
from helpers_rebuilds import Project

from burstcast.figures.registry import available_figures
from helpers_library import assert_same_picture, said_by

PAGES = sorted(ROOT.glob("README.md")) + sorted((ROOT / "docs").glob("*.md"))
PAGES += sorted((ROOT / "docs" / "results").glob("*.md"))
NAMES = [str(page.relative_to(ROOT)) for page in PAGES]
# the one has a test of its own, the other takes data from packages that no test installs
ELSEWHERE = ("tutorial.md", "real_records.md")
TAKES_LONG = "test test-long test-slurm bench check"
# Programs of the reader: what computes is planned; those of a cluster or the system do nothing.
PROGRAMS = {
    "snakemake": """
        #!{python}
        import os, sys
        words = [word for word in sys.argv[1:] if word not in ("-n", "--dry-run")]
        if "--unlock" in words:
            sys.exit()
        if "profiles/slurm" in words:  # its executor need not be there (tests/slurm)
            place = words.index("--workflow-profile")
            del words[place : place + 2]
        plan = [sys.executable, "-m", "snakemake", "-n", "--quiet=rules", *words]
        os.execv(sys.executable, plan)
        """,
    "burstcast": """
        #!/bin/sh
        exec {python} -m burstcast_workflow.commands.command_line "$@"
        """,
    "python": """
        #!/bin/sh
        case $1 in -m | -c) exec {python} "$@" ;; esac
        test -e "{root}/$1"
        """,
    "pytest": """
        #!/bin/sh
        for word; do
            case $word in tests/* | benchmarks/*) test -e "{root}/$word" || exit 1 ;; esac
        done
        """,
    "make": """
        #!/bin/sh
        for word; do
            case " {long} " in *" $word "*) set -- -n "$@" ;; esac
        done
        exec {make} MAKE="$0" -o .venv/installed -o .venv/developed -o .venv/documented "$@"
        """,
    "git": """
        #!/bin/sh
        test "$1" != clone || ln -s . burstcast
        """,
    **dict.fromkeys(("pip", "squeue", "scancel", "sacct", "tail", "ls", "find"), "#!/bin/sh"),
}


def blocks(language):
    """Blocks of code in a language, by their page."""
    for page in PAGES:
        for match in re.finditer(
            rf"^( *)```{language}\n(.*?)^ *```$", page.read_text(), re.S | re.M
        ):
            lines = [line.removeprefix(match[1]) for line in match[2].splitlines()]
            yield page, "\n".join(lines)


def commands():
    """All blocks of shell in the documentation, with placeholders filled in."""
    for page, text in blocks("sh"):
        if page.name not in ELSEWHERE:
            filled = re.sub(r"<[^>\n]+>", "ID", text).replace("seq 10", "seq 1")
            yield pytest.param(filled, id=f"{page.name}: {text.splitlines()[0]}")


@pytest.fixture(scope="module")
def project(tmp_path_factory):
    """The project's sources, with the files that the documentation has its readers write."""
    made = Project.create(tmp_path_factory.mktemp("documented") / "project")
    shutil.copy2(ROOT / "Makefile", made.directory)
    shutil.copytree(ROOT / "examples", made.directory / "examples", dirs_exist_ok=True)
    for page in PAGES:
        pattern = r"`(studies/\S+\.py)`[^`]*```python\n(.*?)^ *```$"
        for name, text in re.findall(pattern, page.read_text(), re.S | re.M):
            (made.directory / name).parent.mkdir(parents=True, exist_ok=True)
            (made.directory / name).write_text(text)
    for _, text in blocks("yaml"):
        if name := re.match(r"# (\S+\.yaml)$", text.partition("\n")[0]):
            (made.directory / name[1]).parent.mkdir(parents=True, exist_ok=True)
            (made.directory / name[1]).write_text(f"{text}\n")
    programs = made.directory / ".venv" / "bin"
    programs.mkdir(parents=True)
    known = {"python": sys.executable, "root": ROOT, "make": shutil.which("make")}
    for name, text in PROGRAMS.items():
        (programs / name).write_text(dedent(text).lstrip().format(**known, long=TAKES_LONG))
        (programs / name).chmod(0o755)
    return made


def run_in(project, command):
    """What a command of the documentation says, where it succeeds."""
    environment = project.environment()
    environment["PATH"] = f"{project.directory}/.venv/bin:{environment['PATH']}"
    return said_by(["bash", "-eu", "-c", command], project.directory, **environment)


@pytest.mark.long
@pytest.mark.parametrize("command", list(commands()))
def test_every_command_runs(project, command):
    run_in(project, command)


def test_there_are_commands_and_files_of_the_reader():
    assert len(list(commands())) > 10
    named = [text.partition("\n")[0] for _, text in blocks("yaml")]
    assert "# studies/more.yaml" in named
    for _, text in blocks("yaml"):
        yaml.safe_load(text)


@pytest.mark.parametrize("name", NAMES)
def test_lines_are_short_and_links_and_names_lead_somewhere(name):
    page, text = ROOT / name, (ROOT / name).read_text()
    wide = [line for line in text.splitlines() if len(line) > 100]
    assert [line for line in wide if not line.lstrip().startswith("|")] == []
    assert not re.search(r"^ *%", text, re.M)  # Sphinx would take it for a comment
    links = re.findall(r"\]\(([^)#\s]+)\)|^\[[^\]]+\]: (\S+)", text, re.M)
    for link in (first or second for first, second in links):
        if not link.startswith("http"):
            assert (page.parent / link).exists(), link
    # ``burstcast.statistics.neighbour_divergence``, whatever room it has moved to
    for dotted in set(re.findall(r"\bburstcast(?:\.[A-Za-z_]\w*){2,}", text)):
        assert pkgutil.resolve_name(dotted) is not None, dotted


def test_the_readme_is_short_and_every_page_in_the_index():
    assert len((ROOT / "README.md").read_text().splitlines()) < 100
    index = (ROOT / "docs" / "README.md").read_text()
    pages = {page.name for page in (ROOT / "docs").glob("*.md")} - {"README.md"}
    assert pages == set(re.findall(r"\]\((\S+\.md)\)", index))


@pytest.mark.long
def test_the_site_is_built(tmp_path):
    said_by([sys.executable, ROOT / "docs/site/build.py", "--output", tmp_path / "site"], ROOT)
    assert "vorticity_isosurfaces.png" in (tmp_path / "site" / "figures.html").read_text()


# -- references and kept numbers -------------------------------------------------------------------


def test_the_page_of_references_has_each_work_that_is_cited_and_no_other():
    script = ROOT / "docs" / "site" / "references.py"
    page = (ROOT / "docs" / "references.md").read_text()
    assert page == said_by([sys.executable, script], ROOT)
    works = re.findall(r"^@\w+\{(\w+),$", (ROOT / "docs" / "references.bib").read_text(), re.M)
    assert re.findall(r"^## (\w+)$", page, re.M) == sorted(works)
    cited = r"\]\((?:docs/)?references\.md#(\w+)\)"
    assert {key for page in PAGES for key in re.findall(cited, page.read_text())} == set(works)


def test_costs_on_the_page_of_performance_are_those_of_the_kept_tables():
    page = " ".join((ROOT / "docs" / "performance.md").read_text().split())
    costs = pd.read_csv(ROOT / "docs" / "results" / "paper" / "rule_costs.csv").set_index("rule")
    minutes, networks = costs["minutes"], ["scan", "search", "train"]
    assert (
        f"took {minutes.sum():.0f} minutes of its {costs['jobs'].sum():,} jobs, "
        f"{minutes[networks].sum():.0f} of them for the scans, searches and training" in page
    )
    assert f"no job used more than {costs['memory_mib'].max() / 1024:.1f} GiB" in page
    rows = [
        [cell.strip() for cell in line.strip("|").split("|")]
        for line in (ROOT / "benchmarks" / "measured.md").read_text().splitlines()
        if line.startswith("|")
    ]

    def span(values):
        return f"{min(values):g} to {max(values):g}"

    loops = [row for row in rows if row[0] == "closed loop"]
    share, textbook, scipy = ([float(row[at].rstrip(" %")) for row in loops] for at in (6, 7, 8))
    assert f"{span(share)} % of the rate of dgemm" in page
    assert f"{span(scipy)} times faster than SciPy" in page
    assert f"{round(min(textbook))} to {round(max(textbook))} times faster than a textbook" in page
    training, forecasts = ([float(row[at]) for row in rows[-4:]] for at in (2, 4))
    assert f"{min(training):.1f} to {max(training):.1f} times as long to train" in page
    assert f"{min(forecasts):.0f} to {max(forecasts):.0f} times as long to forecast" in page
    # scans of 16 points for 60 reservoirs of six sizes and 30 of 2000 neurons; two networks of each
    measured = {row[0] + row[2]: float(row[3]) for row in rows if row[0] == "hyperparameter trial"}
    measured |= {row[0]: float(row[1]) for row in rows[-4:]}
    sizes = (500, 1000, 2000, 3000)

    def campaign_minutes(name):
        of_size = np.interp(
            np.log([500, 1000, 1500, 2000, 2500, 3000, 2000, 2000, 2000]),
            np.log(sizes),
            np.log([measured[f"{name}{size}"] for size in sizes]),
        )
        return 10 * np.exp(of_size).sum() / 60

    scan, trained = campaign_minutes("hyperparameter trial") * 16, campaign_minutes("") * 2
    assert (
        f"take {scan:.0f} minutes for its scans ({minutes['scan']:.0f} there) and {trained:.0f} "
        f"for its training ({minutes['train']:.0f})" in page
    )
    slower = {row[0]: row[8] for row in rows if row[0] in ("integration", "Lyapunov exponents")}
    faster = "{integration} times faster, and {Lyapunov exponents} times for Lyapunov exponents"
    assert faster.format_map(slower) in page


# -- the site --------------------------------------------------------------------------------------

pytest.importorskip("sphinx", reason="the site needs requirements-docs.lock (make docs)")


@pytest.fixture(scope="module")
def build():
    sys.path.insert(0, str(ROOT / "docs" / "site"))
    import build

    yield build
    sys.path.remove(str(ROOT / "docs" / "site"))


def test_every_public_module_has_its_place(build):
    named = set(re.findall(r"automodule:: (\S+)", "\n".join(build.api_pages().values())))
    public = {
        ".".join(path.relative_to(ROOT / "src").with_suffix("").parts).removesuffix(".__init__")
        for path in (ROOT / "src" / "burstcast").rglob("*.py")
    }
    assert named == {name for name in public if "._" not in name}


def test_the_gallery_has_every_figure_once_and_those_of_the_kept_tables(build):
    named = re.findall(r"^#### (\w+)$", build.gallery({}), re.MULTILINE)
    assert sorted(named) == available_figures()
    drawn = build.pictures(["forecast_skill", "control_frontier"])
    assert len(drawn) == 2
    for name, (preset, picture) in drawn.items():
        assert preset == "beyond_the_paper"
        assert_same_picture(picture, ROOT / "docs" / "images" / f"{name}.png")


@pytest.mark.long
def test_the_commands_of_the_gallery_make_their_figures(build, project):
    targets: dict[str, list[str]] = {}
    for block in re.findall(r"```sh\n(.*?)\n```", build.gallery({})):
        program, options, target = re.fullmatch(r"(\S+)(.*) (\S+)", block).groups()
        assert program == ".venv/bin/snakemake"
        targets.setdefault(options, []).append(target)
    for options, wanted in targets.items():
        plan = run_in(project, f".venv/bin/snakemake {' '.join(wanted)} {options}")
        assert re.search(rf"^figure +{len(wanted)}$", plan, re.MULTILINE)
