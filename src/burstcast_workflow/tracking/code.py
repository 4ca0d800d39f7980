"""Code that a job runs: its script, and all modules that this imports, each with a hash.

The hash is of the code without comments, formatting and docstrings. Modules that a registry finds
by name count for the jobs that are about them. The harness itself, which all jobs run, has a
version instead (`burstcast_workflow.harness.version`).
"""

import ast
import hashlib
import importlib.util
import json
import os
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from functools import cache
from importlib.metadata import packages_distributions
from pathlib import Path
from typing import NamedTuple

from burstcast_workflow.project import HARNESS, PACKAGES, VERSION
from burstcast_workflow.tracking.environment import library_version

_MEMORY = Path(".snakemake") / "burstcast_code.json"
_LIBRARIES = {"site-packages", "dist-packages"}
_FILE = "file:"
# what a package offers when it is asked says nothing about the modules that import the package
_LATE = {"__getattr__", "__dir__"}
_DISTRIBUTIONS = {"PIL": "pillow", "skimage": "scikit-image", "sklearn": "scikit-learn"} | {
    "skopt": "scikit-optimize",
    "yaml": "PyYAML",
}
# what Snakemake puts before a script that it runs ends with this
_END_OF_PREAMBLE = b"######## snakemake preamble end #########"
ByName = Mapping[str, Iterable[str]]
"""Modules that the registry of a package finds by name, by the name of the package."""


class Parsed(NamedTuple):
    """A source: the hash of its code, and the modules that it imports, relative ones with dots."""

    hash: str
    imports: list[str]


class Sources:
    """Scripts and packages of the project, and a user's own modules with the files they read.

    ``script``: File of a script, by its name. ``packages``: Directory of the project's packages.
    ``own_modules``: Files that each of a user's own modules reads, by the name of the module.
    ``with_libraries``: Whether the versions of libraries are entries, too.
    """

    def __init__(
        self,
        script: Callable[[str], Path],
        packages: Path,
        own_modules: Mapping[str, Sequence[str] | None],
        with_libraries: bool = False,
    ) -> None:
        self.script, self.packages = script, packages
        self._own, self._with_libraries = dict(own_modules), with_libraries
        self._memory: dict[str, Parsed] = {}
        with suppress(OSError, ValueError, KeyError, TypeError):
            memory = json.loads(_MEMORY.read_bytes())
            if memory["by"] == _parser():
                self._memory = {key: Parsed(*value) for key, value in memory["parsed"].items()}
        self._remembered = len(self._memory)
        self._parsed: dict[Path, Parsed] = {}
        self._places: dict[str, list[tuple[str, Path]]] = {}
        self._imported: dict[str, list[tuple[str, Path]]] = {}
        self._closures: dict[object, list[str]] = {}
        self._file = cache(self._find)

    def entries(self, script: str, by_name: ByName) -> list[str]:
        """Code of a job: ``name @hash`` for the script, each module, each file that these read."""
        key = script, *((package, *names) for package, names in by_name.items())
        if key not in self._closures:
            code = self._closure(script, by_name)
            entries = [f"{name} @{value}" for name, value in sorted(code.items())]
            if self._with_libraries:
                versions = self.libraries(code).items()
                entries += [f"{library} =={version}" for library, version in versions]
            self._closures[key] = entries
        return self._closures[key]

    def _closure(self, script: str, by_name: ByName) -> dict[str, str]:
        hashes: dict[str, str] = {}
        waiting = [(script, self.script(script))]
        while waiting:
            name, path = waiting.pop()
            if name in hashes:
                continue
            hashes[name] = self._parse(path).hash
            waiting += self._imports(name, path)
            modules = self._of_registry(name, by_name)
            waiting += [place for module in modules for place in self._located(module)]
            for file in self._own.get(name) or ():
                hashes[f"{_FILE}{name}:{file}"] = _hash((path.parent / file).read_bytes())
        return hashes

    def _imports(self, name: str, path: Path) -> list[tuple[str, Path]]:
        """Modules that a module or a script imports, with their files."""
        if name not in self._imported:
            modules = {_absolute(module, name, path) for module in self._parse(path).imports}
            places = (place for module in sorted(modules) for place in self._located(module))
            self._imported[name] = [*dict.fromkeys(places)]
        return self._imported[name]

    def _of_registry(self, name: str, by_name: ByName) -> Iterator[str]:
        package, _, module = name.rpartition(".")
        for chosen in by_name.get(package, ()) if module == "registry" else ():
            yield chosen.partition(":")[0] if ":" in chosen else f"{package}.{chosen}"

    def _located(self, module: str) -> list[tuple[str, Path]]:
        """A module with its file, and the packages that it lies in; nothing of libraries."""
        if module not in self._places:
            parts, harness = module.split("."), tuple(f"{package}." for package in HARNESS)
            names = [".".join(parts[:count]) for count in range(1, len(parts) + 1)]
            names = [VERSION if f"{name}.".startswith(harness) else name for name in names]
            self._places[module] = [(name, path) for name in names if (path := self._file(name))]
        return self._places[module]

    def _find(self, name: str) -> Path | None:
        first = name.partition(".")[0]
        if first in PACKAGES:
            return _in_directory(self.packages, name)
        if not self._own or first in sys.stdlib_module_names:
            return None
        places = [Path(place) for place in sys.path if place]
        files = (_in_directory(place, name) for place in places if not _LIBRARIES & {*place.parts})
        return next(filter(None, files), None)

    def _parse(self, path: Path) -> Parsed:
        if path not in self._parsed:
            content = path.read_bytes()
            key = _hash(content, 64)
            if key not in self._memory:
                self._memory[key] = parsed(content)
            self._parsed[path] = self._memory[key]
        return self._parsed[path]

    def _file_of_entry(self, name: str) -> Path | None:
        return self.script(name) if name.endswith(".py") else self._file(name)

    def libraries(self, names: Iterable[str]) -> dict[str, str]:
        """Versions of the libraries that scripts and modules import, by the names of entries."""
        paths = {name: self._file_of_entry(name) for name in names if not name.startswith(_FILE)}
        imported = {
            module.partition(".")[0]
            for path in paths.values()
            if path is not None
            for module in self._parse(path).imports
        }
        others = {
            name
            for name in imported - {"", *PACKAGES, *sys.stdlib_module_names}
            if self._file(name) is None
        }
        return {name: _version(name) for name in sorted(others)}

    def all_entries(self) -> list[str]:
        """Entries of all jobs that were asked for."""
        return sorted({entry for entries in self._closures.values() for entry in entries})

    def keep(self) -> None:
        """Remember hashes for the processes of jobs, and for the next run."""
        if len(self._memory) > self._remembered:
            _MEMORY.parent.mkdir(exist_ok=True)
            partial = _MEMORY.with_suffix(f".{os.getpid()}")
            partial.write_text(json.dumps({"by": _parser(), "parsed": self._memory}))
            os.replace(partial, _MEMORY)

    def changed(self, entries: Iterable[str]) -> list[str]:
        """Names of the scripts, modules and files whose code on disk is not that of the entries."""
        changed = []
        for entry in entries:
            name, _, value = entry.rpartition(" @")
            if name.startswith(_FILE):
                module, _, file = name.removeprefix(_FILE).partition(":")
                path = self._file(module)
                now = _hash((path.parent / file).read_bytes()) if path else None
            else:
                path = self._file_of_entry(name)
                now = self._parse(path).hash if path and path.is_file() else None
            changed += [name] if now != value else []
        return changed


def parsed(content: bytes) -> Parsed:
    """Hash of the code in a source, and the modules that it may import."""
    tree = ast.parse(content.rpartition(_END_OF_PREAMBLE)[2])
    tree.body = [node for node in tree.body if getattr(node, "name", "") not in _LATE]
    imports: dict[str, None] = {}
    for node in _statements(tree):
        if isinstance(node, ast.Import):
            imports |= dict.fromkeys(alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            module = "." * node.level + (node.module or "")
            names = [f"{module}{'.' * bool(node.module)}{alias.name}" for alias in node.names]
            imports |= dict.fromkeys([module, *names])
        documented = ast.Module | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef
        if isinstance(node, documented) and ast.get_docstring(node, clean=False) is not None:
            node.body = node.body[1:]
    return Parsed(_hash(ast.unparse(tree).encode("utf-8", "surrogatepass")), [*imports])


def _statements(node: ast.AST) -> Iterator[ast.AST]:
    """A node and all statements in it: a tenth of all nodes."""
    yield node
    for name in ("body", "handlers", "orelse", "finalbody", "cases"):
        for inner in getattr(node, name, ()):
            yield from _statements(inner)


def _absolute(imported: str, module: str, path: Path) -> str:
    """Name of an imported module, which begins with dots if it is relative to the importing one."""
    name = imported.lstrip(".")
    level = len(imported) - len(name)
    if not level:
        return name
    parts = module.split(".")
    parts = parts[: len(parts) - level + (path.name == "__init__.py")]
    return ".".join([*parts, *filter(None, [name])])


def _parser() -> str:
    """Hash of this module and of Python's version, which hashes depend on."""
    return _hash(Path(__file__).read_bytes() + sys.version.encode())


def _hash(content: bytes, length: int = 12) -> str:
    return hashlib.sha256(content).hexdigest()[:length]


def _version(module: str) -> str:
    version = library_version(_DISTRIBUTIONS.get(module, module))
    if version == "not installed":  # its distribution has another name
        names = packages_distributions().get(module, [])
        return ", ".join(sorted(f"{name} {library_version(name)}" for name in {*names})) or version
    return version


def _in_directory(directory: Path, module: str) -> Path | None:
    path = directory.joinpath(*module.split("."))
    candidates = path / "__init__.py", path.with_name(f"{path.name}.py")
    return next((candidate for candidate in candidates if candidate.is_file()), None)


def search_directories(configs: Iterable[str | Path], project: Path) -> list[str]:
    """Directories of a user's own modules: the working directory, then those of the configs."""
    places = [Path.cwd(), *(Path(config).absolute().parent for config in configs)]
    return [*dict.fromkeys(str(place) for place in places if place.resolve() != project.resolve())]


def make_importable(directories: Iterable[str]) -> None:
    """Let Python look for modules in these directories, too, after all others."""
    sys.path += [directory for directory in directories if directory not in sys.path]


def module_file(module: str) -> Path | None:
    """File of a module; None if there is none."""
    try:
        spec = importlib.util.find_spec(module)
    except (ImportError, ValueError):
        return None
    return Path(spec.origin).absolute() if spec and spec.has_location and spec.origin else None
