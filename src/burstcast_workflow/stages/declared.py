"""Finds the settings of a script in its source: importing the script would take seconds."""

import ast
from collections.abc import Iterator
from functools import cache
from pathlib import Path

from burstcast_workflow.harness.settings import JobSettings, at


def declared_settings(script: Path, sources: Path, name: str = "") -> list[str]:
    """Paths of the settings of a class of a script: of the one that its function takes.

    ``sources``: Directory of the packages, where modules are that define bases of the class.
    ``name``: Another class of the script.
    """
    return [*dict.fromkeys(_paths(script, name or _taken(script), sources))]


def _taken(script: Path) -> str:
    function = _tree(script, script.stat().st_mtime_ns).body[-1]
    for argument in function.args.kwonlyargs if isinstance(function, ast.FunctionDef) else ():
        if argument.arg == "settings" and argument.annotation is not None:
            return ast.unparse(argument.annotation)
    raise TypeError(f"{script}: its last function takes no settings")


def _paths(file: Path, name: str, sources: Path) -> Iterator[str]:
    """Paths of a class of settings that a file defines or imports."""
    if name == JobSettings.__name__:
        return
    for node in _tree(file, file.stat().st_mtime_ns).body:
        if isinstance(node, ast.ClassDef) and node.name == name:
            for base in node.bases:
                yield from _paths(file, ast.unparse(base), sources)
            values = (field.value for field in node.body if isinstance(field, ast.AnnAssign))
            for value in values:
                if isinstance(value, ast.Call) and ast.unparse(value.func) == at.__name__:
                    yield ast.literal_eval(value.args[0])
            return
        if isinstance(node, ast.ImportFrom) and name in [one.name for one in node.names]:
            module = sources.joinpath(*str(node.module).split(".")).with_suffix(".py")
            yield from _paths(module, name, sources)
            return
    raise TypeError(f"{file} has no class {name}, whose settings a job would be given")


@cache
def _tree(file: Path, _changed: int) -> ast.Module:
    return ast.parse(file.read_text(encoding="utf-8"), str(file))
