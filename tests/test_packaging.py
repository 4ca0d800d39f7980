"""How others get burstcast: container, conda, catalog; the library alone, without a compiler."""

import json
import pkgutil
import re
import shlex
import sys
import tomllib
import warnings
from importlib.metadata import distribution
from pathlib import Path

import docutils.core
import jinja2
import pytest
import yaml
from packaging.version import Version

import burstcast
from burstcast.base.compiled.backends import usable_backend
from burstcast_workflow.campaign.loading import load
from helpers_library import said_by

ROOT = Path(__file__).parents[1]
PROJECT = (ROOT / "pyproject.toml").read_text(encoding="utf-8")
# names of conda that are not those of the lock file
CONDA = {
    "jinja2": "Jinja2",
    "matplotlib-base": "matplotlib",
    "netcdf4": "netCDF4",
    "pyyaml": "PyYAML",
}


def locked(name="requirements.lock"):
    lines = (ROOT / name).read_text(encoding="utf-8").splitlines()
    return dict(line.split("==") for line in lines if "==" in line)


def read_yaml(*parts):
    return yaml.safe_load(ROOT.joinpath(*parts).read_text(encoding="utf-8"))


def test_the_conda_environment_has_what_jobs_import_in_the_versions_of_the_lock_file():
    python, *others = read_yaml("workflow", "envs", "burstcast.yaml")["dependencies"]
    assert python == "python =3.11"
    packages = dict(entry.split(" =") for entry in others)
    # conda-forge has no post-releases of these names
    versions = {name: re.sub(r"\.post\d+$", "", text) for name, text in locked().items()}
    assert packages == {name: versions[CONDA.get(name, name)] for name in packages}
    wanted = set(re.findall(r'^    "([A-Za-z0-9-]+)>=', PROJECT, re.MULTILINE))
    jobs = {"numpy", "scipy", "pandas", "llvmlite", "netCDF4", "xarray", "pyyaml", "pydantic"}
    jobs |= {"scikit-optimize", "scikit-image", "matplotlib"}
    assert jobs <= wanted
    named = {CONDA.get(name, name).lower() for name in packages}
    assert {name.lower() for name in jobs} <= named


def test_users_install_what_campaigns_use_and_no_more():
    users, developers = locked(), locked("requirements-development.lock")
    assert {"snakemake", "numpy", "matplotlib", "Jinja2"} <= set(users)
    assert {"pytest", "ruff", "mypy", "snakefmt"} <= set(developers)
    assert not {name.lower() for name in users} & {name.lower() for name in developers}


def test_jobs_of_a_conda_environment_find_burstcast_where_snakemake_does():
    code = (
        "import snakemake.api; from snakemake.common import get_snakemake_searchpaths as f; "
        "print(*f(), sep='\\n')"
    )
    assert str(ROOT / "src") in said_by([sys.executable, "-c", code], ROOT).splitlines()


def instructions():
    """Instructions of the Containerfile with their arguments."""
    text = (ROOT / "Containerfile").read_text(encoding="utf-8")
    lines = [line for line in text.splitlines() if line and not line.startswith("#")]
    joined = re.sub(r"\\\n", " ", "\n".join(lines))
    return [(line.split()[0], line.split(maxsplit=1)[1]) for line in joined.splitlines()]


def test_the_container_is_built_from_the_lock_file_and_runs_what_is_installed():
    steps = {}
    for name, argument in instructions():
        steps.setdefault(name, []).append(argument)
    (base,), (command,), runs = steps["FROM"], steps["CMD"], steps["RUN"]
    (version,) = re.findall(r":3\.(\d+)-", base)
    assert int(version) >= 11  # requires-python
    assert runs[0] == "pip install -r requirements.lock"
    assert shlex.split(runs[1])[1:] == ["pip", "install", "--no-deps", "."]
    # the lock file is there before it is used, and so is all that a wheel is built from
    (first, *_) = [step for step in instructions() if step[0] in ("COPY", "RUN")]
    assert first == ("COPY", "requirements.lock ./")
    copied = [source for argument in steps["COPY"] for source in argument.split()[:-1]]
    assert all((ROOT / source).exists() for source in copied)
    code = (ROOT / "setup.py").read_text(encoding="utf-8")
    (files,) = re.findall(r"^FILES = \((.*?)^\)", code, re.MULTILINE | re.DOTALL)
    assert set(re.findall(r'"([^"]+)"', files)) <= set(copied)
    assert {"pyproject.toml", "setup.py", "src", "LICENSE", "README.md"} <= set(copied)
    assert command == '["burstcast", "--help"]'
    scripts = tomllib.loads(PROJECT)["project"]["scripts"]
    assert scripts == {"burstcast": "burstcast_workflow.commands.command_line:main"}


def test_every_place_names_the_newest_release_or_what_is_becoming_the_next_one():
    version = Version(tomllib.loads(PROJECT)["project"]["version"])
    citation = read_yaml("CITATION.cff")
    changelog = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    newest = re.findall(r"^## (\S+) \((\S+)\)$", changelog, re.MULTILINE)[0]
    assert newest == (citation["version"], str(citation["date-released"]))
    unreleased = "\n## Unreleased\n" in changelog
    assert version == Version(newest[0]) or (version.is_devrelease and unreleased)


def test_pages_promise_the_releases_that_are_tested():
    (oldest,) = re.findall(r'"snakemake>=([\d.]+)"', PROJECT)
    newest = locked()["snakemake"].rpartition(".")[0]
    pythons = re.findall(r"Python :: (3\.\d+)", PROJECT)
    promise = f"Python {pythons[0]} to {pythons[-1]} and Snakemake {oldest} to {newest} are tested."
    workflow = read_yaml(".github", "workflows", "tests.yml")
    assert workflow["jobs"]["wheel"]["strategy"]["matrix"]["python"] == [pythons[0], pythons[-1]]
    for name in ("CHANGELOG.md", "docs/installing.md"):
        text = (ROOT / name).read_text(encoding="utf-8")
        assert promise in " ".join(text.split()), name


def test_the_catalog_finds_what_it_asks_for():
    catalog = read_yaml(".snakemake-workflow-catalog.yml")
    assert catalog["usage"]["report"] is True
    assert set(catalog["usage"]) == {"mandatory-flags", "software-stack-deployment", "report"}
    for path in ("workflow/Snakefile", "config/README.md", ".test/Snakefile", "LICENSE"):
        assert (ROOT / path).is_file()


@pytest.mark.parametrize("job", ["tests", "campaign", "wheel"])
def test_continuous_integration_runs_what_is_there(job):
    steps = read_yaml(".github", "workflows", "tests.yml")["jobs"][job]["steps"]
    commands = [step["run"] for step in steps if "run" in step]
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
        config = read_yaml("config.yaml")

    text = (ROOT / "workflow" / "report" / "workflow.rst").read_text(encoding="utf-8")
    output = jinja2.Template(text, trim_blocks=True).render(snakemake=Snakemake)
    # a warning of docutils is an error here
    strict = {"halt_level": 2, "output_encoding": "unicode"}
    html = docutils.core.publish_string(output, writer="html5", settings_overrides=strict)
    assert 'href="https://arxiv.org/abs/2204.11682"' in html
    assert "``results/paper``" in output


# -- the library alone -----------------------------------------------------------------------------

SOURCE = Path(burstcast.__file__).parents[1]
OTHERS = ["snakemake", "pydantic", "matplotlib", "skimage", "burstcast_workflow"]


ALONE = """
import importlib, importlib.util, json, sys
import numpy as np
import burstcast

time = np.arange(400) * 0.1
phases = np.random.default_rng(1).uniform(0, 6, (6, 1))
series = np.stack([np.sin(time + phases), np.cos(time + phases)], axis=-1)
forecaster = burstcast.EventForecaster(
    kind="analogues",
    observable=0,
    event_threshold=0.9,
    prediction_times=(1,),
    lyapunov_time=2.0,
    sampling_interval=0.1,
)
forecaster.fit(series).save("saved.nc")
found = burstcast.EventForecaster.load("saved.nc")
assert np.array_equal(found.predict_proba(series), forecaster.predict_proba(series))
names, others = json.loads(sys.argv[1])
assert not [name for name in others if importlib.util.find_spec(name)]
for name in names:
    importlib.import_module(name)
"""


def required(name, packages):
    """Collect a distribution and all that it requires, by name, without extras."""
    if name not in packages:
        packages[name] = distribution(name)
        for requirement in packages[name].requires or []:
            if ";" not in requirement:
                required(re.match(r"[\w.-]+", requirement).group().lower(), packages)


@pytest.fixture(scope="module")
def alone(tmp_path_factory):
    """A directory in which Python finds the library and what it requires, and nothing else."""
    directory = tmp_path_factory.mktemp("site")
    (listed,) = re.findall(r"^dependencies = \[(.*?)^\]", PROJECT, re.MULTILINE | re.DOTALL)
    packages: dict[str, object] = {}
    for name in re.findall(r'"([\w-]+)>=', listed):
        required(name.lower(), packages)
    (directory / "burstcast").symlink_to(SOURCE / "burstcast")
    for module in packages.values():
        for part in {file.parts[0] for file in module.files} - {"..", "__pycache__"}:
            (directory / part).symlink_to(module.locate_file(part))
    return str(directory)


def test_the_library_stands_alone_saves_and_loads(alone, tmp_path):
    packages = pkgutil.walk_packages(burstcast.__path__, "burstcast.")
    names = [module.name for module in packages if not module.name.startswith("burstcast.figures")]
    assert len(names) > 50
    program = [sys.executable, "-S", "-c", ALONE, json.dumps([names, OTHERS])]
    said_by(program, tmp_path, PYTHONPATH=alone)


# -- without a compiler ----------------------------------------------------------------------------
# a module that is None in sys.modules cannot be imported
WITHOUT = "import sys; sys.modules.update(dict.fromkeys(['llvmlite', 'llvmlite.binding']))"


def test_with_a_compiler_nothing_is_said():
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert usable_backend("compiled") == "compiled"
        assert usable_backend("scipy") == "scipy"


@pytest.mark.parametrize(
    ("code", "output"),
    [
        (
            "import yaml\n"
            "from burstcast_workflow.campaign.loading import load\n"
            "from burstcast_workflow.tracking.environment import LIBRARIES, library_version\n"
            "config = load(yaml.safe_load(open('config.yaml')), defaults='config.yaml')\n"
            "print('backend:', config['forecasters']['esn']['backend'])\n"
            "print(*map(library_version, LIBRARIES))\n",
            "backend: scipy",
        ),
        (
            "import numpy as np, burstcast\n"
            "from burstcast.systems.integration import integrate\n"
            "from burstcast.systems.lorenz63 import Lorenz63\n"
            "start = np.random.default_rng(1).uniform(1, 9, (3, 3))\n"
            "series = integrate(Lorenz63(), start, 0.02, 400).transpose(2, 0, 1)\n"
            "times = dict(washout=20, prediction_times=(20,), window=20, validation_interval=40,\n"
            "             calibration_spacing=20, sampling_interval=0.02)\n"
            "for kind in ('esn', 'equations_filtered'):\n"
            "    forecaster = burstcast.EventForecaster(Lorenz63(), {'quantile': 0.8}, kind=kind,\n"
            "        members=1, neurons=30, grid=2, bayesian_points=0, **times).fit(series)\n"
            "    print(kind, np.isfinite(forecaster.predict_proba(series)).all())\n",
            "esn True\nequations_filtered True",
        ),
    ],
    ids=["the workflow", "the library"],
)
def test_without_a_compiler_scipy_takes_over(code, output):
    code = f"{WITHOUT}\n{code}"
    said = said_by([sys.executable, "-c", code], ROOT, PYTHONPATH=str(ROOT / "src"))
    for line in output.splitlines():  # warnings are between them
        assert line in said
    assert "reservoirs are computed by scipy, which is several times slower" in said
