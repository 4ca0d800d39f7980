"""How others get burstcast: container, conda, catalog, continuous integration."""

import re
import shlex
import subprocess
import sys
import tomllib
from pathlib import Path

import docutils.core
import jinja2
import pytest
import yaml

from burstcast_workflow.config.loading import load
from snaketrust.hooks import TESTED

ROOT = Path(__file__).parents[1]
# names of conda that are not those of the lock file
CONDA = {"matplotlib-base": "matplotlib", "netcdf4": "netCDF4", "pyyaml": "PyYAML"}


def locked(name: str = "requirements.lock") -> dict[str, str]:
    lines = (ROOT / name).read_text(encoding="utf-8").splitlines()
    return dict(line.split("==") for line in lines if "==" in line)


def test_the_conda_environment_has_the_versions_of_the_lock_file():
    environment = yaml.safe_load((ROOT / "workflow" / "envs" / "burstcast.yaml").read_text())
    python, *others = environment["dependencies"]
    assert python == "python =3.11"
    found = dict(entry.split(" =") for entry in others)
    versions = locked()
    # conda-forge has no post-releases of these names
    expected = {name: re.sub(r"\.post\d+$", "", versions[CONDA.get(name, name)]) for name in found}
    assert found == expected


def test_users_install_what_campaigns_use_and_no_more():
    users, developers = locked(), locked("requirements-development.lock")
    assert {"snakemake", "numpy", "matplotlib", "Jinja2"} <= set(users)
    assert {"pytest", "ruff", "mypy", "snakefmt", "playwright"} <= set(developers)
    assert not {name.lower() for name in users} & {name.lower() for name in developers}


def test_the_conda_environment_has_what_jobs_import():
    environment = yaml.safe_load((ROOT / "workflow" / "envs" / "burstcast.yaml").read_text())
    names = {entry.split(" ")[0] for entry in environment["dependencies"]}
    project = (ROOT / "pyproject.toml").read_text(encoding="utf-8")
    wanted = set(re.findall(r'^    "([A-Za-z0-9-]+)>=', project, re.MULTILINE))
    jobs = {"numpy", "scipy", "pandas", "llvmlite", "netCDF4", "pyyaml", "pydantic"}
    jobs |= {"scikit-optimize", "scikit-image", "matplotlib"}
    assert jobs <= wanted
    named = {CONDA.get(name, name).lower() for name in names}
    assert {name.lower() for name in jobs} <= named


def test_jobs_of_a_conda_environment_find_burstcast_where_snakemake_does():
    code = (
        "import snakemake.api; from snakemake.common import get_snakemake_searchpaths as f; "
        "print(*f(), sep='\\n')"
    )
    said = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert str(ROOT / "src") in said.stdout.splitlines()


def instructions() -> list[tuple[str, str]]:
    """Instructions of the Containerfile with their arguments."""
    text = (ROOT / "Containerfile").read_text(encoding="utf-8")
    lines = [line for line in text.splitlines() if line and not line.startswith("#")]
    joined = re.sub(r"\\\n", " ", "\n".join(lines))
    return [(line.split()[0], line.split(maxsplit=1)[1]) for line in joined.splitlines()]


def test_the_container_is_built_from_the_lock_file():
    steps = instructions()
    assert [name for name, _ in steps if name == "FROM"] == ["FROM"]
    base = dict(steps)["FROM"]
    (version,) = re.findall(r":3\.(\d+)-", base)
    assert int(version) >= 11  # requires-python
    runs = [argument for name, argument in steps if name == "RUN"]
    assert runs[0] == "pip install -r requirements.lock"
    assert shlex.split(runs[1])[1:] == ["pip", "install", "--no-deps", "."]
    # the lock file is there before it is used, and so is all that a wheel is built from
    order = [(name, argument) for name, argument in steps if name in ("COPY", "RUN")]
    assert order[0] == ("COPY", "requirements.lock ./")
    copied = [
        source for name, argument in steps if name == "COPY" for source in argument.split()[:-1]
    ]
    assert all((ROOT / source).exists() for source in copied)
    code = (ROOT / "setup.py").read_text(encoding="utf-8")
    (files,) = re.findall(r"^FILES = \((.*?)^\)", code, re.MULTILINE | re.DOTALL)
    assert set(re.findall(r'"([^"]+)"', files)) <= set(copied)
    assert {"pyproject.toml", "setup.py", "src", "LICENSE", "README.md"} <= set(copied)


def test_the_container_runs_what_is_installed():
    (command,) = [argument for name, argument in instructions() if name == "CMD"]
    assert command == '["burstcast", "--help"]'
    project = (ROOT / "pyproject.toml").read_text(encoding="utf-8")
    assert (
        '[project.scripts]\nburstcast = "burstcast_workflow.commands.command_line:main"\n'
        in project
    )


def test_every_place_names_the_version_of_the_package():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    version = project["version"]
    citation = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
    assert citation["version"] == version
    changelog = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    newest = re.findall(r"^## (\S+) \((\S+)\)$", changelog, re.MULTILINE)[0]
    assert newest == (version, str(citation["date-released"]))


def test_pages_promise_the_releases_that_are_tested():
    oldest, newest = (".".join(TESTED[place].split(".")[:2]) for place in (0, -1))
    project = (ROOT / "pyproject.toml").read_text(encoding="utf-8")
    pythons = re.findall(r"Python :: (3\.\d+)", project)
    promise = f"Python {pythons[0]} to {pythons[-1]} and Snakemake {oldest} to {newest} are tested."
    workflow = yaml.safe_load((ROOT / ".github" / "workflows" / "tests.yml").read_text())
    assert workflow["jobs"]["wheel"]["strategy"]["matrix"]["python"] == [pythons[0], pythons[-1]]
    for name in ("CHANGELOG.md", "docs/installing.md"):
        text = (ROOT / name).read_text(encoding="utf-8")
        assert promise in " ".join(text.split()), name


def test_the_catalog_finds_what_it_asks_for():
    catalog = yaml.safe_load((ROOT / ".snakemake-workflow-catalog.yml").read_text())
    assert catalog["usage"]["report"] is True
    assert set(catalog["usage"]) == {"mandatory-flags", "software-stack-deployment", "report"}
    for path in ("workflow/Snakefile", "config/README.md", ".test/Snakefile", "LICENSE"):
        assert (ROOT / path).is_file()


@pytest.mark.parametrize("job", ["tests", "campaign", "wheel"])
def test_continuous_integration_runs_what_is_there(job):
    workflow = yaml.safe_load((ROOT / ".github" / "workflows" / "tests.yml").read_text())
    commands = [step["run"] for step in workflow["jobs"][job]["steps"] if "run" in step]
    assert commands
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8").replace("$(VENV)", ".venv")
    for command in commands:
        program, *arguments = shlex.split(command)
        if program == "make":
            assert re.search(rf"^{re.escape(arguments[0])}:", makefile, re.MULTILINE)
        elif program.endswith("snakemake") and "-s" in arguments:
            assert (ROOT / arguments[arguments.index("-s") + 1]).is_file()
        else:
            assert program.partition("=")[0] in ("pip", "project", "snakemake")


def test_the_readme_of_the_config_has_a_config_that_is_right():
    text = (ROOT / "config" / "README.md").read_text(encoding="utf-8")
    (overlay,) = re.findall(r"```yaml\n(.*?)```", text, re.DOTALL)
    config = load(yaml.safe_load(overlay), defaults=ROOT / "config.yaml")
    assert config["results"] == "results/mine"
    assert [block["reynolds"] for block in config["campaign"]] == [[500, 700]]


def test_the_text_of_the_report_says_which_campaign():
    class Snakemake:
        config = yaml.safe_load((ROOT / "config.yaml").read_text(encoding="utf-8"))

    text = (ROOT / "workflow" / "report" / "workflow.rst").read_text(encoding="utf-8")
    said = jinja2.Template(text, trim_blocks=True).render(snakemake=Snakemake)
    # a warning of docutils is an error here
    strict = {"halt_level": 2, "output_encoding": "unicode"}
    html = docutils.core.publish_string(said, writer="html5", settings_overrides=strict)
    assert 'href="https://arxiv.org/abs/2204.11682"' in html
    assert "``results/paper``" in said


def test_the_bound_of_snakemake_is_the_first_release_that_was_tested():
    project = (ROOT / "pyproject.toml").read_text(encoding="utf-8")
    assert f'"snakemake>={TESTED[0].removesuffix(".0")}"' in project
    assert locked()["snakemake"] in TESTED
