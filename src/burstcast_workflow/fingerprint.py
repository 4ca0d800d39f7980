"""Fingerprints of code: what a script runs, insensitive to how it is written down.

Snakemake does not notice that a module which a script imports has changed. Each rule therefore
carries the fingerprints of its script and of all modules of the project that the script reaches
through imports, as a parameter, and Snakemake compares them as it does any other parameter.

A fingerprint is a hash of the syntax tree without positions, comments, docstrings, the texts of
errors and of the log, and what people alone ask for: a class's ``__repr__``, and what a module
offers besides its own names (``__getattr__``, ``__dir__``). None of that changes a result. The tree
is walked here rather than by `ast.dump`, whose output differs between Python versions. What imports
do not show must not happen, and a test keeps it out. Two things are known otherwise:

* Modules that a registry finds by name (systems, forecasters, validation strategies). A script that
  reaches a registry depends on those of its modules that its job is about, and on no others. A
  system of one's own lies elsewhere: what its module imports of the same directory, or of the same
  installed package, counts, too.
* The harness, which runs scripts, logs, caches and writes files. It is in no fingerprint; instead,
  the one number of `burstcast_workflow.harness.version` is, raised when it changes a result.
"""

import ast
import hashlib
from collections.abc import Iterator, Mapping, Sequence
from functools import cache
from pathlib import Path

from burstcast.discovery import top_level_directory
from burstcast_workflow.project import is_installed, packages_of

_HASH_LENGTH = 12
_HARNESS = "burstcast_workflow.harness"
_VERSION = f"{_HARNESS}.version"
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
        entries = [f"{path.name}@{_parsed(path)[0]}" for path in self._scripts.rglob("*.py")]
        for path in self._packages.glob("burstcast*/**/*.py"):
            parts = path.relative_to(self._packages).with_suffix("").parts
            module = ".".join(parts).removesuffix(".__init__")
            entries.append(f"{module}@{_parsed(path)[0]}")
        for module, path in self.own_files().items():
            entries.append(f"{module}@{_parsed(path)[0]}")
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
    _parsed.cache_clear()
    _located.cache_clear()


# a directory that modules are found in, and the one package of it that counts; "": all do
_Root = tuple[Path, str]


@cache
def _fingerprint(script: Path, source_root: Path, extra_modules: tuple[str, ...]) -> list[str]:
    roots = _with_own_roots(((source_root, ""), (script.parent, "")), extra_modules)
    for module in extra_modules:
        if _located(module, roots) is None:
            raise FileNotFoundError(f"there is no module {module} in {source_root}")
    digest, imports = _parsed(script)
    waiting = [*(name for name, level in imports if level == 0), *extra_modules]
    entries = {name: _parsed(path)[0] for name, path in _reached(waiting, roots).items()}
    entries[script.name] = digest
    return sorted(f"{name}@{digest}" for name, digest in entries.items())


def _reached(waiting: list[str], roots: tuple[_Root, ...]) -> dict[str, Path]:
    """Files of modules, and of all that they reach through imports, by their names."""
    found: dict[str, Path] = {}
    while waiting:
        for name in _with_parents(waiting.pop()):
            module = _VERSION if f"{name}.".startswith(f"{_HARNESS}.") else name
            if module in found or (path := _located(module, roots)) is None:
                continue
            found[module] = path
            package = module if path.name == "__init__.py" else module.rpartition(".")[0]
            imports = _parsed(path)[1]
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


@cache
def _parsed(path: Path) -> tuple[str, list[tuple[str, int]]]:
    """Hash of a file's code, and its imports: names with their numbers of leading dots."""
    return _parsed_source(path.read_bytes(), str(path))


# a job looks at its files twice, and they are hardly ever others the second time
@cache
def _parsed_source(source: bytes, path: str) -> tuple[str, list[tuple[str, int]]]:
    tree = ast.parse(source, path)
    parts: list[str] = []
    _serialise(tree, parts)
    digest = hashlib.sha256("\x1f".join(parts).encode("utf-8", "surrogatepass")).hexdigest()
    return digest[:_HASH_LENGTH], list(_imports(tree))


def _imports(tree: ast.Module) -> Iterator[tuple[str, int]]:
    """Imports of a module, at its top or in a function."""
    own = [node for node in tree.body if not _for_people(node, ast.Module)]
    for node in (inner for outer in own for inner in ast.walk(outer)):
        if isinstance(node, ast.Import):
            for alias in node.names:
                yield alias.name, 0
        elif isinstance(node, ast.ImportFrom):
            base = node.module or ""
            yield base, node.level
            for alias in node.names:
                # a module, or a name in one: only the former is found as a file
                yield f"{base}.{alias.name}" if base else alias.name, node.level


# fields that say nothing about what the code does, or that repeat its position
_IGNORED_FIELDS = frozenset({"ctx", "kind", "type_comment", "type_ignores"})
# functions that only people call, by what they are defined in
_FOR_PEOPLE: dict[type[ast.AST], tuple[str, ...]] = {
    ast.Module: ("__getattr__", "__dir__"),
    ast.ClassDef: ("__repr__",),
}


def _serialise(node: ast.AST, parts: list[str]) -> None:
    """Append the tree below a node in a form that depends only on what the code does.

    Fields that are empty are left out, since later Python versions have fields that earlier ones
    have not; statements without effect (docstrings, other bare constants, pass) likewise.
    """
    kind = type(node)
    parts.append(kind.__name__)
    if isinstance(node, ast.Raise) and isinstance(node.exc, ast.Call):
        # which error it is, but not its text
        _serialise(node.exc.func, parts)
        return
    if kind is ast.Constant:
        parts.append(_constant(node.value))  # type: ignore[attr-defined]
        return
    for field in kind._fields:
        value = getattr(node, field, None)
        if value is None or value == [] or field in _IGNORED_FIELDS:
            continue
        if isinstance(value, list):
            value = [item for item in value if not _left_out(item, kind)]
            if kind is ast.Module and not value:
                continue  # a module that does nothing, whatever it says of itself
            parts += [field, "["]
            for item in value:
                if isinstance(item, ast.AST):
                    _serialise(item, parts)
                else:
                    parts.append(repr(item))  # names, and None for what is absent in a row
            parts.append("]")
        elif isinstance(value, ast.AST):
            parts.append(field)
            _serialise(value, parts)
        else:
            parts += [field, repr(value)]
    parts.append(")")


def _constant(value: object) -> str:
    return f"{type(value).__name__} {value!r}"


def _empty_text(node: ast.AST, parent: type[ast.AST]) -> bool:
    """Whether it is empty text in an f-string, which only some Python versions put there."""
    return parent is ast.JoinedStr and isinstance(node, ast.Constant) and node.value == ""


def _left_out(item: object, parent: type[ast.AST]) -> bool:
    return isinstance(item, ast.AST) and (
        _without_effect(item) or _empty_text(item, parent) or _for_people(item, parent)
    )


def _for_people(node: ast.AST, parent: type[ast.AST]) -> bool:
    """Whether it is a function that no job calls."""
    return isinstance(node, ast.FunctionDef) and node.name in _FOR_PEOPLE.get(parent, ())


def _without_effect(node: ast.AST) -> bool:
    kind = type(node)
    if kind is ast.Expr:
        value = node.value  # type: ignore[attr-defined]
        return type(value) is ast.Constant or _says_something(value)
    return kind is ast.Pass or _makes_logger(node)


def _says_something(node: ast.AST) -> bool:
    """Whether it is a call of ``logger.info`` and the like."""
    called = node.func if isinstance(node, ast.Call) else None
    return (
        isinstance(called, ast.Attribute)
        and isinstance(called.value, ast.Name)
        and called.value.id == "logger"
    )


def _makes_logger(node: ast.AST) -> bool:
    """Whether it is one of the lines that a module's first message brings along."""
    return isinstance(node, ast.Import | ast.Assign) and ast.unparse(node) in (
        "import logging",
        "logger = logging.getLogger(__name__)",
    )
