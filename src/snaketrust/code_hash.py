"""Hash of the code of a source file, and its imports; remembered by its content.

The hash covers the syntax tree without positions and comments. The tree is walked here rather
than by `ast.dump`, whose output differs between Python versions.

Of the project's own code, words count nothing either: docstrings, texts of built-in errors, and
what goes to a module's logger, as long as these only name values; and what a module offers besides
its own names (``__getattr__``, ``__dir__``). Code that reads any of this should be kept out of the
project by a test. Of modules of a user's own everything counts (`strict`).
"""

import ast
import builtins
import hashlib
import json
import re
import sys
from collections import Counter
from collections.abc import Iterable, Iterator
from contextlib import suppress
from pathlib import Path
from typing import NamedTuple

from snaketrust.files import replaced

HASH_LENGTH = 12


class Code(NamedTuple):
    """Code hash and imports of a source."""

    digest: str  # hash of what it does
    imports: list[tuple[str, int]]  # names, at its top or in a function, with their leading dots
    reads: list[str]  # calls that probably read a file, or run what imports do not show
    unseen: list[str] = []  # noqa: RUF012 - places of what no fingerprint sees


class Codes:
    """Code hashes of sources. Each file is read once: edits are seen by another instance.

    Parsing takes a tenth of the time of planning, so what is found out is kept, by the hashes of
    the sources' bytes: what is kept cannot be out of date. The file, ``memory``, need not exist.
    """

    def __init__(self, memory: Path | None = None) -> None:
        self._memory = memory
        self._seen: dict[tuple[Path, bool], tuple[str, Code]] = {}
        # by content, and whether words count
        self._known: dict[str, Code] = {}
        if memory is not None:
            with suppress(OSError, ValueError, KeyError, TypeError):
                found = json.loads(memory.read_bytes())
                if found["found_out_by"] == _tools():
                    for key, (code, imports, *places) in found["sources"].items():
                        self._known[key] = Code(code, [tuple(one) for one in imports], *places)
        self._remembered = {*self._known}

    def of(self, path: Path, *, strict: bool = False) -> Code:
        """Hash of what a source does; of a compiled module, of its bytes. Words count if `strict`.

        `FileNotFoundError` or `SyntaxError` if there is no such file, or it is not Python.
        """
        if (path, strict) not in self._seen:
            source = path.read_bytes()
            content = hashlib.sha256(source).hexdigest()
            key = _key(content, strict)
            if path.suffix != ".py":
                self._known[key] = Code(content[:HASH_LENGTH], [], [])
            elif key not in self._known:
                self._known[key] = parsed(source, str(path), strict=strict)
            self._seen[path, strict] = content, self._known[key]
        return self._seen[path, strict][1]

    def content(self, path: Path, *, strict: bool = False) -> str:
        """SHA-256 of a source when it was read (`of`)."""
        self.of(path, strict=strict)
        return self._seen[path, strict][0]

    def keep(self) -> None:
        """Keep what has been found out for later processes, where there is room for it."""
        keys = {_key(content, strict) for (_, strict), (content, _) in self._seen.items()}
        if self._memory is not None and not keys <= self._remembered:
            sources = {key: self._known[key] for key in sorted(keys)}
            found = {"found_out_by": _tools(), "sources": sources}
            with suppress(OSError), replaced(self._memory) as partial:
                partial.write_text(json.dumps(found))


def _key(content: str, strict: bool) -> str:
    return f"strict {content}" if strict else content


def _tools() -> str:
    """Hash of this module and of Python's version, whose syntax trees it goes through."""
    return hashlib.sha256(Path(__file__).read_bytes() + sys.version.encode()).hexdigest()


def parsed(source: bytes, path: str, *, strict: bool = False) -> Code:
    """Code hash and imports of a source (`Codes.of`)."""
    tree = ast.parse(source, path)
    if not strict:
        late = "__getattr__", "__dir__"
        tree.body = [node for node in tree.body if getattr(node, "name", "") not in late]
    nodes = [*ast.walk(tree)]
    if not strict:
        _leave_out_words(tree, nodes)
    text = "\x1f".join(_serialised(tree)).encode("utf-8", "surrogatepass")
    digest = hashlib.sha256(text).hexdigest()[:HASH_LENGTH]
    if not strict:
        return Code(digest, [*_imports(nodes)], [])
    return Code(digest, [*_imports(nodes)], [*_reads(nodes)], [*_unseen(nodes)])


def _imports(nodes: Iterable[ast.AST]) -> Iterator[tuple[str, int]]:
    """Imports of a module, at its top or in a function."""
    for node in nodes:
        if isinstance(node, ast.Import):
            for alias in node.names:
                yield alias.name, 0
        elif isinstance(node, ast.ImportFrom):
            base = node.module or ""
            yield base, node.level
            for alias in node.names:
                # a module, or a name in one: only the former is found as a file
                yield f"{base}.{alias.name}" if base else alias.name, node.level
        elif (name := _import_by_call(node)) and not name.startswith("."):
            yield name, 0


_READS = re.compile(
    r"\b(open|load|loadtxt|genfromtxt|fromfile|memmap|loadmat|safe_load|Dataset|File|files|get_data"
    r"|(open|load)_(mf)?dataset|read_\w+|import_module|__import__|exec|eval)\(\)$|^sys\.path$"
)


def _reads(nodes: Iterable[ast.AST]) -> Iterator[str]:
    """Calls of what is named like a function that reads, and changes of where modules are found."""
    for node in nodes:
        if isinstance(node, ast.Call | ast.Attribute):
            called = getattr(node, "func", None)
            text = f"{ast.unparse(called)}()" if called else ast.unparse(node)
            if _READS.search(text):
                yield f"line {node.lineno}: {text}"


def _import_by_call(node: ast.AST) -> str | None:
    """Name of a module that a call imports; empty if it is computed, None for other calls."""
    if isinstance(node, ast.Call) and node.args:
        called = ast.unparse(node.func).rpartition(".")[2]
        if called in ("import_module", "__import__"):
            return _literal(node.args[0])
    return None


def _literal(node: ast.expr) -> str:
    value = getattr(node, "value", None)
    return value if isinstance(value, str) else ""


_UNSEEN = re.compile(
    r"^((exec|eval|compile|__file__|__path__|sys\.path)$|(runpy|pkgutil|importlib\.resources)\b"
    r"|snakemake\.config\b|getattr\(snakemake\b|(os\.)?getenv\(|(os\.)?environ\.get\()"
)
_PROGRAMS = re.compile(
    r"^(subprocess\.\w+|os\.(system|popen)|run|Popen|call|check_\w+)\("
    r".*(sys\.executable|['\"/ ]python|\.py\b)"
)
_WRITES = re.compile(r"[wax][bt+]{0,2}$")


def _unseen(nodes: Iterable[ast.AST]) -> Iterator[str]:
    """Places that run code, or read data, that neither imports nor inputs show."""
    for node in nodes:
        if isinstance(node, ast.Name | ast.Attribute | ast.Call):
            text = ast.unparse(node)
            found = _UNSEEN.match(text)
        elif isinstance(node, ast.ImportFrom):
            text, found = node.module or "", _UNSEEN.match(f"{node.module}")
        elif isinstance(node, ast.Subscript) and isinstance(node.ctx, ast.Load):
            text = ast.unparse(node)
            found = re.match(r"(os\.)?environ\[", text)
        else:
            continue
        if isinstance(node, ast.Call) and not found:
            computed = _import_by_call(node) == ""
            if not (computed or _PROGRAMS.match(text) or _reads_by_name(node, text)):
                continue
        elif not found:
            continue
        yield f"line {getattr(node, 'lineno', 0)}: {text}"


def _reads_by_name(node: ast.Call, text: str) -> bool:
    """Whether a call reads a file whose name it holds."""
    function = ast.unparse(node.func)
    modes = node.args[isinstance(node.func, ast.Name) :]
    if "snakemake" in text or not _READS.search(f"{function}()") or _import_by_call(node):
        return False
    if any(_WRITES.match(_literal(one)) for one in [*modes, *(one.value for one in node.keywords)]):
        return False
    calls = [node, *(one for one in ast.walk(node.func) if isinstance(one, ast.Call))]
    return any(_literal(one.args[0]) for one in calls if one.args)


# fields that say nothing about what the code does, or that repeat its position
_IGNORED_FIELDS = frozenset({"ctx", "kind", "type_comment", "type_ignores"})


def _serialised(tree: ast.Module) -> list[str]:
    """A tree in a form that depends only on what the code does, not on the version of Python.

    Fields that are empty are left out: later versions have fields that earlier ones have not.
    """
    parts: list[str] = []
    waiting: list[ast.AST | str] = [tree]
    while waiting:  # a long sum is a deep tree, too deep to recurse
        node = waiting.pop()
        if isinstance(node, str):
            parts.append(node)
            continue
        kind = type(node)
        parts.append(kind.__name__)
        if isinstance(node, ast.Constant):
            parts.append(f"{type(node.value).__name__} {node.value!r}")
            continue
        below: list[ast.AST | str] = []
        for field in kind._fields:
            value = getattr(node, field, None)
            if value is None or value == [] or field in _IGNORED_FIELDS:
                continue
            if isinstance(value, list):
                # names, and None for what is absent in a row
                items = [item if isinstance(item, ast.AST) else repr(item) for item in value]
                below += [field, "[", *(item for item in items if not _empty_text(item, kind)), "]"]
            else:
                below += [field, value if isinstance(value, ast.AST) else repr(value)]
        waiting += reversed([*below, ")"])
    return parts


def _empty_text(item: ast.AST | str, parent: type[ast.AST]) -> bool:
    """Whether it is empty text in an f-string, which only some Python versions put there."""
    return parent is ast.JoinedStr and isinstance(item, ast.Constant) and item.value == ""


# -- words -----------------------------------------------------------------------------------------

_LOGGER_LINES = ["import logging", "logger = logging.getLogger(__name__)"]
_LOGS = {f"logger.{level}" for level in ("debug", "info", "warning", "error", "critical")}
_ERRORS = {
    name
    for name, value in vars(builtins).items()
    if isinstance(value, type) and issubclass(value, BaseException)
}
# what a text may consist of: nothing that changes anything, or draws from an iterator
_NAMING = (ast.Constant, ast.JoinedStr, ast.FormattedValue, ast.Name, ast.Attribute, ast.Load)
_SUMS = (ast.Tuple, ast.BinOp, ast.Add, ast.Sub)


def _leave_out_words(tree: ast.Module, nodes: Iterable[ast.AST]) -> None:
    """Remove from a module of the project what only people read, and what has no effect."""
    bound = _mentioned(nodes)
    lines = [
        ast.unparse(node) if isinstance(node, ast.Import | ast.Assign) else "" for node in tree.body
    ]
    logs = {*_LOGGER_LINES} <= {*lines} and bound["logger"] == bound["logging"] == 1
    if logs:
        pairs = zip(tree.body, lines, strict=True)
        tree.body = [node for node, line in pairs if line not in _LOGGER_LINES]
    for node in nodes:
        for name in ("body", "orelse", "finalbody"):
            if isinstance(block := getattr(node, name, None), list):
                block[:] = [one for one in block if not _without_effect(one, bound, logs)]
        error = node.exc if isinstance(node, ast.Raise) else None
        if isinstance(error, ast.Call) and _name_of(error.func) in _ERRORS - bound.keys():
            error.args = [
                one for one in error.args if not (_is_text(one) and _only_names(one, bound))
            ]


def _mentioned(nodes: Iterable[ast.AST]) -> Counter[str]:
    """Count names that are not only read: all that could be bound anew, and more."""
    return Counter(
        value
        for node in nodes
        if not isinstance(node, ast.Name) or not isinstance(node.ctx, ast.Load)
        for found in vars(node).values()
        for value in (found if isinstance(found, list) else [found])
        if isinstance(value, str)
    )


def _without_effect(node: ast.AST, bound: Counter[str], logs: bool) -> bool:
    """Whether a statement does nothing, or a message to the log nothing else."""
    value = node.value if isinstance(node, ast.Expr) else None
    if isinstance(value, ast.Call):
        says = logs and ast.unparse(value.func) in _LOGS and not value.keywords
        return says and all(_only_names(one, bound) for one in value.args)
    return isinstance(node, ast.Pass) or isinstance(value, ast.Constant)


def _is_text(node: ast.expr) -> bool:
    return isinstance(node, ast.JoinedStr) or isinstance(getattr(node, "value", None), str)


def _only_names(node: ast.expr, bound: Counter[str]) -> bool:
    """Whether an expression has only texts, values, their lengths, shapes and types, and sums."""
    known = {"len", "type"} - bound.keys()
    return all(
        isinstance(one, _NAMING + _SUMS)
        or (isinstance(one, ast.Subscript) and getattr(one.value, "attr", "") == "shape")
        or (isinstance(one, ast.Call) and _name_of(one.func) in known and len(one.args) == 1)
        for one in ast.walk(node)
    )


def _name_of(node: ast.expr) -> str:
    return node.id if isinstance(node, ast.Name) else ""
