"""Fingerprints of the code that a script runs, insensitive to layout and comments.

Snakemake does not notice that a module which a script imports has changed. Each rule therefore
carries the fingerprints of its script and of all modules of the project that the script reaches
through imports, as a parameter, and Snakemake compares them as it does any other parameter.

A fingerprint is a hash of what a file's code does (`snaketrust.code_hash`). Code that is reached
without an import is not seen; a test of the project should forbid it. There are two exceptions:

* Modules that are found by name, in a package with a module ``registry``. A script that reaches a
  registry depends on the modules that its job is about, and on no others. A user's own module is
  outside the package: everything that it imports counts, too, unless it is installed, and so do the
  files that are declared for it.
* Code that all jobs run, such as logging and writing of files: an edit of it would run everything
  again. A module with a version stands for it (`Project.stand_ins`).
"""

import hashlib
import os
import sys
from collections.abc import Collection, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from snaketrust.code_hash import HASH_LENGTH, Code, Codes, parsed
from snaketrust.files import digest
from snaketrust.modules import SUFFIXES, UnlikeCodeError, module_file
from snaketrust.project import Project

# where libraries are: their versions count, not their code
_LIBRARIES = {"site-packages", "dist-packages"}
_STANDARD_LIBRARY = os.path.dirname(os.__file__)
_FILE = "file:"
"""Begins the fingerprint of a file that a user's module reads."""
_BESIDE = "beside:"
"""Begins the fingerprint of a module beside a script, by its path from the script's directory."""


class _Module(NamedTuple):
    """Name and file of a module."""

    name: str
    path: Path
    own: bool  # whether it is a user's own
    scripts: Path | None = None  # directory of the script that imports it, where Python looks last


class Sources:
    """The project's sources. Files are read once: edits count for another instance.

    ``own_modules`` are modules outside the project that are found by name, with the files that they
    read; None if these are not declared.
    """

    def __init__(
        self,
        project: Project,
        own_modules: Mapping[str, Sequence[str] | None] | None = None,
        memory: Path | None = None,
    ) -> None:
        self._project, self._own_modules = project, dict(own_modules or {})
        self.scripts, self.packages = project.scripts, project.sources
        self._own_packages = {name.partition(".")[0] for name in self._own_modules}
        self.codes = Codes(memory)
        self._located: dict[tuple[str, bool], _Module | None] = {}
        self._near: dict[tuple[str, Path | None], _Module | None] = {}
        self._names: dict[Path, set[str]] = {}  # of what lies in a directory of scripts
        self._imported: dict[_Module, list[_Module]] = {}
        self._fingerprints: dict[object, list[str]] = {}
        self._beneath: dict[str, bool] = {}
        self.unseen: dict[str, None] = {}  # places of the project's code that no fingerprint sees
        self._strict = not project.checked

    # -- of a job ----------------------------------------------------------------------------------

    def fingerprint(
        self, script: str, found_by_name: Mapping[str, Sequence[str]] | None = None
    ) -> list[str]:
        """Fingerprints of the code of a job: sorted entries ``module@hash``.

        The script is ``name.py@hash``, a module beside it ``beside:path@hash``, a file that a
        user's module reads ``file:module:path@hash``. `FileNotFoundError` if the script, a module
        or one of their files does not exist, `SyntaxError` if it is not Python.

        ``found_by_name`` has, by package with a ``registry``, the modules of it that the job is
        about; with a colon, module and class outside of the package.
        """
        found_by_name = found_by_name or {}
        key = script, *((name, *modules) for name, modules in found_by_name.items())
        if key not in self._fingerprints:
            path, known = self._project.scripts / script, set[str]()
            own_code = self.codes.of(path, strict=self._strict)
            imported = [
                module
                for name, level in own_code.imports
                if level == 0
                for module in self._run_by_import(name, False, path.parent)
            ]
            while True:
                found = self._reached([*imported, *self._by_name(known)])
                more = {
                    module.partition(":")[0] if ":" in module else f"{package}.{module}"
                    for package, modules in found_by_name.items()
                    if f"{package}.registry" in found
                    for module in modules
                }
                if more <= known:
                    break
                known = more  # what is found by name may reach another registry
            entries = [self._entry(module) for module in found.values()]
            files = [_file_entry(name) for name in self._files(known)]
            script_entry = f"{path.name}@{own_code.digest}"
            if self._strict:
                codes = [(one.name, self._code(one)) for one in found.values() if not one.own]
                for name, code in [(path.name, own_code), *codes]:
                    self.unseen |= dict.fromkeys(f"{name}, {place}" for place in code.unseen)
            self._fingerprints[key] = sorted([*entries, *files, script_entry])
        return list(self._fingerprints[key])

    def _reached(self, waiting: list[_Module]) -> dict[str, _Module]:
        """Modules, and all that they import."""
        found: dict[str, _Module] = {}
        while waiting:
            module = waiting.pop()
            if module.name not in found:
                found[module.name] = module
                waiting += self._imports(module)
        return found

    def _by_name(self, names: Iterable[str]) -> list[_Module]:
        found = [one for name in names for one in self._run_by_import(name, True)]
        if missing := {*names} - {one.name for one in found}:
            missed = ", ".join(sorted(missing))
            raise FileNotFoundError(f"there is no module {missed} in {self._project.sources}")
        return found

    def _imports(self, module: _Module) -> list[_Module]:
        """Modules that a module imports itself, and the packages that they lie in."""
        if module not in self._imported:
            is_package = module.path.stem == "__init__"
            dotted = module.name
            if module.scripts and module.name.startswith(_BESIDE):
                parts = module.path.relative_to(module.scripts).with_suffix("").parts
                dotted = ".".join(parts).removesuffix(".__init__")
            package = dotted if is_package else dotted.rpartition(".")[0]
            found: dict[str, _Module] = {}
            for name, level in self._code(module).imports:
                absolute = _absolute(name, level, package)
                for one in self._run_by_import(absolute, module.own, module.scripts):
                    found.setdefault(one.name, one)
            self._imported[module] = [*found.values()]
        return self._imported[module]

    def _run_by_import(
        self, wanted: str, maybe_own: bool, scripts: Path | None = None
    ) -> list[_Module]:
        """Modules that an import runs: the packages that a module lies in, and itself."""
        parts = wanted.split(".")
        names = (".".join(parts[:count]) for count in range(1, len(parts) + 1))
        located = (self._module(name, maybe_own) or self._beside(name, scripts) for name in names)
        found = [one._replace(scripts=scripts) for one in located if one is not None]
        if parts[-1] == "*" and found and found[-1].path.stem == "__init__":
            # a package may name modules of its own in __all__
            inside = {file.stem for file in found[-1].path.parent.iterdir()} - {"__init__"}
            modules = (self._module(f"{found[-1].name}.{name}", True) for name in sorted(inside))
            found += [one for one in modules if one is not None]
        return found

    def _module(self, wanted: str, maybe_own: bool) -> _Module | None:
        """The module of this name, of the project or a user's own; None for all others."""
        if (wanted, maybe_own) not in self._located:
            name = self._project.stand_in(wanted)
            path, own = self._file(name), False
            if path is None and maybe_own:
                path, own = _own_file(name, self._own_packages), True
            self._located[wanted, maybe_own] = None if path is None else _Module(name, path, own)
        return self._located[wanted, maybe_own]

    def _beside(self, module: str, scripts: Path | None) -> _Module | None:
        """The module of this name beside a script; None if Python finds another one first."""
        if scripts and (module, scripts) not in self._near:
            first, name = module.split(".")[0], self._project.stand_in(module)
            if scripts not in self._names:
                self._names[scripts] = {one.name.split(".")[0] for one in scripts.iterdir()}
            self._near[module, scripts] = None
            if first not in sys.stdlib_module_names and name.split(".")[0] in self._names[scripts]:
                path = _file_in(scripts, name)
                if path and not module_file(first):
                    name = f"{_BESIDE}{path.relative_to(scripts)}"
                    self._near[module, scripts] = _Module(name, path, False)
        return self._near[module, scripts] if scripts else None

    def _file(self, module: str) -> Path | None:
        """File of a module of the project; None for other names."""
        if not self._is_beneath(module.partition(".")[0]):
            return None
        return _file_in(self._project.sources, module)

    def _is_beneath(self, first: str) -> bool:
        """Whether Python imports a package, or a module, from the sources."""
        sources = self._project.sources
        if first not in self._beneath:
            maybe = first in self._project.packages
            there = _file_in(sources, first) or (sources / first).is_dir()
            if not maybe and there and not _LIBRARIES.intersection(sources.parts):
                path = module_file(first)  # none of a package without __init__.py
                maybe = path is None or path.resolve().is_relative_to(sources.resolve())
            self._beneath[first] = maybe
        return self._beneath[first]

    def _code(self, module: _Module) -> Code:
        return self.codes.of(module.path, strict=module.own or self._strict)

    def _entry(self, module: _Module) -> str:
        return f"{module.name}@{self._code(module).digest}"

    # -- of all ------------------------------------------------------------------------------------

    def all_code(self) -> dict[str, str]:
        """Fingerprints of all modules, scripts and files, each with the SHA-256 of its bytes."""
        found, scripts = {}, self._project.scripts
        for path in scripts.rglob("*.py"):
            digest_, content = self._hashes(path)
            found[f"{path.name}@{digest_}"] = content
            for above in [*path.parents][: len(path.relative_to(scripts).parts)]:
                found[f"{_BESIDE}{path.relative_to(above)}@{digest_}"] = content
        beneath = [one for one in self._located.values() if one is not None and not one.own]
        names = {path: self._project.name_of(path) for path in self._project.files()}
        for path, name in {**{one.path: one.name for one in beneath}, **names}.items():
            digest_, content = self._hashes(path)
            found[f"{name}@{digest_}"] = content
        for module in self._own(self._own_modules):
            content = self.codes.content(module.path, strict=True)
            found[self._entry(module)] = content
        for name in self._files(self._own_modules):
            found[_file_entry(name)] = digest(_place(name))
        return found

    def _hashes(self, path: Path) -> tuple[str, str]:
        """Code hash of a file of the project, and the SHA-256 of its bytes."""
        digest_ = self.codes.of(path, strict=self._strict).digest
        return digest_, self.codes.content(path, strict=self._strict)

    def reached(self) -> list[Path]:
        """Files of all modules that fingerprints were taken of."""
        return [module.path for module in self._imported if module.path.suffix == ".py"]

    def own_files(self) -> list[Path]:
        """Files of modules outside the project: those found by name, and what they import."""
        return [module.path for module in self._own(self._own_modules)]

    def undeclared(self) -> list[tuple[Path, str]]:
        """Files of users' modules, and places in them that read undeclared files."""
        silent = [name for name, files in self._own_modules.items() if files is None]
        return [
            (module.path, place)
            for module in self._own(silent)
            for place in self._code(module).reads
        ]

    def _own(self, names: Iterable[str]) -> list[_Module]:
        """A user's own modules among these and what they import."""
        return [one for one in self._reached(self._by_name(names)).values() if one.own]

    def _files(self, modules: Iterable[str]) -> list[str]:
        """Files that users' modules read: ``file:module:path``, from the module's directory on."""
        return [
            f"{_FILE}{module}:{file}"
            for module in modules
            for file in self._own_modules.get(module) or ()
        ]


def _file_in(directory: Path, module: str) -> Path | None:
    """File of a module that Python finds from a directory on: package, compiled or plain."""
    path = directory.joinpath(*module.split("."))
    candidates = path / "__init__.py", *(path.with_name(path.name + one) for one in SUFFIXES)
    return next((candidate for candidate in candidates if candidate.is_file()), None)


def _own_file(module: str, packages: Collection[str]) -> Path | None:
    """File of a user's module; None for libraries, unless they are the user's own packages."""
    path = module_file(module)
    if path is None or module.partition(".")[0] in packages:
        return path
    library = _LIBRARIES.intersection(path.parts) or path.is_relative_to(_STANDARD_LIBRARY)
    return None if library else path


def _absolute(name: str, level: int, package: str) -> str:
    """Name that ``level`` leading dots and ``name`` stand for in a module of ``package``."""
    if level == 0:
        return name
    parts = package.split(".")
    base = parts[: len(parts) - (level - 1)]
    return ".".join([*base, *filter(None, [name])])


def _file_entry(name: str) -> str:
    return f"{name}@{digest(_place(name))[:HASH_LENGTH]}"


def _place(file: str) -> Path:
    """Path of a file that a user's module reads."""
    module, _, path = file.removeprefix(_FILE).partition(":")
    return (module_file(module) or Path()).parent / path


# -- in a job --------------------------------------------------------------------------------------


def changed_code(script: Path, code: Sequence[str], planned: Mapping[str, str]) -> list[str]:
    """Names of the script, modules and files that are not what they were when the run was planned.

    ``code`` has the fingerprints of the rule, which a cluster takes anew for every job; ``planned``
    those of all code when the run was planned (`Sources.all_code`), empty where none was.
    """
    changed = []
    for entry in code:
        name, _, expected = entry.rpartition("@")
        path = script if name == script.name else _located(name, script.parent)
        if (planned and entry not in planned) or not _has_code(path, expected, planned.get(entry)):
            changed.append(name)
    return changed


def _located(name: str, scripts: Path) -> Path | None:
    if name.startswith(_BESIDE):
        return scripts / name.removeprefix(_BESIDE)
    return _place(name) if name.startswith(_FILE) else module_file(name)


def _has_code(path: Path | None, expected: str, content: str | None) -> bool:
    """Whether a file has the code of a fingerprint, or even the bytes of this SHA-256."""
    if path is None or not path.is_file():
        return False
    source = path.read_bytes()
    found = hashlib.sha256(source).hexdigest()
    if found == content or found.startswith(expected):
        return True
    try:
        return path.suffix == ".py" and expected in {
            parsed(source, str(path), strict=strict).digest for strict in (False, True)
        }
    except SyntaxError:
        return False


def check_code(script: Path, code: Sequence[str], planned: Mapping[str, str]) -> None:
    """Check that the code on disk is what fingerprints were taken of (`changed_code`)."""
    if changed := changed_code(script, code, planned):
        raise UnlikeCodeError(
            f"{', '.join(changed)} changed after the workflow was planned: nothing is kept of this "
            f"job; run the workflow again when the edit is done"
        )


def script_of(snakemake: Any) -> Path:
    """File of a job's script, from the object that Snakemake puts into it."""
    names = [str(entry).rpartition("@")[0] for entry in snakemake.params.code]
    (script,) = [name for name in names if name.endswith(".py") and ":" not in name]
    return Path(snakemake.scriptdir) / script
