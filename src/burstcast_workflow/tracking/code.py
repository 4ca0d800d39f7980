"""Code that a job runs: its script, and what this uses of modules, each with a hash.

Of a module of the project count its definitions (functions, classes, constants) that the script
names, that these name in turn, and so on, and what the module does when it is imported. A user's
own modules count whole, and so do modules that a registry finds by name, for the jobs that are
about them. Hashes are of the code without comments, formatting and docstrings. What runs, logs,
caches and claims jobs is in no hash (`burstcast_workflow.project.UNTRACKED`).
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
from typing import Any, NamedTuple, TypeAlias

from burstcast_workflow.project import PACKAGES, UNTRACKED
from burstcast_workflow.tracking.environment import library_version

_MEMORY = Path(".snakemake") / "burstcast_code.json"
_LIBRARIES = {"site-packages", "dist-packages"}
_FILE, LIBRARY = "file:", "library:"
_DISTRIBUTIONS = {"PIL": "pillow", "skimage": "scikit-image", "sklearn": "scikit-learn"} | {
    "skopt": "scikit-optimize",
    "yaml": "PyYAML",
}
# what Snakemake puts before a script that it runs ends with this
_PREAMBLE = b"import snakemake"
_END_OF_PREAMBLE = b"######## snakemake preamble end #########"
# decorators that only make a function or class; others may have effects when a module is imported
_MAKING = {"cache", "contextmanager", "dataclass", "errstate", "lru_cache", "runtime_checkable"}
_IMPORTING = {"import_module", "__import__"}
# what reaches code that no reading of a source finds: functions of Python, and of its libraries
_HIDING_NAMES = {"__path__", "compile", "eval", "exec", "globals"}
_HIDING_CALLS = {"exec_module", "iter_modules", "run_module", "run_path", "walk_packages"} | {
    "spec_from_file_location"
}
ByName = Mapping[str, Iterable[str]]
"""Modules that the registry of a package finds by name, by the name of the package."""
Import: TypeAlias = tuple[str, str, str]
"""The name that an import binds, the module, with dots if it is relative, and the name in it."""

_ALL, _AT_IMPORT, _LATE, _LISTED = "*", "", "__getattr__", "__all__"


class Definition(NamedTuple):
    """A function, class or constant of a module, or (``""``) what runs when it is imported."""

    hash: str
    names: list[str]  #: names that it uses, with their attributes: ``durations.steps``
    imports: list[Import]  #: that stand in it


class Parsed(NamedTuple):
    """A source: the hash of all its code, its definitions, and calls that hide what they reach."""

    hash: str
    definitions: dict[str, Definition]
    hiding: list[str]

    @property
    def imports(self) -> Iterator[Import]:
        """All imports, wherever they stand."""
        for definition in self.definitions.values():
            yield from definition.imports


class Place(NamedTuple):
    """A module, or a script, with its file."""

    name: str
    path: Path


class Sources:
    """Scripts and packages of the project, and a user's own modules with the files they read.

    ``script``: File of a script, by its name. ``packages``: Directory of the project's packages.
    ``own_modules``: Files that each of a user's own modules reads, by the name of the module.
    ``with_libraries``: Whether the versions of libraries count, too.
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
        self._own_packages = {name.partition(".")[0] for name in self._own}
        self._memory: dict[str, Parsed | list[Any]] = {}  # parsed, or as they were stored
        with suppress(OSError, ValueError, KeyError, TypeError):
            memory = json.loads(_MEMORY.read_bytes())
            if memory["by"] == _parser():
                self._memory = dict(memory["parsed"])
        self._remembered = len(self._memory)
        self._parsed: dict[Path, Parsed] = {}
        self._places: dict[str, list[Place]] = {}
        self._reached: dict[tuple[str, str], list[tuple[Place, str]]] = {}
        self._reachable: dict[tuple[str, str], dict[str, dict[str, str]]] = {}
        self._closures: dict[object, dict[str, str]] = {}
        self._file = cache(self._find)

    def code(self, script: str, by_name: ByName) -> dict[str, str]:
        """Code of a job: hashes of its script, of each module, of each file that these read.

        Names are ``evaluation/horizon.py``, ``burstcast.forecasts.horizon``,
        ``file:module:its_data.csv``; and ``library:numpy``, whose value is a version.
        """
        key = script, *((package, *names) for package, names in by_name.items())
        if key not in self._closures:
            code = self._closure(script, by_name)
            libraries = self.libraries(code) if self._with_libraries else {}
            versions = {f"{LIBRARY}{name}": version for name, version in libraries.items()}
            self._closures[key] = dict(sorted(code.items())) | versions
        return self._closures[key]

    def _closure(self, script: str, by_name: ByName) -> dict[str, str]:
        """Hashes of what a script uses of itself, of modules and of files, by their names."""
        used = self.definitions(script, by_name)
        # a module of which nothing is used and that does nothing when it is imported is no code
        code = {
            name: _hash(repr([pair for pair in sorted(of.items()) if pair[1]]).encode())
            for name, of in used.items()
            if name == script or self._is_own(name) or any(of.values())
        }
        files = {
            f"{_FILE}{name}:{file}": _hash((path.parent / file).read_bytes())
            for name in used
            for file in self._own.get(name) or ()
            if (path := self._file(name))
        }
        return {**code, **files}

    def definitions(self, script: str, by_name: ByName) -> dict[str, dict[str, str]]:
        """Definitions that a script uses, with their hashes, by the names of their modules."""
        used: dict[str, dict[str, str]] = {}
        waiting, known = [(Place(script, self.script(script)), _ALL)], set[str]()
        while waiting:
            root = waiting.pop()
            for module, names in self._without_registries(*root).items():
                used[module] = {**used.get(module, {}), **names}
                if module not in known and names.keys() - {_AT_IMPORT}:
                    known.add(module)
                    waiting += self._of_registry(module, by_name)
        return used

    def _without_registries(self, place: Place, wanted: str) -> dict[str, dict[str, str]]:
        """Definitions that a name of a module reaches, but for what registries find by name.

        Many jobs share them.
        """
        key = place.name, wanted
        if key not in self._reachable:
            used: dict[str, dict[str, str]] = {}
            waiting = [(place, wanted)]
            while waiting:
                place, wanted = waiting.pop()
                definitions = self._parse(place.path).definitions
                if place.name not in used:
                    used[place.name] = {}
                    waiting.append((place, _AT_IMPORT))
                if wanted == _ALL or self._is_own(place.name):
                    names = [*definitions]
                else:
                    names = [wanted] if wanted in definitions else []
                for name in names:
                    if name not in used[place.name]:
                        used[place.name][name] = definitions[name].hash
                        waiting += self._reach(place, name)
            self._reachable[key] = used
        return self._reachable[key]

    def _is_own(self, name: str) -> bool:
        return not name.endswith(".py") and name.partition(".")[0] not in PACKAGES

    def _reach(self, place: Place, name: str) -> list[tuple[Place, str]]:
        """What a definition of a module uses: definitions of this module and of others."""
        key = place.name, name
        if key not in self._reached:
            parsed, reached = self._parse(place.path), dict[tuple[Place, str], None]()
            definition = parsed.definitions[name]
            bound = [*definition.imports]
            if name != _AT_IMPORT and _AT_IMPORT in parsed.definitions:
                bound += parsed.definitions[_AT_IMPORT].imports
            for used in definition.names:
                first, *attributes = used.split(".")
                if first in parsed.definitions and first != name:
                    reached[place, first] = None
                for alias, module, imported in bound:
                    if alias == first:
                        names = [*filter(None, [imported]), *attributes]
                        reached |= dict.fromkeys(self._use(_absolute(module, *place), names))
            for alias, module, imported in definition.imports:
                # importing a module runs it, and the packages that it lies in
                module, _ = self._split(_absolute(module, *place), [*filter(None, [imported])])
                reached |= dict.fromkeys((at, _AT_IMPORT) for at in self._located(module))
                if alias == _ALL:
                    reached |= dict.fromkeys(self._use_all(module))
            self._reached[key] = [*reached]
        return self._reached[key]

    def _split(self, module: str, names: list[str]) -> tuple[str, list[str]]:
        """The last module along some names, and the names in it: ``from package import module``."""
        while names and self._file(f"{module}.{names[0]}"):
            module, names = f"{module}.{names[0]}", names[1:]
        return module, names

    def _use(self, module: str, names: list[str]) -> Iterator[tuple[Place, str]]:
        """What a name of a module, with its attributes, stands for; nothing of libraries.

        A module by itself is all of it: its names may be looked up by texts.
        """
        module, names = self._split(module, names)
        places = self._located(module)
        if not places or places[-1].name != module:
            return
        place = places[-1]
        definitions = self._parse(place.path).definitions
        first = names[0] if names else _ALL
        if first in definitions:
            yield place, first
            return
        imports = definitions[_AT_IMPORT].imports if _AT_IMPORT in definitions else []
        if first != _ALL and (found := [each for each in imports if each[0] == first]):
            for _, other, imported in found:  # a name that the module itself has imported
                further = [*filter(None, [imported]), *names[1:]]
                yield from self._use(_absolute(other, *place), further)
        elif first != _ALL and _LATE in definitions:
            yield place, _LATE
        else:
            yield from self._use_all(module)

    def _use_all(self, module: str) -> Iterator[tuple[Place, str]]:
        """All of a module, and the modules that a package lists in ``__all__``."""
        for place in self._located(module)[-1:]:
            if place.name == module:
                yield place, _ALL
                listed = self._parse(place.path).definitions.get(_LISTED)
                for name in listed.names if listed else []:
                    if self._file(f"{module}.{name}"):
                        yield from self._use_all(f"{module}.{name}")

    def _of_registry(self, name: str, by_name: ByName) -> list[tuple[Place, str]]:
        package, _, module = name.rpartition(".")
        names = by_name.get(package, ()) if module == "registry" else ()
        modules = [
            chosen.partition(":")[0] if ":" in chosen else f"{package}.{chosen}" for chosen in names
        ]
        return [
            (place, _ALL if place.name == module else _AT_IMPORT)
            for module in modules
            for place in self._located(module)
        ]

    def _located(self, module: str) -> list[Place]:
        """A module with its file, after the packages that it lies in; nothing of libraries."""
        if module not in self._places:
            parts = module.split(".")
            names = [".".join(parts[:count]) for count in range(1, len(parts) + 1)]
            tracked = [name for name in names if not f"{name}.".startswith(UNTRACKED)]
            self._places[module] = [
                Place(name, path) for name in tracked if (path := self._file(name))
            ]
        return self._places[module]

    def _find(self, name: str) -> Path | None:
        first = name.partition(".")[0]
        if first in PACKAGES:
            return _in_directory(self.packages, name)
        if not self._own or first in sys.stdlib_module_names:
            return None
        is_own = first in self._own_packages  # a module of one's own may be installed
        places = (Path(place) for place in sys.path if place)
        files = (
            _in_directory(place, name)
            for place in places
            if is_own or not _LIBRARIES & {*place.parts}
        )
        found = next(filter(None, files), None)
        return found or (module_file(name) if is_own else None)

    def _parse(self, path: Path) -> Parsed:
        if path not in self._parsed:
            content = path.read_bytes()
            key = _hash(content, 64)
            found = self._memory.get(key)
            if found is not None and not isinstance(found, Parsed):
                with suppress(ValueError, LookupError, TypeError, AttributeError):  # damaged
                    found = _parsed_from(found)
            if not isinstance(found, Parsed):
                compiled = path.suffix != ".py"  # a library of C in a package of one's own
                found = Parsed(key[:12], {}, []) if compiled else parsed(content)
            self._parsed[path] = self._memory[key] = found
        return self._parsed[path]

    def _file_of(self, name: str) -> Path | None:
        return self.script(name) if name.endswith(".py") else self._file(name)

    def libraries(self, names: Iterable[str]) -> dict[str, str]:
        """Versions of the libraries that scripts and modules import, by the names of code."""
        paths = {name: self._file_of(name) for name in names if not _is_read(name)}
        imported = {
            module.partition(".")[0]
            for path in paths.values()
            if path is not None
            for _, module, _ in self._parse(path).imports
        }
        others = {
            name
            for name in imported - {"", *PACKAGES, *sys.stdlib_module_names}
            if self._file(name) is None
        }
        return {name: _version(name) for name in sorted(others)}

    def whole(self) -> dict[str, str]:
        """All code that jobs were asked for: hashes of scripts, modules and files as a whole."""
        code = {name: value for of_job in self._closures.values() for name, value in of_job.items()}
        paths = {name: self._file_of(name) for name in code if not _is_read(name)}
        whole = {name: self._parse(path).hash for name, path in paths.items() if path}
        files = {name: value for name, value in code.items() if name.startswith(_FILE)}
        return dict(sorted({**whole, **files}.items()))

    def hidden(self) -> dict[str, list[str]]:
        """Calls in a user's own modules that reach code which is not followed, by the module."""
        names = {name for code in self._closures.values() for name in code if not _is_read(name)}
        return {
            name: calls
            for name in sorted(filter(self._is_own, names))
            if (path := self._file(name)) and (calls := self._parse(path).hiding)
        }

    def keep(self) -> None:
        """Remember hashes for the processes of jobs, and for the next run."""
        if len(self._memory) > self._remembered:
            _MEMORY.parent.mkdir(exist_ok=True)
            partial = _MEMORY.with_suffix(f".{os.getpid()}")
            partial.write_text(json.dumps({"by": _parser(), "parsed": self._memory}))
            os.replace(partial, _MEMORY)

    def drop_stale_bytecode(self) -> None:
        """Remove bytecode that is older than its source, whatever date the source pretends to have.

        Python compares sizes and dates of modification, which an editor, or an archive that is
        unpacked, may keep.
        """
        for path in self._parsed:
            bytecode = Path(importlib.util.cache_from_source(str(path)))
            with suppress(OSError):
                if path.stat().st_ctime_ns > bytecode.stat().st_mtime_ns:
                    bytecode.unlink()

    def changed(self, whole: Mapping[str, str]) -> list[str]:
        """Names of the scripts, modules and files that have other hashes as a whole (`whole`)."""
        changed = []
        for name, value in whole.items():
            if name.startswith(_FILE):
                module, _, file = name.removeprefix(_FILE).partition(":")
                place = self._file(module)
                path = place.parent / file if place else None
                now = _hash(path.read_bytes()) if path and path.is_file() else None
            else:
                path = self._file_of(name)
                now = self._parse(path).hash if path and path.is_file() else None
            changed += [name] if now != value else []
        return changed


def of_files(code: Mapping[str, str]) -> dict[str, str]:
    """Hashes of scripts, modules and files, without versions of libraries."""
    return {name: value for name, value in code.items() if not name.startswith(LIBRARY)}


def _is_read(name: str) -> bool:
    """Whether a name of code is a file's that a module reads, or a library's."""
    return name.startswith((_FILE, LIBRARY))


# -- reading a source ------------------------------------------------------------------------------


def parsed(content: bytes) -> Parsed:
    """Hash of the code in a source, its definitions, and calls that hide what they reach."""
    if content.startswith(_PREAMBLE):
        content = content.rpartition(_END_OF_PREAMBLE)[2]
    tree = ast.parse(content)
    for node in ast.walk(tree):
        documented = ast.Module | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef
        if isinstance(node, documented) and ast.get_docstring(node, clean=False) is not None:
            node.body = node.body[1:]
    statements: dict[str, list[ast.stmt]] = {}
    for statement in tree.body:
        for name in _defined(statement):
            statements.setdefault(name, []).append(statement)
    at_import = map(_read, statements.get(_AT_IMPORT, []))
    bound = [binding for read in at_import for binding in read.imports]
    definitions = {name: _definition(of_name, bound, name) for name, of_name in statements.items()}
    return Parsed(_hash(_text(tree.body)), definitions, [*_hiding(tree)])


class _Read(NamedTuple):
    names: list[str]
    imports: list[Import]


def _definition(statements: list[ast.stmt], bound: list[Import], name: str) -> Definition:
    """Definition of a name by its statements, in a module that binds names by imports."""
    read = [*map(_read, statements)]
    names = sorted({used for each in read for used in each.names})
    if name == _LISTED:
        names = [*_texts(statements)]
    imports = [*dict.fromkeys(binding for each in read for binding in each.imports)]
    if name == _AT_IMPORT:
        # that a module is imported is no code; what its statements do is
        statements = [
            each for each in statements if not isinstance(each, ast.Import | ast.ImportFrom)
        ]
    # which library's function a name stands for is no part of the text
    firsts = {used.partition(".")[0] for used in names}
    meant = sorted({binding for binding in [*bound, *imports] if binding[0] in firsts})
    text = _text(statements)
    return Definition(_hash(text + repr(meant).encode()) if text else "", names, imports)


def _text(statements: Iterable[ast.stmt]) -> bytes:
    return "\n".join(map(ast.unparse, statements)).encode("utf-8", "surrogatepass")


def _texts(statements: Iterable[ast.stmt]) -> Iterator[str]:
    """Texts that stand in statements."""
    for statement in statements:
        for node in ast.walk(statement):
            if isinstance(node, ast.Constant) and isinstance(node.value, str):
                yield node.value


def _defined(statement: ast.stmt) -> list[str]:
    """Names that a statement of a module defines; ``""`` if it does anything else."""
    match statement:
        case ast.Expr(value=ast.Constant()) | ast.Pass():
            return []
        case (
            ast.FunctionDef(name=name, decorator_list=decorators)
            | ast.AsyncFunctionDef(name=name, decorator_list=decorators)
            | ast.ClassDef(name=name, decorator_list=decorators)
        ):
            return [name] if all(map(_only_makes, decorators)) else [name, _AT_IMPORT]
        case ast.Assign(targets=targets):
            names = [name for target in targets for name in _assigned(target)]
        case ast.AnnAssign(target=target):
            names = [*_assigned(target)]
        case _:
            names = [_AT_IMPORT]
    return [*dict.fromkeys(names)]


def _assigned(target: ast.expr) -> Iterator[str]:
    """Names that an assignment binds; ``""`` for parts of other objects."""
    match target:
        case ast.Name(id=name):
            yield name
        case ast.Tuple(elts=elements) | ast.List(elts=elements):
            for element in elements:
                yield from _assigned(element)
        case ast.Starred(value=value):
            yield from _assigned(value)
        case _:
            yield _AT_IMPORT


def _only_makes(decorator: ast.expr) -> bool:
    call = decorator.func if isinstance(decorator, ast.Call) else decorator
    name = call.attr if isinstance(call, ast.Attribute) else getattr(call, "id", "")
    return name in _MAKING


def _read(statement: ast.stmt) -> _Read:
    """Names that a statement uses, and its imports."""
    names: dict[str, None] = {}
    imports: list[Import] = []
    waiting: list[ast.AST] = [statement]
    while waiting:
        node = waiting.pop()
        match node:
            case ast.Import(names=aliases):
                for alias in aliases:
                    first = alias.name.partition(".")[0]
                    imports.append(
                        (alias.asname or first, alias.name if alias.asname else first, "")
                    )
                    if not alias.asname and alias.name != first:
                        imports.append(("", alias.name, ""))  # it is loaded, too
            case ast.ImportFrom(module=module, names=aliases, level=level):
                source = "." * level + (module or "")
                imports += [
                    (_ALL, source, "")
                    if alias.name == "*"
                    else (alias.asname or alias.name, source, alias.name)
                    for alias in aliases
                ]
            case ast.Name(id=name):
                names[name] = None
            case ast.Attribute():
                chain = _chain(node)
                if chain:
                    names[".".join(chain)] = None
                else:
                    waiting.append(node.value)
            case ast.If(
                test=ast.Name(id="TYPE_CHECKING") | ast.Attribute(attr="TYPE_CHECKING"),
                orelse=others,
            ):
                waiting += others
            case ast.Call(args=[ast.Constant(value=str(module)), *_]) if (
                _called(node) in _IMPORTING
            ):
                imports += [("", module, ""), (_ALL, module, "")]
                waiting += ast.iter_child_nodes(node)
            case _:
                waiting += ast.iter_child_nodes(node)
    return _Read([*names], imports)


def _chain(node: ast.expr) -> list[str]:
    """Names of ``a.b.c``; nothing if it does not begin with a name."""
    attributes: list[str] = []
    while isinstance(node, ast.Attribute):
        attributes, node = [node.attr, *attributes], node.value
    return [node.id, *attributes] if isinstance(node, ast.Name) else []


def _called(call: ast.Call) -> str:
    """Last name of a called function."""
    function = call.func
    return function.attr if isinstance(function, ast.Attribute) else getattr(function, "id", "")


def _hiding(tree: ast.Module) -> Iterator[str]:
    """What reaches code that no reading of the source finds, with its line, as it stands there."""
    for node in ast.walk(tree):
        match node:
            case ast.Call(func=ast.Name(id=name)) if name in _HIDING_NAMES:
                hides = True
            case ast.Call():
                literal = bool(node.args) and isinstance(node.args[0], ast.Constant)
                name = _called(node)
                hides = name in _HIDING_CALLS or (name in _IMPORTING and not literal)
            case ast.Name(id=name):
                hides = name == "__path__"
            case _:
                continue
        if hides:
            yield f"line {node.lineno}: {ast.unparse(node)}"


def _parsed_from(record: Sequence[Any]) -> Parsed:
    """A parsed source from its record in JSON."""
    content, definitions, hiding = record
    return Parsed(
        content,
        {
            name: Definition(value, names, [(alias, module, of) for alias, module, of in imports])
            for name, (value, names, imports) in definitions.items()
        },
        hiding,
    )


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
    except Exception:  # whatever the code of the package raises, which is imported for that
        return None
    return Path(spec.origin).absolute() if spec and spec.has_location and spec.origin else None
