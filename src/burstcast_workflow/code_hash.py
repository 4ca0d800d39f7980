"""What a source file does: the hash of its code, and its imports. Remembered by its content.

The hash is that of the syntax tree without positions, comments, docstrings, the texts of errors and
of the log, and what people alone ask for: a class's ``__repr__``, and what a module offers besides
its own names (``__getattr__``, ``__dir__``). None of that changes a result. The tree is walked here
rather than by `ast.dump`, whose output differs between Python versions.

Parsing was a fifth of what a job takes to start. What a run has found out it therefore keeps with
its results, and its jobs and later plans look there first. The keys are hashes of the sources'
bytes: what is kept cannot be out of date, and where it is missing, sources are parsed.
"""

import ast
import hashlib
import json
import sys
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import NamedTuple

from burstcast_workflow.harness.storage import atomic

_HASH_LENGTH = 12


class Code(NamedTuple):
    """What a source does.

    Attributes
    ----------
    digest
        Hash of what it does.
    imports
        Names of what it imports, at its top or in a function, with their numbers of leading dots.
    """

    digest: str
    imports: list[tuple[str, int]]


MEMORY = ".code.json"
"""File of a results directory in which is kept what sources do."""

# by the hashes of the sources' bytes; and those of the files that were looked at
_known: dict[str, Code] = {}
_seen: dict[Path, str] = {}


def code_of(path: Path) -> Code:
    """Tell what a source does; it is read once, until `forget_files`.

    Raises
    ------
    FileNotFoundError
        If there is no such file.
    SyntaxError
        If it is not Python.
    """
    if path not in _seen:
        source = path.read_bytes()
        key = hashlib.sha256(source).hexdigest()
        if key not in _known:
            _known[key] = _parsed(source, str(path))
        _seen[path] = key
    return _known[_seen[path]]


def forget_files() -> None:
    """Forget which file has which source, so that edits are seen by this process."""
    _seen.clear()


def recall(results: str) -> None:
    """Take over what a run found out; nothing, where there was none or it had other tools."""
    with suppress(OSError, ValueError, KeyError, TypeError):
        found = json.loads((Path(results) / MEMORY).read_bytes())
        if found["found_out_by"] == _tools():
            for key, (digest, imports) in found["sources"].items():
                _known[key] = Code(digest, [(name, level) for name, level in imports])


def keep(results: str) -> None:
    """Write down what the files that this process has looked at do, if there is room for it.

    Raises
    ------
    OvertakenError
        If a newer run has the results now.
    """
    sources = {key: _known[key] for key in sorted({*_seen.values()})}
    with suppress(OSError), atomic(Path(results) / MEMORY) as partial:
        partial.write_text(json.dumps({"found_out_by": _tools(), "sources": sources}))


def _tools() -> str:
    """Hash of this module and of Python's version, whose syntax trees it goes through."""
    return hashlib.sha256(Path(__file__).read_bytes() + sys.version.encode()).hexdigest()


def _parsed(source: bytes, path: str) -> Code:
    tree = ast.parse(source, path)
    parts: list[str] = []
    _serialise(tree, parts)
    digest = hashlib.sha256("\x1f".join(parts).encode("utf-8", "surrogatepass")).hexdigest()
    return Code(digest[:_HASH_LENGTH], list(_imports(tree)))


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
