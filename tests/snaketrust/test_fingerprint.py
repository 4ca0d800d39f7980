import importlib
import re
import textwrap
from pathlib import Path

import pytest

from forbidden_code import forbidden_imports, forbidden_reads
from snaketrust.fingerprint import Sources, changed_code
from snaketrust.project import Project

VERSION = "pack.harness.version"


def sources_of(root, own_modules=None):
    """What is read now: edits are seen by another one."""
    harness = {"pack.harness": VERSION}
    places = root, root / "scripts", root / "src"
    return Sources(Project(*places, ("pack",), harness, checked=True), own_modules)


@pytest.fixture
def project(tmp_path):
    """A project of a script and a few modules, and a function that edits it."""

    def write(name, text):
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(textwrap.dedent(text))

    for name, text in {
        "scripts/train.py": "import numpy\nfrom pack.middle import middle\n",
        "src/pack/__init__.py": "",
        "src/pack/middle.py": "from pack import deep\ndef middle(): return deep.VALUE\n",
        "src/pack/deep.py": "VALUE = 1\n",
        "src/pack/unused.py": "VALUE = 1\n",
        "src/pack/sub/__init__.py": "",
        "src/pack/sub/leaf.py": "LEAF = 1\n",
        "src/pack/systems/__init__.py": "",
        "src/pack/systems/mfe.py": "import pack.sub.leaf\n",
    }.items():
        write(name, text)
    return write


def taken(tmp_path):
    return dict(entry.split("@") for entry in sources_of(tmp_path).fingerprint("train.py"))


def changed_entries(before, after):
    return [name for name in before if before[name] != after[name]]


def test_a_fingerprint_follows_imports_and_ends_and_an_edit_changes_just_its_module(
    tmp_path, project
):
    before, closure = taken(tmp_path), ["pack.deep", "pack.middle", "pack", "train.py"]
    assert list(before) == closure
    project("src/pack/deep.py", "VALUE = 2\n")
    after = taken(tmp_path)
    assert changed_entries(before, after) == ["pack.deep"]
    project("src/pack/unused.py", "VALUE = 2\n")
    # a package may offer what nobody loads by importing it: it is in all modules' fingerprints
    late = "def __getattr__(name):\n    import pack.offered\n    return pack.offered\n"
    project("src/pack/offered.py", "X = 1\n")
    project("src/pack/__init__.py", f'"""What it is."""\n{late}')
    assert taken(tmp_path) == after
    project("src/pack/deep.py", "import pack.middle\nVALUE = 1\n")  # a cycle
    assert sorted(taken(tmp_path)) == sorted(closure)
    project("src/pack/sub/__init__.py", "from .leaf import LEAF\n")  # of a package itself
    project("scripts/train.py", "import pack.sub\n")
    assert "pack.sub.leaf" in taken(tmp_path)


LEAF = {"pack", "pack.sub", "pack.sub.leaf"}
START = {"pack", "pack.sub", "pack.sub.start"}
# Statements, and what they lead to beside the script; the relative ones stand in pack.sub.start.
IMPORTS = {
    "import pack.sub.leaf | import pack.sub.leaf as l | from pack.sub import leaf": LEAF,
    "from pack.sub.leaf import LEAF | def f(): from pack.sub import leaf": LEAF,
    "if False: import pack.unused | for x in (): import pack.unused": {"pack", "pack.unused"},
    "from pack import deep, unused": {"pack", "pack.deep", "pack.unused"},
    "import neighbour": {"beside:neighbour.py"},
    "import json, numpy, os.path": set(),  # Python finds libraries first
    "from pack import missing": {"pack"},
    "from . import leaf | from .leaf import LEAF": START | LEAF,
    "from .. import deep | from ..deep import VALUE": START | {"pack.deep"},
    "def f(): from ..systems import mfe": START | LEAF | {"pack.systems", "pack.systems.mfe"},
}


@pytest.mark.parametrize(
    ("statement", "expected"),
    [(one, IMPORTS[every]) for every in IMPORTS for one in every.split(" | ")],
)
def test_a_fingerprint_follows_all_forms_of_import(tmp_path, project, statement, expected):
    for name in ("neighbour", "json", "numpy"):
        project(f"scripts/{name}.py", "X = 1\n")
    project("scripts/train.py", "import pack.sub.start\n")
    relative = "from ." in statement
    project("src/pack/sub/start.py" if relative else "scripts/train.py", statement + "\n")
    assert set(taken(tmp_path)) == expected | {"train.py"}


def test_sources_are_read_once_and_callers_cannot_spoil_what_is_kept(
    tmp_path, project, monkeypatch
):
    sources = sources_of(tmp_path)
    found = sources.fingerprint("train.py")
    sources.fingerprint("train.py").clear()
    monkeypatch.setattr(Path, "read_bytes", lambda path: pytest.fail(f"{path} is read again"))
    assert sources.fingerprint("train.py") == found != []


FORBIDDEN = {
    forbidden_imports: """import importlib | import json, runpy | import importlib.metadata
        from importlib import import_module | def f(): import importlib as i
        __import__('pack') | exec('x = 1') | y = eval | from pack import * | from .sub import *""",
    forbidden_reads: """a = snakemake.config['horizon'] | a = snakemake.wildcards.seed
        a = snakemake.threads | s = snakemake | s: object = snakemake | f(snakemake)
        run_job(snakemake, main) | getattr(snakemake, 'config')""",
}


@pytest.mark.parametrize(
    ("find", "statement"),
    [(find, one.strip()) for find in FORBIDDEN for one in re.split(r" \| |\n", FORBIDDEN[find])],
)
def test_code_that_fingerprints_cannot_follow_is_found(tmp_path, find, statement):
    path = tmp_path / "module.py"
    path.write_text(f"import math\n{statement}\n")
    (place,) = find(path)
    assert place.startswith("line 2: ")
    ordinary = "from importlib.metadata import version\nimport re\nre.compile('x')\nt.eval(1)\n"
    path.write_text(f"{ordinary}@job\ndef main(*, settings):\n    pass\n")
    assert find(path) == []


# -- the harness and registries --------------------------------------------------------------------


@pytest.fixture
def harnessed(project):
    """The project, with a harness that the script runs in, and two registries."""
    for name, text in {
        "src/pack/harness/__init__.py": "",
        "src/pack/harness/version.py": "VERSION = 1\n",
        "src/pack/harness/job.py": "import pack.deep\n",
        "src/pack/systems/registry.py": "",
        "src/pack/systems/lorenz.py": "X = 1\n",
        "src/pack/kinds/__init__.py": "",
        "src/pack/kinds/registry.py": "",
        "src/pack/kinds/linear.py": "",
        "scripts/train.py": "from pack.harness.job import run_job\n",
    }.items():
        project(name, text)
    return project


def test_of_the_harness_only_the_version_counts(tmp_path, harnessed):
    before = taken(tmp_path)
    # nor does what only the harness imports
    assert set(before) == {"train.py", "pack", VERSION}
    harnessed("src/pack/harness/job.py", "import pack.middle\nX = 1\n")
    assert taken(tmp_path) == before
    harnessed("src/pack/harness/version.py", "VERSION = 2\n")
    assert changed_entries(before, taken(tmp_path)) == [VERSION]


def test_registries_add_the_modules_that_a_job_is_about(tmp_path, harnessed):
    def names(registry, *systems):
        harnessed("scripts/train.py", f"import {registry}\n")
        by_name = {"pack.systems": [*systems], "pack.kinds": ["linear"] if systems else []}
        found = sources_of(tmp_path).fingerprint("train.py", by_name)
        return {entry.split("@")[0] for entry in found}

    of_system = {"pack.systems.mfe", "pack.sub", "pack.sub.leaf"}  # and not another system
    registries = (
        ("pack.systems.registry", of_system),
        ("pack.kinds.registry", {"pack.kinds.linear"}),
    )
    for registry, found in [*registries, ("pack.deep", set())]:
        assert names(registry, "mfe") == names(registry) | found
        assert not names(registry) & found
    with pytest.raises(FileNotFoundError, match=r"pack\.systems\.rossler"):
        names("pack.systems.registry", "rossler")


# -- modules of a user -----------------------------------------------------------------------------


class User:
    """Two directories that Python finds modules in, and a system of the user's own."""

    def __init__(self, directory):
        self.project, self.here, self.beside = (
            directory / name for name in ("project", "user/here", "user/beside")
        )

    def write(self, path, text):
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(text if isinstance(text, bytes) else text.encode())
        importlib.invalidate_caches()  # files that are new within a tick of the clock

    def entries(self, files=None):
        """Fingerprints of a job that is about the system, and of all code of the plan."""
        sources = sources_of(self.project, {"flows.system": files})
        found = sources.fingerprint("job.py", {"pack.systems": ["flows.system:System"]})
        everything = {*sources.all_code()}
        assert {entry for entry in found if not entry.startswith(("pack", "job"))} <= everything
        return dict(entry.rsplit("@", 1) for entry in found)


@pytest.fixture
def user(tmp_path, monkeypatch):
    user = User(tmp_path)
    for path, text in {
        user.project / "src/pack/systems/registry.py": "",
        user.project / "src/pack/systems/__init__.py": "",
        user.project / "src/pack/__init__.py": "",
        user.project / "scripts/job.py": "import pack.systems.registry\n",
        user.here / "flows/__init__.py": "",
        user.here / "flows/system.py": "from . import part\nimport scan, numpy, json\n",
        user.here / "flows/part.py": "X = 1\n",
        user.here / "flows/table.csv": "1\n",
        user.here / "scan.py": "X = 1\n",
        user.beside / "scan.py": "X = 1\n",
        user.beside / "other.py": "X = 1\n",
        user.project / "scripts/scan.py": "X = 1\n",
    }.items():
        user.write(path, text)
    for directory in (user.beside, user.here):
        monkeypatch.syspath_prepend(str(directory))
    return user


PLAIN = {"job.py", "pack", "pack.systems", "pack.systems.registry"}
OWN = {"flows", "flows.system", "flows.part", "scan"}


# What is edited, and what else there is then: each has to change the fingerprint of one module.
@pytest.mark.parametrize(
    ("path", "text", "changed"),
    [
        ("here/flows/part.py", '"""Words."""\nX = 1\n', {"flows.part"}),
        ("here/flows/part.py", "X = 1\npass\n", {"flows.part"}),
        ("here/flows/part.py", "# a comment\nX  =  1\n", set()),
        ("here/scan.py", "X = 2\n", {"scan"}),  # the first that Python finds
        ("beside/scan.py", "X = 2\n", set()),
        ("../project/scripts/scan.py", "X = 2\n", set()),
        ("here/flows/part/__init__.py", "X = 1\nY = 1\n", {"flows.part"}),  # a package comes first
        ("here/flows/part.abi3.so", b"\x7fELF", {"flows.part"}),  # and what is compiled
        ("here/flows/part.pyi", "X: int\n", set()),
        ("here/flows/unused.py", "X = 1\n", set()),
        (
            "here/flows/system.py",
            "from . import part\nimport other, scan\n",
            {"flows.system", "other"},
        ),
        ("here/flows/table.csv", "2\n", {"file:flows.system:table.csv"}),
    ],
)
def test_all_of_a_users_modules_counts(user, path, text, changed):
    before = user.entries(["table.csv"])
    assert set(before) == PLAIN | OWN | {"file:flows.system:table.csv"}
    user.write(user.here.parent / path, text)
    after = user.entries(["table.csv"])
    assert {name for name in after if before.get(name) != after[name]} == changed


def test_a_link_counts_as_what_it_leads_to(user):
    (user.here / "flows/part.py").unlink()
    (user.here / "flows/part.py").symlink_to(user.beside / "other.py")
    before = user.entries()
    user.write(user.beside / "other.py", "X = 2\n")
    assert before.keys() == user.entries().keys()
    assert before["flows.part"] != user.entries()["flows.part"]


def test_packages_without_a_file_of_their_own_and_stars_are_followed(user):
    user.write(user.here / "space/deep/one.py", "import space.deep.two\n")
    user.write(user.beside / "space/deep/two.py", "X = 1\n")  # the other part of the package
    user.write(user.here / "scan.py", "import space.deep.one\n")
    assert set(user.entries()) == PLAIN | OWN | {"space.deep.one", "space.deep.two"}
    user.write(user.here / "scan.py", "from stars import *\n")
    user.write(user.here / "stars/__init__.py", "__all__ = ['a']\n")
    user.write(user.here / "stars/a.py", "X = 1\n")
    assert set(user.entries()) == PLAIN | OWN | {"stars", "stars.a"}


def test_what_a_users_module_reads_is_to_be_declared(user):
    part = user.here / "flows/part.py"
    for line, said in {
        "x = numpy.loadtxt('a.csv')": "numpy.loadtxt()",
        "with open('a.csv') as f: pass": "open()",
        "x = (Path(__file__) / 'a').read_text()": "(Path(__file__) / 'a').read_text()",
        "x = importlib.import_module('a')": "importlib.import_module()",
        "x = pandas.read_csv('a')": "pandas.read_csv()",
        "x = importlib.resources.files('a')": "importlib.resources.files()",
        "import sys; sys.path.append('a')": "sys.path",
        "x = re.compile('a')": "",
        "x = opened('a')": "",
    }.items():
        user.write(part, line)
        found = sources_of(user.project, {"flows.system": None}).undeclared()
        assert found == ([(part, f"line 1: {said}")] if said else [])
        assert sources_of(user.project, {"flows.system": []}).undeclared() == []


# -- in a job --------------------------------------------------------------------------------------


def test_a_job_names_the_code_that_is_not_what_was_planned(tmp_path, project, monkeypatch):
    monkeypatch.syspath_prepend(str(tmp_path / "src"))
    script, sources = tmp_path / "scripts" / "train.py", sources_of(tmp_path)
    code, planned = sources.fingerprint("train.py"), sources.all_code()

    def changed(code=code, planned=planned):
        return changed_code(script, code, planned)

    assert changed() == changed(planned={}) == []
    for text, found in [
        ("# a comment\nVALUE = 1\n", []),
        ("VALUE = 2\n", ["pack.deep"]),
        ("VALUE =\n", ["pack.deep"]),
    ]:
        project("src/pack/deep.py", text)
        assert changed() == changed(planned={}) == found
    (tmp_path / "src/pack/deep.py").unlink()
    assert changed() == ["pack.deep"]
    # on a cluster fingerprints are taken anew, and agree with the files
    project("src/pack/deep.py", "VALUE = 2\n")
    assert changed(sources_of(tmp_path).fingerprint("train.py")) == ["pack.deep"]


def test_a_job_sees_the_files_of_a_users_module(user):
    sources = sources_of(user.project, {"flows.system": ["table.csv"]})
    code = sources.fingerprint("job.py", {"pack.systems": ["flows.system:System"]})
    own = [entry for entry in code if not entry.startswith("pack")]
    script, planned = user.project / "scripts" / "job.py", sources.all_code()
    assert changed_code(script, own, planned) == []
    user.write(user.here / "flows/table.csv", "2\n")
    user.write(user.here / "flows/part.py", "X = 2\n")
    assert changed_code(script, own, planned) == ["file:flows.system:table.csv", "flows.part"]
