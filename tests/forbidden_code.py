"""Code that hashes cannot follow, docstrings that they leave out, settings without a parameter."""

import ast

_FORBIDDEN_MODULES = frozenset({"importlib", "imp", "pkgutil", "runpy", "zipimport"})
_FORBIDDEN_NAMES = frozenset({"__import__", "compile", "eval", "exec"})


def forbidden_imports(path):
    """Places of a file that run code which hashes do not see, as ``line 3: ...``.

    These are imports by computed names, code made from text, and ``import *``, after which it is
    unclear where a name comes from. ``from importlib.metadata import ...`` only reads versions and
    is allowed.
    """
    return _places(path, _forbidden_import)


def forbidden_reads(path):
    """Places of a script that read something of Snakemake which no parameter carries.

    A script leaves the object ``snakemake`` to the decorator `burstcast_workflow.harness.job.job`:
    its config would be settings that nothing tracks.
    """
    return _places(path, _forbidden_read)


_DOCSTRINGS = {
    *("__doc__", "getdoc", "get_docstring", "getsource", "getsourcelines", "getcomments"),
}


def docstrings_read(path, allowed=frozenset()):
    """Places of a file that read a docstring or a source, on which hashes do not depend.

    ``allowed``: functions of it that may, since they only pass words on to people.
    """
    tree = ast.parse(path.read_bytes(), str(path))
    for node in [*ast.walk(tree)]:
        if isinstance(body := getattr(node, "body", None), list):
            node.body = [
                statement for statement in body if getattr(statement, "name", "") not in allowed
            ]
    return [
        f"line {node.lineno}: {ast.unparse(node)}"
        for node in ast.walk(tree)
        if getattr(node, "id", getattr(node, "attr", "")) in _DOCSTRINGS
        or (
            isinstance(node, ast.ImportFrom)
            and _DOCSTRINGS & {statement.name for statement in node.names}
        )
    ]


def offered_late(path, package):
    """Places of a file that use what a package offers by a function ``__getattr__``, or offer it.

    ``package``: its directory.
    """
    tree = ast.parse(path.read_bytes(), str(path))
    nodes: list[ast.AST] = [
        node for node in tree.body if getattr(node, "name", "") in ("__getattr__", "__dir__")
    ]
    modules = {file.stem for file in package.iterdir()}
    qualified = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom) and node.module == package.name and not node.level:
            nodes += [node] * any(alias.name not in modules for alias in node.names)
        if isinstance(node, ast.alias) and node.name == package.name and node.asname:
            nodes.append(node)
        if isinstance(node, ast.Attribute) and getattr(node.value, "id", "") == package.name:
            qualified.add(node.value)
            nodes += [node] * (node.attr not in modules)
        if isinstance(node, ast.Name) and node.id == package.name and node not in qualified:
            nodes.append(node)
    return [f"line {node.lineno}: {ast.unparse(node)}" for node in nodes]


def _places(path, find):
    tree = ast.parse(path.read_bytes(), str(path))
    return [
        f"line {getattr(node, 'lineno', 0)}: {what}"
        for node in ast.walk(tree)
        if (what := find(node))
    ]


def _forbidden_import(node):
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


def _forbidden_read(node):
    if isinstance(node, ast.Attribute | ast.Subscript) and _is_snakemake(node.value):
        return f"snakemake.{node.attr}" if isinstance(node, ast.Attribute) else "snakemake[...]"
    if isinstance(node, ast.Assign | ast.AnnAssign | ast.NamedExpr) and _is_snakemake(node.value):
        return "snakemake under another name"
    if isinstance(node, ast.Call):
        called = node.func.id if isinstance(node.func, ast.Name) else ""
        if any(_is_snakemake(argument) for argument in node.args):
            return f"snakemake handed to {called or 'something'}"
    return ""


def _is_snakemake(node):
    return isinstance(node, ast.Name) and node.id == "snakemake"
