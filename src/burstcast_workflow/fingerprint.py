"""Fingerprints of code: what a script runs, insensitive to how it is written down.

Snakemake does not notice that a module which a script imports has changed. Each rule therefore
carries the fingerprints of its script and of all modules of the project that the script reaches
through imports, as a parameter, and Snakemake compares them as it does any other parameter.

A fingerprint is a hash of what a file's code does (`burstcast_workflow.code_hash`). What imports
do not show must not happen, and a test keeps it out. Two things are known otherwise:

* Modules that a registry finds by name (systems, forecasters, validation strategies). A script that
  reaches a registry depends on those of its modules that its job is about, and on no others. A
  system of one's own lies elsewhere: what its module imports of the same directory, or of the same
  installed package, counts, too.
* The harness, which runs scripts, logs, caches, and reads and writes files (the NetCDF files with
  `burstcast.netcdf`). It is in no fingerprint: an edit of it would run everything again. Instead,
  the one number of `burstcast_workflow.harness.version` is, raised when the harness changes what
  a file holds; tests hold that for each version.
"""

from collections.abc import Mapping, Sequence
from functools import cache
from pathlib import Path

from burstcast.discovery import top_level_directory
from burstcast_workflow import code_hash
from burstcast_workflow.code_hash import code_of
from burstcast_workflow.project import is_installed, packages_of

_HARNESS = ("burstcast_workflow.harness.", "burstcast.netcdf.")
_VERSION = "burstcast_workflow.harness.version"
# the project's packages, where others may lie in the same directory
_OURS = ("burstcast", "burstcast_workflow")


class Sources:
    """The project's sources, as the rules see them.

    Parameters
    ----------
    root
        The project's directory.
    own_modules
        Names of modules outside the project that have systems.
    """

    def __init__(self, root: Path, own_modules: Sequence[str] = ()) -> None:
        self._packages, self._scripts = packages_of(root), root / "workflow" / "scripts"
        self._own_modules = tuple(own_modules)

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
        path = self._scripts / script
        entries = fingerprint(path, self._packages)
        reached = {entry.partition("@")[0] for entry in entries}
        more = [
            module.partition(":")[0] if ":" in module else f"{package}.{module}"
            for package, modules in found_by_name.items()
            if f"{package}.registry" in reached
            for module in modules
        ]
        return fingerprint(path, self._packages, sorted(more)) if more else entries

    def all_fingerprints(self) -> list[str]:
        """Fingerprints of all modules and all scripts, in the form of `fingerprint`."""
        entries = [f"{path.name}@{code_of(path).digest}" for path in self._scripts.rglob("*.py")]
        for path in self._packages.glob("burstcast*/**/*.py"):
            parts = path.relative_to(self._packages).with_suffix("").parts
            module = ".".join(parts).removesuffix(".__init__")
            entries.append(f"{module}@{code_of(path).digest}")
        for module, path in self.own_files().items():
            entries.append(f"{module}@{code_of(path).digest}")
        return sorted(entries)

    def own_files(self) -> dict[str, Path]:
        """Files of modules outside the project: those with systems, and what they import there."""
        roots = _with_own_roots(((self._packages, ""),), self._own_modules)
        found = _reached(list(self._own_modules), roots)
        return {
            name: path
            for name, path in found.items()
            if not path.is_relative_to(self._packages)
            or (is_installed(self._packages) and name.partition(".")[0] not in _OURS)
        }


def fingerprint(script: Path, source_root: Path, extra_modules: Sequence[str] = ()) -> list[str]:
    """Fingerprints of a script and of the project's modules that it uses.

    Files are read once per process: what is edited while the workflow runs counts at its next run.

    Parameters
    ----------
    script
        The script's file. It may import the project's packages and its own neighbours.
    source_root
        Directory of the project's packages.
    extra_modules
        Modules that the script reaches otherwise than by importing them: the dynamical system,
        which is found by its name.

    Returns
    -------
    list of str
        Sorted entries ``module@hash``; the script's is ``name.py@hash``.

    Raises
    ------
    FileNotFoundError
        If the script or one of the extra modules does not exist.
    SyntaxError
        If one of the files is not Python.
    """
    return list(_fingerprint(Path(script), Path(source_root), tuple(extra_modules)))


def forget_files() -> None:
    """Forget all files that were read, so that edits are seen by this process."""
    _fingerprint.cache_clear()
    code_hash.forget_files()
    _located.cache_clear()


# a directory that modules are found in, and the one package of it that counts; "": all do
_Root = tuple[Path, str]


@cache
def _fingerprint(script: Path, source_root: Path, extra_modules: tuple[str, ...]) -> list[str]:
    roots = _with_own_roots(((source_root, ""), (script.parent, "")), extra_modules)
    for module in extra_modules:
        if _located(module, roots) is None:
            raise FileNotFoundError(f"there is no module {module} in {source_root}")
    digest, imports = code_of(script)
    waiting = [*(name for name, level in imports if level == 0), *extra_modules]
    entries = {name: code_of(path).digest for name, path in _reached(waiting, roots).items()}
    entries[script.name] = digest
    return sorted(f"{name}@{digest}" for name, digest in entries.items())


def _reached(waiting: list[str], roots: tuple[_Root, ...]) -> dict[str, Path]:
    """Files of modules, and of all that they reach through imports, by their names."""
    found: dict[str, Path] = {}
    while waiting:
        for name in _with_parents(waiting.pop()):
            module = _VERSION if f"{name}.".startswith(_HARNESS) else name
            if module in found or (path := _located(module, roots)) is None:
                continue
            found[module] = path
            package = module if path.name == "__init__.py" else module.rpartition(".")[0]
            imports = code_of(path).imports
            waiting += [_absolute(name, level, package) for name, level in imports]
    return found


def _with_own_roots(roots: tuple[_Root, ...], modules: Sequence[str]) -> tuple[_Root, ...]:
    """Add the directories of modules that lie elsewhere; of installed ones the package alone."""
    for module in modules:
        directory = top_level_directory(module) if _located(module, roots) is None else None
        if directory is not None:
            installed = directory.name in ("site-packages", "dist-packages")
            roots = (*roots, (directory, module.split(".")[0] if installed else ""))
    return tuple(dict.fromkeys(roots))


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
def _located(module: str, roots: tuple[_Root, ...]) -> Path | None:
    """File of a module of the project; None for other modules, and names that are no modules."""
    first, *_ = parts = module.split(".")
    for root, package in roots:
        if not package and is_installed(root) and first not in _OURS:
            continue  # other libraries: their versions count, not their code
        path = root.joinpath(*parts)
        for candidate in (path / "__init__.py", path.with_name(path.name + ".py")):
            if package in ("", first) and candidate.is_file():
                return candidate
    return None
