"""The product and its tests have budgets of lines: for the whole, none by folder.

Nothing is won by moving a line. A sum has outgrown its budget: look first for what the change has
made needless, or for a fact that is stated twice. If the lines are worth it, raise the number here,
and say in the commit why. Lower it where the sum has shrunk by more than the room that is left.
"""

import ast
import subprocess
from collections import Counter
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
BUDGET = {
    "product, all lines": 43_500,
    "product, code": 26_300,
    "product, docstrings": 6_900,
    "tests, all lines": 27_500,
}
ROOM = 0.02
SUFFIXES = {".py", ".smk", ".jinja", ".css", ".js", ".html"}


def lines_of(text, python):
    """Lines of a source by kind: what is no blank, comment, docstring or import is code."""
    kinds = ["code"] * len(text.splitlines())
    for number, line in enumerate(text.splitlines()):
        if not line.strip() or line.strip().startswith(("#", "{#", "/*", "//")):
            kinds[number] = "other"
    for node in ast.walk(ast.parse(text)) if python else ():
        kind = ""
        if isinstance(node, ast.Import | ast.ImportFrom):
            kind = "other"
        elif isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant):
            kind = "docstrings" if isinstance(node.value.value, str) else ""
        if kind:
            for number in range(node.lineno - 1, node.end_lineno or node.lineno):
                kinds[number] = kind
    return Counter(kinds)


def sums():
    """Lines of the files that git knows, by the names of budgets."""
    command = ["git", "ls-files", "-z", "src", "workflow", "docs/results"]
    command += ["Snakefile", "setup.py", "tests"]
    listed = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True).stdout
    counts: Counter[str] = Counter()
    for name in filter(None, listed.split("\0")):
        path = ROOT / name
        if path.is_file() and (path.suffix in SUFFIXES or path.name == "Snakefile"):
            lines = lines_of(path.read_text(encoding="utf-8"), path.suffix == ".py")
            part = "tests" if name.startswith("tests/") else "product"
            counts[f"{part}, all lines"] += lines.total()
            for kind in ("code", "docstrings"):
                counts[f"{part}, {kind}"] += lines[kind]
    return counts


def test_lines_are_counted_by_kind():
    text = '"""A module."""\n\nimport os\n\n# alone\nx = os.sep  # behind\n"""Of x."""\n'
    assert lines_of(text, python=True) == {"docstrings": 2, "other": 4, "code": 1}
    assert lines_of("rule a:\n    input: b\n\n# c\n", python=False) == {"code": 2, "other": 2}


@pytest.mark.parametrize("name", BUDGET)
def test_a_sum_keeps_to_its_budget(name):
    if not (ROOT / ".git").exists():
        pytest.skip("the files of the project are those that git knows")
    lines, budget = sums()[name], BUDGET[name]
    assert lines <= budget, f"{name}: {lines}, the budget is {budget}. {__doc__}"
    assert lines >= (1 - 2 * ROOM) * budget, f"{name}: {lines} only; lower the budget, {budget}"
