"""Fingerprints of code: what a script runs, insensitive to how it is written down.

Snakemake does not notice that a module which a script imports has changed. Each rule therefore
carries the fingerprints of its script and of all modules of the project that the script reaches
through imports, as a parameter, and Snakemake compares them as it does any other parameter.

A fingerprint is a hash of what a file's code does (`burstcast_workflow.code_hash`). What imports
do not show must not happen, and a test keeps it out. Two things are known otherwise:

* Modules that a registry finds by name (systems, forecasters, validation strategies). A script that
  reaches a registry depends on those of its modules that its job is about, and on no others. A
  system of a user's own lies elsewhere: all that its module imports counts, too, as far as it is
  not installed, and so do the files that the config declares for it.
* The harness, which runs scripts, logs, caches, and reads and writes files (the NetCDF files with
  `burstcast.netcdf`). It is in no fingerprint: an edit of it would run everything again. Instead,
  the one number of `burstcast_workflow.harness.version` is, raised when the harness changes what
  a file holds; tests hold that for each version.
"""

import os
from collections.abc import Collection, Iterable, Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import NamedTuple

from burstcast.discovery import module_file
from burstcast_workflow import code_hash
from burstcast_workflow.code_hash import HASH_LENGTH, code_of
from burstcast_workflow.harness.records import digest
from burstcast_workflow.project import is_installed, packages_of

_HARNESS = ("burstcast_workflow.harness.", "burstcast.netcdf.")
_VERSION = "burstcast_workflow.harness.version"
# the project's packages, where others may lie in the same directory
_OURS = ("burstcast", "burstcast_workflow")
# where libraries are: their versions count, not their code
_LIBRARIES = {"site-packages", "dist-packages"}
_STANDARD_LIBRARY = os.path.dirname(os.__file__)
_FILE = "file:"
"""Begins the fingerprint of a file that a user's module reads."""


class Sources:
    """The project's sources, as the rules see them.

    Parameters
    ----------
    root
        The project's directory.
    own_modules
        Modules outside the project that have systems, with the files that they read; None where
        the config does not say which.
    """

    def __init__(
        self, root: Path, own_modules: Mapping[str, Sequence[str] | None] | None = None
    ) -> None:
        self._packages, self._scripts = packages_of(root), root / "workflow" / "scripts"
        self._own_modules = dict(own_modules or {})

    def fingerprint(self, script: str, found_by_name: Mapping[str, Sequence[str]]) -> list[str]:
        """Fingerprints of the code of a job (see `fingerprint`).

        Parameters
        ----------
        script
            Below ``workflow/scripts``.
        found_by_name
            By package with a ``registry``: the modules of it that the job is about; with a colon,
            module and class outside of it.
        """
        path, known = self._scripts / script, set[str]()
        while True:
            entries = fingerprint(path, self._packages, sorted({*known, *self._files(known)}))
            reached = {entry.partition("@")[0] for entry in entries}
            more = {
                module.partition(":")[0] if ":" in module else f"{package}.{module}"
                for package, modules in found_by_name.items()
                if f"{package}.registry" in reached
                for module in modules
            }
            if more <= known:
                return entries
            known = more  # what is found by name may reach another registry

    def all_fingerprints(self) -> list[str]:
        """Fingerprints of all modules and all scripts, in the form of `fingerprint`."""
        entries = [f"{path.name}@{code_of(path).digest}" for path in self._scripts.rglob("*.py")]
        for path in self._packages.glob("burstcast*/**/*.py"):
            parts = path.relative_to(self._packages).with_suffix("").parts
            module = ".".join(parts).removesuffix(".__init__")
            entries.append(f"{module}@{code_of(path).digest}")
        entries += [
            f"{name}@{one.code.digest}" for name, one in self._own(self._own_modules).items()
        ]
        entries += map(_file_entry, self._files(self._own_modules))
        return sorted(set(entries))

    def _files(self, modules: Iterable[str]) -> list[str]:
        """Files that users' modules read, as `fingerprint` takes them."""
        return [
            f"{_FILE}{module}:{file}"
            for module in modules
            for file in self._own_modules.get(module) or ()
        ]

    def own_files(self) -> list[Path]:
        """Files of modules outside the project: those with systems, and what they import."""
        return [module.path for module in self._own(self._own_modules).values()]

    def undeclared(self) -> list[str]:
        """Places where users' modules read something, and the config does not say what."""
        silent = [name for name, files in self._own_modules.items() if files is None]
        return [
            f"{module.path}, {place} reads a file that the config does not declare: list it in the "
            f"setting files, beside system (files: [] if there is none)"
            for module in self._own(silent).values()
            for place in module.code.reads
        ]

    def _own(self, by_name: Iterable[str]) -> "dict[str, _Module]":
        found = _reached([], self._packages, [*by_name])
        return {name: module for name, module in found.items() if module.own}


def fingerprint(script: Path, source_root: Path, extra_modules: Sequence[str] = ()) -> list[str]:
    """Fingerprints of a script and of the project's modules that it uses.

    Files are read once per process: what is edited while the workflow runs counts at its next run.

    Parameters
    ----------
    script
        The script's file. It may import the project's packages.
    source_root
        Directory of the project's packages.
    extra_modules
        Modules that the script reaches otherwise than by importing them: the dynamical system,
        which is found by its name; and files that they read, as ``file:<module>:<path>``, the path
        from the directory of the module.

    Returns
    -------
    list of str
        Sorted entries ``module@hash``; the script's is ``name.py@hash``.

    Raises
    ------
    FileNotFoundError
        If the script, one of the extra modules or one of their files does not exist.
    SyntaxError
        If one of the files is not Python.
    """
    return list(_fingerprint(Path(script), Path(source_root), tuple(extra_modules)))


def forget_files() -> None:
    """Forget all files that were read, so that edits are seen by this process."""
    _fingerprint.cache_clear()
    code_hash.forget_files()
    _located.cache_clear()
    _found.cache_clear()
    _file_entry.cache_clear()


class _Module(NamedTuple):
    """File of a module, and whether it is a user's own."""

    path: Path
    own: bool

    @property
    def code(self) -> code_hash.Code:
        return code_of(self.path, strict=self.own)


@cache
def _fingerprint(script: Path, source_root: Path, extra_modules: tuple[str, ...]) -> list[str]:
    modules = [name for name in extra_modules if not name.startswith(_FILE)]
    code = code_of(script)
    waiting = [name for name, level in code.imports if level == 0]
    found = _reached(waiting, source_root, modules)
    for module in modules:
        if module not in found:
            raise FileNotFoundError(f"there is no module {module} in {source_root}")
    entries = [f"{name}@{module.code.digest}" for name, module in found.items()]
    files = [_file_entry(name) for name in extra_modules if name not in modules]
    return sorted([*entries, *files, f"{script.name}@{code.digest}"])


@cache
def _file_entry(name: str) -> str:
    module, _, file = name.removeprefix(_FILE).partition(":")
    directory = (_found(module) or Path()).parent
    return f"{name}@{digest(directory / file)[:HASH_LENGTH]}"


def _reached(
    imported: Sequence[str], source_root: Path, by_name: Sequence[str]
) -> dict[str, _Module]:
    """Modules of the project, users' modules, and all that they import, by their names."""
    found: dict[str, _Module] = {}
    packages = {name.partition(".")[0] for name in by_name}
    # with whether a user's module may be meant
    waiting = [*((name, False) for name in imported), *((name, True) for name in by_name)]
    while waiting:
        wanted, maybe_own = waiting.pop()
        for name in _with_parents(wanted):
            module = _VERSION if f"{name}.".startswith(_HARNESS) else name
            if module in found:
                continue
            path, own = _located(module, source_root), False
            if path is None and maybe_own:
                path, own = _own_file(module, packages), True
            if path is None:
                continue
            found[module] = _Module(path, own)
            package = module if path.stem == "__init__" else module.rpartition(".")[0]
            imports = found[module].code.imports
            waiting += [(_absolute(name, level, package), own) for name, level in imports]
        # a package may name modules of its own in __all__
        package, _, star = wanted.rpartition(".")
        if star == "*" and package in found and found[package].path.stem == "__init__":
            beside = {file.stem for file in found[package].path.parent.iterdir()} - {"__init__"}
            waiting += [(f"{package}.{name}", True) for name in beside]
    return found


def _own_file(module: str, packages: Collection[str]) -> Path | None:
    """File of a user's module; None for libraries, unless they are the user's own packages."""
    path = _found(module)
    if path is None or module.partition(".")[0] in packages:
        return path
    library = _LIBRARIES.intersection(path.parts) or path.is_relative_to(_STANDARD_LIBRARY)
    return None if library else path


_found = cache(module_file)


def _absolute(name: str, level: int, package: str) -> str:
    """Name that ``level`` leading dots and ``name`` stand for in a module of ``package``."""
    if level == 0:
        return name
    parts = package.split(".")
    base = parts[: len(parts) - (level - 1)]
    return ".".join([*base, *filter(None, [name])])


def _with_parents(name: str) -> list[str]:
    """List the packages that a module lies in, and it: an import runs them all."""
    parts = name.split(".")
    return [".".join(parts[:count]) for count in range(1, len(parts) + 1)]


@cache
def _located(module: str, source_root: Path) -> Path | None:
    """File of a module of the project; None for other modules, and names that are no modules."""
    first, *_ = parts = module.split(".")
    if first not in _OURS and is_installed(source_root):
        return None
    path = source_root.joinpath(*parts)
    candidates = path / "__init__.py", path.with_name(path.name + ".py")
    return next((candidate for candidate in candidates if candidate.is_file()), None)
