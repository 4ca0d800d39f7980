"""Code that fingerprints cannot follow, and settings that no parameter carries."""

import ast
from collections.abc import Callable
from pathlib import Path

_FORBIDDEN_MODULES = frozenset({"importlib", "imp", "pkgutil", "runpy", "zipimport"})
_FORBIDDEN_NAMES = frozenset({"__import__", "compile", "eval", "exec"})


def forbidden_imports(path: Path) -> list[str]:
    """Places of a file that run code which fingerprints do not see, as ``line 3: ...``.

    These are imports by computed names, code made from text, and ``import *``, after which it is
    unclear where a name comes from. ``from importlib.metadata import ...`` only reads versions and
    is allowed.
    """
    return _places(path, _forbidden_import)


def forbidden_reads(path: Path) -> list[str]:
    """Places of a script that read something of Snakemake which no parameter carries.

    A script hands the object ``snakemake`` to `burstcast_workflow.harness.job.run_job`, and does
    nothing else with it: its config would be settings that nothing tracks.
    """
    return _places(path, _forbidden_read)


def _places(path: Path, find: Callable[[ast.AST], str]) -> list[str]:
    tree = ast.parse(path.read_bytes(), str(path))
    return [
        f"line {getattr(node, 'lineno', 0)}: {what}"
        for node in ast.walk(tree)
        if (what := find(node))
    ]


def _forbidden_import(node: ast.AST) -> str:
    if isinstance(node, ast.Import):
        names = [alias.name for alias in node.names]
    elif isinstance(node, ast.ImportFrom):
        if any(alias.name == "*" for alias in node.names):
            return f"from {'.' * node.level}{node.module or ''} import *"
        names = [] if node.module == "importlib.metadata" else [node.module or ""]
    else:
        return node.id if isinstance(node, ast.Name) and node.id in _FORBIDDEN_NAMES else ""
    forbidden = [name for name in names if name.split(".")[0] in _FORBIDDEN_MODULES]
    return f"import {forbidden[0]}" if forbidden else ""


def _forbidden_read(node: ast.AST) -> str:
    if isinstance(node, ast.Attribute | ast.Subscript) and _is_snakemake(node.value):
        return f"snakemake.{node.attr}" if isinstance(node, ast.Attribute) else "snakemake[...]"
    if isinstance(node, ast.Assign | ast.AnnAssign | ast.NamedExpr) and _is_snakemake(node.value):
        return "snakemake under another name"
    if isinstance(node, ast.Call):
        called = node.func.id if isinstance(node.func, ast.Name) else ""
        if called != "run_job" and any(_is_snakemake(argument) for argument in node.args):
            return f"snakemake handed to {called or 'something'} instead of run_job"
    return ""


def _is_snakemake(node: ast.AST | None) -> bool:
    return isinstance(node, ast.Name) and node.id == "snakemake"
