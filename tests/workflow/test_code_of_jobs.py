"""The code of the project: closures tell what a job depends on, and jobs load little."""

import ast
import sys
from collections.abc import Iterator
from fnmatch import fnmatch
from functools import cache
from pathlib import Path

import pytest

from burstcast.figures.registry import available_figures
from burstcast_workflow.project import PACKAGES, UNTRACKED
from burstcast_workflow.tracking.code import Sources
from helpers_library import said_by

ROOT = Path(__file__).parents[2]
STAGES = ROOT / "workflow" / "scripts"
SCRIPTS = sorted(STAGES.glob("*/*.py"))
SOURCE = ROOT / "src"
SOURCES = sorted(SOURCE.rglob("*.py"))


def sources_of(scripts: Path) -> Sources:
    return Sources(lambda name: scripts / name, SOURCE, {})


SEEN = sources_of(STAGES)


def names(code) -> frozenset[str]:
    return frozenset(code)


@cache
def modules_of(path: Path) -> frozenset[str]:
    """Modules that a script reaches, also those of which it uses nothing."""
    return frozenset(sources_of(path.parent).definitions(path.name, {}))


def test_all_packages_are_those_of_the_project():
    packages = {path.name for path in SOURCE.iterdir() if path.suffix == ""}
    # what Snakemake imports is in no closure of a script
    assert packages == {*PACKAGES, "snakemake_logger_plugin_burstcast"}


# what scripts are left to load once the libraries and the harness are
LOADED = """
import netCDF4, numpy, os, pandas, runpy, scipy.stats, skopt, sys
import burstcast_workflow.harness.job
before = {*sys.modules}
for script in sys.argv[1:]:
    if os.fork() == 0:
        runpy.run_path(script, run_name="not a job")
        print(script, *[name for name in sys.modules if name not in before], flush=True)
        os._exit(0)
    os.wait()
"""


def test_closures_have_what_scripts_load():
    """What they load when they are imported; what functions import is in them, too."""
    lines = said_by([sys.executable, "-c", LOADED, *SCRIPTS], ROOT).splitlines()
    loaded = [line.split() for line in lines]
    assert [Path(script) for script, *_ in loaded] == SCRIPTS
    for script, *modules in loaded:
        tracked = {name for name in modules if not f"{name}.".startswith(UNTRACKED)}
        missing = tracked - SEEN.definitions(str(Path(script).relative_to(STAGES)), {}).keys()
        assert not [name for name in missing if name.startswith("burst")], script


# Code that hashes do not see: imports by computed names, code from text, names from nowhere.
UNSEEN = {
    *("importlib", "imp", "pkgutil", "runpy", "zipimport", "*"),
    *("__import__", "compile", "eval", "exec"),
}
# Docstrings and sources, which are no code.
WORDS = {
    *("__doc__", "getdoc", "get_docstring", "getsource", "getsourcelines", "getcomments"),
}
# Functions that pass docstrings on to people: a figure's caption.
PASS_WORDS_ON = {"burstcast.figures.registry": "caption"}
LATE = {"burstcast", "burstcast_workflow"}  # what they offer is imported when it is asked for


def used(path: Path, without: str = "") -> Iterator[str]:
    """Names that a file uses and imports; with a point before them those of attributes.

    ``without``: name of a function whose body is left out.
    """
    nodes = [ast.parse(path.read_bytes(), str(path))]
    while nodes:
        node = nodes.pop()
        nodes += [] if getattr(node, "name", None) == without else ast.iter_child_nodes(node)
        match node:
            case ast.Name(id=name):
                yield name
            case ast.Attribute(value=ast.Name(id=owner), attr=name) if owner in LATE:
                yield from (f"{owner}.{name}", f".{name}")
            case ast.Attribute(attr=name):
                yield f".{name}"
            case ast.Import(names=modules):
                yield from (each.name.partition(".")[0] for each in modules)
                yield from (f"{each.name}.{each.asname}" for each in modules if each.asname)
            case ast.FunctionDef(name=name):
                yield f"def {name}"
            case ast.ImportFrom(module=str(module), names=names) if module != "importlib.metadata":
                yield from (module.partition(".")[0], *(each.name for each in names))
                yield from (f"{module}.{each.name}" for each in names if module in LATE)


def test_closures_see_all_code_of_the_project():
    # what finds modules by their names, what compares the code that runs with its text, and the
    # command, which no job imports
    others = ("discovery.py", "code.py", "command_line.py")
    for path in SOURCES + SCRIPTS:
        assert path.name in others or not UNSEEN & {*used(path)}, path


def test_no_job_depends_on_docstrings_or_on_what_packages_offer_late():
    registries = {
        ".".join(path.parent.relative_to(SOURCE).parts): [
            other.stem
            for other in path.parent.glob("*.py")
            if other.stem not in ("__init__", "base", "check", "registry")
        ]
        for path in sorted((SOURCE / "burstcast").rglob("registry.py"))
    }
    assert len(registries) > 5
    reached = {
        module
        for script in SCRIPTS
        for module in names(SEEN.code(str(script.relative_to(STAGES)), registries))
    }
    assert len(reached) > 200
    words = WORDS | {f".{name}" for name in WORDS}
    for module in reached - LATE:
        path = STAGES / module if module.endswith(".py") else place(module)
        of_file = {*used(path, PASS_WORDS_ON.get(module, ""))}
        assert not words & of_file, module
        taken = {name for name in of_file if name.partition(".")[0] in LATE and "." in name}
        assert [name for name in taken if not place(name).exists()] == [], module
        assert not {"def __getattr__", "def __dir__"} & of_file, module
    for module in PASS_WORDS_ON:  # none in vain
        assert words & {*used(place(module))}, module


@pytest.mark.parametrize("path", SCRIPTS, ids=lambda path: path.stem)
def test_a_script_depends_on_what_concerns_its_numbers_alone(path):
    assert "snakemake" not in used(path)  # only what parameters carry
    modules = modules_of(path)
    assert not {module for module in modules if module.startswith("burstcast_workflow.config")}
    assert not {module for module in modules if f"{module}.".startswith(UNTRACKED)}
    # of the harness, what gives the function its arguments
    definitions = SEEN.definitions(str(path.relative_to(STAGES)), {})
    assert {"Call", "settings_taken", "provenance"} <= definitions[
        "burstcast_workflow.harness.call"
    ].keys()
    assert "Setting" in definitions["burstcast.base.declared"]
    # others than control know what an actuation is; tables know its records
    if path.parent.name != "control":
        control = {module for module in modules if module.startswith("burstcast.control.")}
        assert control <= {f"burstcast.control.{name}" for name in ("actuated_series", "actuation")}


def test_packages_import_nothing_by_themselves():
    # else every closure would be everything
    packages = {
        path
        for path in SOURCES
        if path.name == "__init__.py" and ast.parse(path.read_text()).body[1:]  # not only words
    }
    # Snakemake asks for its plugins' classes there, and no job imports them
    plugins = {SOURCE / "snakemake_logger_plugin_burstcast" / "__init__.py"}
    # what notebooks begin with is loaded when it is asked for
    notebook = {SOURCE / name / "__init__.py" for name in ("burstcast", "burstcast_workflow")}
    assert packages == plugins | notebook
    for path in notebook:
        body = ast.parse(path.read_text()).body[1:]
        assert [type(node) for node in body] == [ast.FunctionDef] * len(body)


def test_scripts_do_not_depend_on_what_others_compute_with():
    """Control not on statistics of the velocity, and no edit of a filter repeats the search."""
    control = {"systems.mfe_modes", "statistics.measures", "statistics.profiles"}
    search = {"data.encoders", "forecasters._filtered", "data.observation"}
    equations = ("equations",), "forecasters.equations", {"networks.", "systems.lorenz63"}
    for script, kinds, uses, others in (
        ("control/control", (), "control.windows", {*control, "control.strategies.planned"}),
        ("control/suppressed_event", (), "control.windows", control),
        ("forecasters/scan", ("esn",), "networks.readout", search),
        ("forecasters/search", ("esn",), "networks.readout", search),
        ("control/control", *equations),
        ("evaluation/forecast", *equations),
        ("evaluation/long_term", *equations),
        ("forecasters/fit", *equations),
        ("forecasters/fit", ("esn",), "networks.readout", {"systems.lorenz63"}),
    ):
        about = {"burstcast.forecasters": kinds, "burstcast.systems": ["mfe"]}
        about["burstcast.control.strategies"] = ["prediction_triggered"]
        about["burstcast.networks.validation_strategies"] = ["recycle"]
        modules = names(SEEN.code(f"{script}.py", about))
        assert f"burstcast.{uses}" in modules
        ours = tuple(f"burstcast.{name}" for name in others)
        assert [name for name in modules if name.startswith(ours)] == [], script


# -- starting up -----------------------------------------------------------------------------------

# What a job runs: a script, or the module of a figure.
FIGURES = SOURCE / "burstcast" / "figures"
STARTED = SCRIPTS + [FIGURES / f"{name}.py" for name in available_figures()]

# Libraries that take long to load, and the scripts and figures that cannot do without them.
NEEDED_BY = {
    "llvmlite": [],
    "skopt": ["forecasters/search.py"],
    "sklearn": [],  # by scikit-optimize only
    "skimage": ["figures/vorticity_isosurfaces.py"],
    "matplotlib": ["figures/*.py"],
    "pydantic": [],
    "snakemake": [],
    "yaml": [],
}
# Modules of ours that load much, and those who have nothing to do with networks.
NETWORK = "burstcast.networks.reservoir"
WITHOUT_NETWORKS = ["tables/*.py", "data/*.py", "control/*.py"]


def place(module: str) -> Path:
    path = SOURCE.joinpath(*module.split("."))
    return path / "__init__.py" if path.is_dir() else path.with_name(path.name + ".py")


def imported(path, late=True):
    """Modules that a file imports, wherever it does so, or at its top."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    for node in ast.walk(tree) if late else tree.body:
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert not node.level, path
            yield str(node.module)


@pytest.mark.parametrize("script", STARTED, ids=lambda path: path.stem)
def test_a_script_loads_what_it_needs_and_no_other_library_that_takes_long(script):
    def is_one_of(patterns):
        return any(fnmatch(f"{script.parent.name}/{script.name}", pattern) for pattern in patterns)

    ours = {name for name in modules_of(script) if not name.endswith(".py")}
    at_the_top = (imported(path, late=False) for path in (script, *map(place, ours)))
    packages = {module.partition(".")[0] for modules in at_the_top for module in modules}
    assert packages & {*NEEDED_BY} == {name for name in NEEDED_BY if is_one_of(NEEDED_BY[name])}
    assert NETWORK not in ours or not is_one_of(WITHOUT_NETWORKS)


def test_planning_loads_no_library_for_what_scripts_figures_and_tables_declare():
    code = """
import sys
from pathlib import Path
from burstcast.tables.makers.registry import maker
from burstcast_workflow.figures.registry import FIGURES
from burstcast_workflow.harness.job import function_of
from burstcast_workflow.tables.registry import MAKERS
jobs = [*map(function_of, Path(sys.argv[1]).glob("*/*.py")), *map(maker, MAKERS), *FIGURES]
print(len(jobs), *sys.modules)
"""
    count, *names = said_by([sys.executable, "-c", code, STAGES], ROOT).split()
    assert int(count) > 60
    scipy = {"scipy.ndimage", "scipy.optimize", "scipy.special"}
    assert not {"skimage.measure", "sklearn", "skopt", *scipy} & {*names}


HEAVY = {"llvmlite", "matplotlib", "netCDF4", "pandas", "skimage", "sklearn", "skopt", "xarray"}
HEAVY |= {f"scipy.{part}" for part in ("linalg", "optimize", "sparse", "spatial", "special")}


def test_planning_loads_no_library_that_computes_or_draws(tmp_path):
    """But for the first plan in a directory; jobs of a cluster plan, too."""
    code = """
import pkgutil, sys
found = pkgutil.iter_modules
# Snakemake's plugin for Slurm loads pandas
pkgutil.iter_modules = lambda *places: (
    each for each in found(*places) if not each.name.startswith("snakemake_executor_plugin_slurm")
)
from snakemake.cli import main
try:
    main(sys.argv[1:])
finally:
    print("loaded:", *sys.modules)
"""
    plan = [sys.executable, "-c", code, "-n", "-s", ROOT / "Snakefile", "--cores", "1"]
    plan += ["--configfile", ROOT / "config.yaml", ROOT / "workflow" / "presets" / "tiny.yaml"]
    first, again = ({*said_by(plan, tmp_path).split("loaded:")[1].split()} for _ in range(2))
    assert "matplotlib" in first
    # that llvmlite is installed is found out by loading it
    assert not HEAVY - {"llvmlite"} & again


def test_jobs_from_the_cache_load_no_library_that_computes_or_draws():
    """Scripts, and what finds their results in the cache."""
    code = f"""
import os, runpy, sys
import snakemake.script
from burstcast_workflow.harness import job
from burstcast_workflow.tracking.environment import environment
environment()
for script in sys.argv[1:]:
    if os.fork() == 0:
        runpy.run_path(script, run_name="not a job")
        print(script, *{HEAVY} & {{*sys.modules}}, flush=True)
        os._exit(0)
    os.wait()
"""
    said = said_by([sys.executable, "-c", code, *SCRIPTS], ROOT).splitlines()
    assert said == [*map(str, SCRIPTS)]


def test_the_job_with_most_instances_starts_without_what_it_does_not_compute_with():
    script = STAGES / "evaluation" / "forecast.py"
    body = ast.parse(script.read_text(encoding="utf-8")).body
    imports = [ast.unparse(node) for node in body if isinstance(node, ast.Import | ast.ImportFrom)]
    code = "\n".join([*imports, "import sys", "print(*sys.modules)"])
    loaded = said_by([sys.executable, "-c", code], ROOT).split()
    heavy = {"llvmlite", "pandas", "matplotlib", "skopt", "sklearn", "pydantic", "yaml"}
    assert not (heavy | {"scipy.stats", "scipy.optimize"}) & {*loaded}


# -- nothing imports upwards -----------------------------------------------------------------------


# Each may import those before it; what offers the rest to notebooks and commands is above all.
DOWNWARDS = ("burstcast", "snakemake_logger_plugin_burstcast", "burstcast_workflow")
PARTS = (
    *("project", "snakemake_internals", "tracking", "harness", "jobs", "config", "campaign"),
    *("tables", "stages", "start", "opened", "summary", "figures", "commands"),
)
# Rooms of the library, floor by floor: none imports another of its own floor, or of one above.
FLOORS = (
    *(("base",), ("systems",), ("networks", "data"), ("forecasters",), ("forecasts", "statistics")),
    *(("control",), ("event_forecaster",), ("tables",), ("figures",)),
)


def imports_between(directory, prefix):
    """Parts of a directory that import others: part, the other, file."""
    for path in sorted(directory.rglob("*.py")):
        part = path.relative_to(directory).parts[0].removesuffix(".py")
        for module in imported(path):
            if module.startswith(prefix):
                other = module.removeprefix(prefix).partition(".")[0]
                if part not in (other, "__init__", "__main__"):
                    yield part, other, path.relative_to(directory)


def test_parts_import_downwards():
    imports = list(imports_between(SOURCE / "burstcast_workflow", "burstcast_workflow."))
    assert {part for part, *_ in imports} >= {"stages", "figures", "config", "jobs"}
    assert [edge for edge in imports if edge[0] not in PARTS[PARTS.index(edge[1]) :]] == []
    floor = {room: number for number, rooms in enumerate(FLOORS) for room in rooms}
    imports = list(imports_between(SOURCE / "burstcast", "burstcast."))
    assert {room for room, _, _ in imports} == set(floor) - {"base"}
    assert [edge for edge in imports if floor[edge[1]] >= floor[edge[0]]] == []
    for number, package in enumerate(DOWNWARDS, 1):
        for path in sorted((SOURCE / package).rglob("*.py")):
            packages = {module.partition(".")[0] for module in imported(path)}
            assert packages.isdisjoint(DOWNWARDS[number:]), path
