"""The code of jobs: closures of imports, hashes, own modules, versions of libraries."""

import os
import re
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
    yield tmp_path
    for name, module in [*sys.modules.items()]:  # where parts of packages are looked for
        if str(getattr(module, "__file__", "")).startswith(str(tmp_path)):
            del sys.modules[name]


def written(texts):
    for name, text in texts.items():
        path = Path(name)
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)


def sources(modules=("own",), **options):
    files = modules if isinstance(modules, dict) else dict.fromkeys(modules, ())
    return Sources(lambda name: Path("scripts") / name, ROOT / "src", files, **options)


def names(code):
    return {*code}


SAME = [
    ("a = 1", "import snakemake\n######## snakemake preamble end #########\na = 1"),
    ("a = 1", "a = 1  # one"),
    ("a = (1, 2)", "a = (\n    1,\n    2,\n)"),
    ("def f():\n    return 1", 'def f():\n    """One."""\n    return 1'),
    ('"""Two."""\na = "x"', "a = 'x'"),
    ("class A:\n    b = 1", 'class A:\n    """Words."""\n\n    b = 1'),
]
OTHER = [
    ("a = 1", "a = 1\ndef __getattr__(name):\n    import late"),
    ("a = 1", "a = 1\nb = '######## snakemake preamble end #########'"),
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
    assert ("own.part" in names(sources().code("a.py", {}))) == WAYS[way]


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
    assert names(sources().code("a.py", {})) >= {"own.one", "own.part"}


def test_packages_count_and_libraries_do_not():
    written(
        {"scripts/a.py": "import own.part, numpy, json", "own/__init__.py": "", "own/part.py": ""}
    )
    assert names(sources().code("a.py", {})) == {"a.py", "own", "own.part"}
    assert names(sources(modules=()).code("a.py", {})) == {"a.py"}  # nobody has own modules


def test_files_of_own_modules_are_code():
    written({"scripts/a.py": "import own", "own.py": "", "my rates.csv": "1,2"})
    files = {"own": ["my rates.csv"]}
    seen = sources(files)
    assert names(seen.code("a.py", {})) == {"a.py", "own", "file:own:my rates.csv"}
    planned = seen.whole()
    assert sources(files).changed(planned) == []
    written({"my rates.csv": "1,3"})
    changed = ["file:own:my rates.csv"]
    assert sources().changed(planned) == sources(files).changed(planned) == changed
    Path("my rates.csv").unlink()
    assert sources().changed(planned) == changed


def test_modules_that_a_registry_finds_count_where_they_are_named():
    text = "from burstcast.systems.registry import make_system"
    written({"scripts/a.py": text, "own.py": ""})
    assert names(sources().code("a.py", {"burstcast.systems": ["lorenz63"]})) == {"a.py"}
    written({"scripts/a.py": f"{text}\nmake_system('lorenz63', {{}})"})
    seen = sources()
    without = names(seen.code("a.py", {}))
    assert "burstcast.systems.registry" in without
    assert "burstcast.systems.lorenz63" not in without
    by_name = {"burstcast.systems": ["lorenz63", "own:Flow"]}
    assert names(seen.code("a.py", by_name)) >= {*without, "burstcast.systems.lorenz63", "own"}
    # of another registry, which the script does not use
    assert names(seen.code("a.py", {"burstcast.forecasters": ["esn"]})) == without


@pytest.mark.parametrize("edit", ["script", "module", "deleted"])
def test_what_changed_is_named(edit):
    written({"scripts/a.py": "import own.part", "own/__init__.py": "", "own/part.py": "b = 1"})
    seen = sources()
    seen.code("a.py", {})
    planned = seen.whole()
    written({"own/part.py": "b = 1  # the same", "scripts/a.py": "import own.part\n"})
    assert sources().changed(planned) == []
    if edit == "script":
        written({"scripts/a.py": "import own.part\nc = 2"})
    elif edit == "module":
        written({"own/part.py": "b = 2"})
    else:
        Path("own/part.py").unlink()
    assert sources().changed(planned) == ["a.py" if edit == "script" else "own.part"]


@pytest.mark.parametrize("memory", ["kept", "of another parser", "damaged", "empty"])
def test_hashes_are_remembered_by_content_and_parser(memory, monkeypatch):
    written({"scripts/a.py": "import own", "own.py": "b = 1"})
    first = sources()
    entries = first.code("a.py", {})
    first.keep()
    path = Path(".snakemake/burstcast_code.json")
    if memory == "of another parser":
        path.write_text(path.read_text().replace('"by": "', '"by": "0'))
    elif memory in ("damaged", "empty"):
        path.write_text({"damaged": '{"by": [', "empty": "[]"}[memory])
    calls = []
    monkeypatch.setattr(code, "parsed", lambda content: calls.append(1) or parsed(content))
    assert sources().code("a.py", {}) == entries
    assert bool(calls) == (memory != "kept")
    planned = first.whole()
    written({"own.py": "b = 2"})
    assert sources().changed(planned) == ["own"]


# -- definitions of the project's modules ----------------------------------------------------------

BASE = {
    "src/burstcast/__init__.py": "",
    "src/burstcast/one.py": """
import math
from math import sin as wave
from burstcast.two import helper
from burstcast import three
SCALE = 2.0
OTHER = 3.0
TABLE = {}
for number in range(3):
    TABLE[number] = number
def used(x):
    return helper(x) * SCALE + wave(x)
def unused(x):
    return three.value * OTHER * math.pi
class Shape:
    area = three.area
    def name(self):
        return "shape"
""",
    "src/burstcast/two.py": "FACTOR = 1\ndef helper(x):\n    return FACTOR * x\ndef idle(): pass\n",
    "src/burstcast/three.py": "value = 1\narea = 2\nlength = 3\n",
    "src/burstcast/late.py": "def of_late(): return 1\n",
}
SCRIPT = "from burstcast.one import used\nused(1)\n"
EDITS = [  # file, before, after, whether the job of the script has other code then
    ("one", "x) * SCALE", "x) + SCALE", True),
    ("one", "SCALE = 2.0", "SCALE = 2.5", True),
    ("one", "OTHER = 3.0", "OTHER = 3.5", False),
    ("one", "* OTHER *", "+ OTHER +", False),
    ("one", '"shape"', '"form"', False),
    ("one", "range(3)", "range(4)", True),  # what a module does when it is imported
    ("one", "TABLE = {}", "TABLE = {9: 9}", True),  # which names it
    ("one", "sin as wave", "cos as wave", True),  # another function of a library
    ("one", "import math\n", "import math, json\n", False),
    ("one", "import helper", "import idle as helper", True),
    ("one", "SCALE = 2.0", "SCALE = 2.0\ndef helper(x): pass", True),  # hides the imported one
    ("two", "FACTOR = 1", "FACTOR = 2", True),
    ("two", "def idle(): pass", "def idle(): return 1", False),
    ("three", "value = 1", "value = 2", False),
    ("three", "area = 2", "area = 2\nimport burstcast.one\nburstcast.one.SCALE = 9", True),
    ("late", "return 1", "return 2", False),
]


def code_of(script, by_name=None, **texts):
    files = BASE | {"scripts/a.py": script}
    files |= {f"src/burstcast/{name}.py": text for name, text in texts.items()}
    written(files)
    seen = Sources(lambda name: Path("scripts") / name, Path("src"), {})
    return seen.code("a.py", by_name or {})


@pytest.mark.parametrize(("name", "before", "after", "concerned"), EDITS)
def test_of_a_module_counts_what_is_used_of_it_and_what_it_does_when_it_is_imported(
    name, before, after, concerned
):
    text = BASE[f"src/burstcast/{name}.py"]
    assert text.count(before) == 1
    edited = {name: text.replace(before, after)}
    assert (code_of(SCRIPT) != code_of(SCRIPT, **edited)) == concerned


WAYS_TO_USE = [  # what a script says, and definitions that it reaches so, or not
    ("import burstcast.one\nburstcast.one.used(1)", "x) * SCALE", True),
    ("import burstcast.one as one\none.used(1)", "x) * SCALE", True),
    ("from burstcast import one\none.used(1)", "x) * SCALE", True),
    ("from burstcast import one\none.SCALE", "x) * SCALE", False),
    ("from burstcast import one\ngetattr(one, 'used')(1)", "x) * SCALE", True),
    ("from burstcast.one import *\nused(1)", "x) * SCALE", True),
    ("from burstcast.one import *", "* OTHER *", True),
    ("def f():\n    from burstcast.one import used\n    return used(1)", "x) * SCALE", True),
    ("from burstcast.one import helper\nhelper(1)", "x) * SCALE", False),
    ("from burstcast.one import Shape\nclass Own(Shape): pass", '"shape"', True),
    ("import importlib\nimportlib.import_module('burstcast.one')", "* OTHER *", True),
    ("from burstcast.one import used", "x) * SCALE", False),  # imported, and not used
    ("from burstcast.one import used", "range(3)", True),
    ("import typing\nif typing.TYPE_CHECKING:\n    import burstcast.one", "range(3)", False),
]


@pytest.mark.parametrize(("script", "place", "concerned"), WAYS_TO_USE)
def test_ways_to_use_a_definition(script, place, concerned):
    text = BASE["src/burstcast/one.py"]
    edited = text.replace(place, "range(4)" if "range" in place else f"{place} + 0 *")
    edited = text.replace(place, '"form"') if place == '"shape"' else edited
    assert text.count(place) == 1
    assert (code_of(script) != code_of(script, one=edited)) == concerned


def test_a_name_that_another_module_imports_is_followed_to_its_definition():
    script = "from burstcast.one import helper\nhelper(1)"
    other = BASE["src/burstcast/two.py"].replace("FACTOR * x", "FACTOR + x")
    assert code_of(script) != code_of(script, two=other)


def test_what_a_package_offers_late_is_followed_where_it_is_asked_for():
    late = "def __getattr__(name):\n    from burstcast.late import of_late\n    return of_late"
    script = "from burstcast import of_late\nof_late()"
    other = BASE["src/burstcast/late.py"].replace("return 1", "return 2")
    assert code_of(script, __init__=late) != code_of(script, __init__=late, late=other)
    assert code_of(SCRIPT, __init__=late) == code_of(SCRIPT, __init__=late, late=other)


def test_all_of_a_module_counts_where_a_name_has_no_definition():
    two = "globals().update(made=1)\nkept = 1\n"
    script = "from burstcast.two import made\nprint(made)"
    for edited in (two.replace("made=1", "made=2"), two.replace("kept = 1", "kept = 2")):
        assert code_of(script, two=two) != code_of(script, two=edited)


def test_decorators_with_effects_run_when_a_module_is_imported():
    """A register of functions has all of them, whoever names them."""
    kept = "KEPT = []\ndef keep(f):\n    KEPT.append(f)\n    return f\n"
    two = f"{kept}@keep\ndef first():\n    return 1\n"
    script = "from burstcast import two\nprint(two.KEPT)"
    assert code_of(script, two=two) != code_of(script, two=two.replace("return 1", "return 2"))
    made = "from functools import cache\nKEPT = []\n@cache\ndef first():\n    return 1\n"
    script = "from burstcast.two import KEPT\nprint(KEPT)"
    assert code_of(script, two=made) == code_of(script, two=made.replace("return 1", "return 2"))


# -- a user's own modules --------------------------------------------------------------------------

HIDDEN = {  # what reaches code that is not followed, and what does not
    "import runpy\nrunpy.run_path('sub.py')": "line 2: runpy.run_path('sub.py')",
    "exec('a = 1')": "line 1: exec('a = 1')",
    "import importlib\nimportlib.import_module('s' + 'ub')": "line 2: importlib.import_module(",
    "__path__.append('elsewhere')": "line 1: __path__",
    "import pkgutil, own\n[*pkgutil.iter_modules(own.__path__)]": "line 2: pkgutil.iter_modules(",
    "import importlib\nimportlib.import_module('sub')": "",
    "__import__('sub')": "",
    "import re\nre.compile('a')": "",
    "open('sub.py')": "",
}


@pytest.mark.parametrize("text", HIDDEN)
def test_what_cannot_be_followed_in_own_modules_is_told(text):
    written({"scripts/a.py": "import own", "own.py": text, "sub.py": ""})
    seen = sources()
    entries = seen.code("a.py", {})
    told = seen.hidden().get("own", [])
    assert [line.startswith(HIDDEN[text]) for line in told] == [True] * bool(HIDDEN[text])
    assert ("sub" in names(entries)) == ("('sub')" in text)


@pytest.mark.parametrize("text", ["from pack import *", "import pack", "from pack import part"])
def test_own_packages_count_whole(text):
    """Also submodules that only the list of what a star imports names."""
    files = {"pack/__init__.py": "__all__ = ['part', 'name']\nname = 1", "pack/part.py": ""}
    written({"scripts/a.py": "import own", "own.py": text, **files})
    expected = {"a.py", "own", "pack"} | ({"pack.part"} if text != "import pack" else set())
    assert names(sources(("own", "pack")).code("a.py", {})) == expected


def test_own_modules_count_wherever_they_are_installed(directory, monkeypatch):
    library = directory / "lib" / "site-packages"
    written(
        {
            "scripts/a.py": "import lab.flows",
            "lib/site-packages/lab/__init__.py": "",
            "lib/site-packages/lab/flows.py": "import lab.part, other",
            "lib/site-packages/lab/part.py": "",
            "lib/site-packages/other.py": "",
        }
    )
    monkeypatch.syspath_prepend(library)
    assert names(sources(("lab.flows",)).code("a.py", {})) == {
        *("a.py", "lab", "lab.flows", "lab.part"),  # and the other one is a library
    }


def test_bytecode_older_than_its_source_is_removed_whatever_the_dates_are():
    written({"scripts/a.py": "import own", "own.py": "value = 1"})
    said = [sys.executable, "-c", "import own; print(own.value)"]
    writes = {"PYTHONDONTWRITEBYTECODE": ""}
    assert said_by(said, Path.cwd(), **writes).strip() == "1"
    kept = Path("own.py").stat()
    written({"own.py": "value = 2"})
    os.utime("own.py", ns=(kept.st_atime_ns, kept.st_mtime_ns))
    assert said_by(said, Path.cwd()).strip() == "1"  # as Python has it
    seen = sources()
    seen.code("a.py", {})
    seen.drop_stale_bytecode()
    assert said_by(said, Path.cwd()).strip() == "2"


# -- libraries and the environment -----------------------------------------------------------------


def test_versions_of_the_libraries_that_a_job_imports():
    text = "import numpy as np\nfrom sklearn.svm import SVC\nimport json, own"
    written({"scripts/a.py": text, "own.py": "def f():\n    import yaml, no_such_library"})
    seen = sources()
    libraries = seen.libraries(names(seen.code("a.py", {})))
    assert libraries == {
        "no_such_library": "not installed",
        "numpy": library_version("numpy"),
        "sklearn": library_version("scikit-learn"),
        "yaml": library_version("PyYAML"),
    }
    # a distribution of another name, which nobody has listed
    written({"own.py": "import mpl_toolkits"})
    assert "matplotlib" in sources().libraries(["own"])["mpl_toolkits"]


def test_libraries_count_where_the_config_wants_it(monkeypatch):
    written({"scripts/a.py": "import numpy"})
    assert "library:numpy" not in sources().code("a.py", {})
    monkeypatch.setattr(code, "library_version", lambda _: "9.9")
    versions = sources(with_libraries=True).code("a.py", {})
    assert versions.keys() == {"a.py", "library:numpy"}
    assert versions["library:numpy"] == "9.9"


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
    assert expected
    assert all(re.fullmatch(r"\w+ \S+ \w*, threads \d+", one) for one in expected)
    of_scipy = {**libraries[0], "version": "0", "filepath": "/numpy-study/scipy.libs/blas.so"}
    monkeypatch.setattr(environment, "threadpool_info", lambda: [*libraries, of_scipy])
    assert environment.numpy_blas() == expected
    # where NumPy has none of its own, that of the system, and nothing that is no BLAS
    system = [{**of_scipy, "filepath": "/usr/lib/blas.so"}, {**of_scipy, "user_api": "openmp"}]
    monkeypatch.setattr(environment, "threadpool_info", lambda: system)
    (found,) = environment.numpy_blas()
    assert found.split()[1] == "0"
