"""The code of jobs: closures of imports, hashes, own modules, versions of libraries."""

import sys
from pathlib import Path

import pytest
from threadpoolctl import threadpool_info

from burstcast_workflow.tracking import code, environment
from burstcast_workflow.tracking.code import Sources, parsed
from burstcast_workflow.tracking.environment import library_version
from helpers_library import said_by

ROOT = Path(__file__).parents[2]


@pytest.fixture(autouse=True)
def directory(tmp_path, monkeypatch):
    """A directory with Snakemake's own, as in a run, in which own modules are found."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(tmp_path)
    return tmp_path


def written(texts):
    for name, text in texts.items():
        path = Path(name)
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)


def sources(modules=("own",), **options):
    files = modules if isinstance(modules, dict) else dict.fromkeys(modules, ())
    return Sources(lambda name: Path("scripts") / name, ROOT / "src", files, **options)


def names(entries):
    return {entry.partition(" ")[0] for entry in entries}


SAME = [
    ("a = 1", "import snakemake\n######## snakemake preamble end #########\na = 1"),
    ("a = 1", "a = 1  # one"),
    ("a = (1, 2)", "a = (\n    1,\n    2,\n)"),
    ("def f():\n    return 1", 'def f():\n    """One."""\n    return 1'),
    ('"""Two."""\na = "x"', "a = 'x'"),
    ("class A:\n    b = 1", 'class A:\n    """Words."""\n\n    b = 1'),
    ("a = 1", "a = 1\ndef __getattr__(name):\n    import late"),
]
OTHER = [
    ("a = 1", "a = 2"),
    ("a = 1", "a = 1.0"),
    ("a = 1\nb = 2", "b = 2\na = 1"),
    ("def f(x=1): pass", "def f(x=2): pass"),
    ("a = '''x'''", "a = '''y'''"),
    ("def f():\n    a = 1\n    'text'", "def f():\n    a = 1"),
    ("@one\ndef f(): pass", "def f(): pass"),
]


@pytest.mark.parametrize(("text", "other"), SAME)
def test_comments_formatting_and_docstrings_are_no_code(text, other):
    assert parsed(text.encode()).hash == parsed(other.encode()).hash


@pytest.mark.parametrize(("text", "other"), OTHER)
def test_everything_else_is(text, other):
    assert parsed(text.encode()).hash != parsed(other.encode()).hash


WAYS = {
    "import own.part": True,
    "import own.part as part": True,
    "from own import part": True,
    "from own.part import value": True,
    "def f():\n    from own import part": True,
    "if False:\n    import own.part": True,
    "try:\n    import own.part\nexcept ImportError: pass": True,
    "import own": False,
    "import other": False,
}


@pytest.mark.parametrize("way", WAYS)
def test_all_imports_are_followed_wherever_they_stand(way):
    written({"scripts/a.py": way, "own/__init__.py": "", "own/part.py": "value = 1"})
    assert ("own.part" in names(sources().entries("a.py", {}))) == WAYS[way]


@pytest.mark.parametrize(
    ("module", "text"),
    [
        ("own/one.py", "from . import part"),
        ("own/one.py", "from .part import value"),
        ("own/one.py", "from .deep import more"),
        ("own/deep/more.py", "from .. import part"),
        ("own/deep/more.py", "from ..part import value"),
        ("own/deep/__init__.py", "from ..part import value"),
    ],
)
def test_relative_imports_are_followed(module, text):
    empty = dict.fromkeys(("own/__init__.py", "own/deep/__init__.py", "own/deep/more.py"), "")
    written({**empty, "own/one.py": "", "own/part.py": "", "scripts/a.py": "import own.one"})
    if "deep" in text or "deep" in module:
        written({"own/one.py": "from .deep import more", "own/deep/more.py": "from .. import part"})
    written({module: text})
    assert names(sources().entries("a.py", {})) >= {"own.one", "own.part"}


def test_packages_count_and_libraries_do_not():
    written(
        {"scripts/a.py": "import own.part, numpy, json", "own/__init__.py": "", "own/part.py": ""}
    )
    assert names(sources().entries("a.py", {})) == {"a.py", "own", "own.part"}
    assert names(sources(modules=()).entries("a.py", {})) == {"a.py"}  # nobody has own modules


def test_files_of_own_modules_are_code():
    written({"scripts/a.py": "import own", "own.py": "", "my rates.csv": "1,2"})
    files = {"own": ["my rates.csv"]}
    entries = sources(files).entries("a.py", {})
    assert names(entries) == {"a.py", "own", "file:own:my"}
    assert sources(files).changed(entries) == []
    written({"my rates.csv": "1,3"})
    assert (
        sources().changed(entries) == sources(files).changed(entries) == ["file:own:my rates.csv"]
    )


def test_modules_that_a_registry_finds_count_where_they_are_named():
    written({"scripts/a.py": "from burstcast.systems.registry import make_system", "own.py": ""})
    seen = sources()
    without = names(seen.entries("a.py", {}))
    assert "burstcast.systems.registry" in without
    assert "burstcast.systems.lorenz63" not in without
    by_name = {"burstcast.systems": ["lorenz63", "own:Flow"]}
    assert names(seen.entries("a.py", by_name)) >= {*without, "burstcast.systems.lorenz63", "own"}
    # of another registry, which the script does not use
    assert names(seen.entries("a.py", {"burstcast.forecasters": ["esn"]})) == without


@pytest.mark.parametrize("edit", ["script", "module", "deleted"])
def test_what_changed_is_named(edit):
    written({"scripts/a.py": "import own.part", "own/__init__.py": "", "own/part.py": "b = 1"})
    entries = sources().entries("a.py", {})
    written({"own/part.py": "b = 1  # the same", "scripts/a.py": "import own.part\n"})
    assert sources().changed(entries) == []
    if edit == "script":
        written({"scripts/a.py": "import own.part\nc = 2"})
    elif edit == "module":
        written({"own/part.py": "b = 2"})
    else:
        Path("own/part.py").unlink()
    assert sources().changed(entries) == ["a.py" if edit == "script" else "own.part"]


@pytest.mark.parametrize("memory", ["kept", "of another parser", "damaged", "empty"])
def test_hashes_are_remembered_by_content_and_parser(memory, monkeypatch):
    written({"scripts/a.py": "import own", "own.py": "b = 1"})
    first = sources()
    entries = first.entries("a.py", {})
    first.keep()
    path = Path(".snakemake/burstcast_code.json")
    if memory == "of another parser":
        path.write_text(path.read_text().replace('"by": "', '"by": "0'))
    elif memory in ("damaged", "empty"):
        path.write_text({"damaged": '{"by": [', "empty": "[]"}[memory])
    calls = []
    monkeypatch.setattr(code, "parsed", lambda content: calls.append(1) or parsed(content))
    assert sources().entries("a.py", {}) == entries
    assert bool(calls) == (memory != "kept")
    written({"own.py": "b = 2"})
    assert sources().changed(entries) == ["own"]


def test_versions_of_the_libraries_that_a_job_imports():
    text = "import numpy as np\nfrom sklearn.svm import SVC\nimport json, own"
    written({"scripts/a.py": text, "own.py": "def f():\n    import yaml, no_such_library"})
    seen = sources()
    libraries = seen.libraries(names(seen.entries("a.py", {})))
    assert libraries == {
        "no_such_library": "not installed",
        "numpy": library_version("numpy"),
        "sklearn": library_version("scikit-learn"),
        "yaml": library_version("PyYAML"),
    }
    # a distribution of another name, which nobody has listed
    written({"own.py": "import mpl_toolkits"})
    assert "matplotlib" in sources().libraries(["own"])["mpl_toolkits"]


def test_libraries_are_entries_where_the_config_wants_it(monkeypatch):
    written({"scripts/a.py": "import numpy"})
    assert sources().entries("a.py", {}) == sources(with_libraries=True).entries("a.py", {})[:1]
    monkeypatch.setattr(code, "library_version", lambda _: "9.9")
    assert sources(with_libraries=True).entries("a.py", {})[1:] == ["numpy ==9.9"]


def test_the_environment_does_not_depend_on_what_else_is_loaded():
    """SciPy has a BLAS of its own, and keys of the cache are compared between processes."""
    code = "from burstcast_workflow.tracking.environment import environment; print(environment())"
    programs = (code, f"import scipy.linalg; {code}")
    alone, beside = (said_by([sys.executable, "-c", program], ROOT) for program in programs)
    assert alone == beside
    assert "threads" in alone


def test_the_blas_of_numpy_is_told_by_its_place_and_not_by_names_of_directories(monkeypatch):
    libraries = [library for library in threadpool_info() if library["user_api"] == "blas"]
    expected = environment.numpy_blas()
    of_scipy = {**libraries[0], "version": "0", "filepath": "/numpy-study/scipy.libs/blas.so"}
    monkeypatch.setattr(environment, "threadpool_info", lambda: [*libraries, of_scipy])
    assert environment.numpy_blas() == expected
