"""Nothing imports upwards: packages, and the parts of the workflow's package."""

import ast
from pathlib import Path

import pytest

SOURCE = Path(__file__).parents[2] / "src"
# Each may import those before it; what offers the rest to notebooks and commands is above all.
PACKAGES = ("burstcast", "snaketrust", "snakemake_logger_plugin_burstcast", "burstcast_workflow")
PARTS = (
    *("project", "harness", "jobs", "config", "campaign", "tables", "start", "costs"),
    *("stages", "figures", "commands"),
)


def imported(path):
    """Modules that a file imports, wherever it does so."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert not node.level, path
            yield str(node.module)


def imports_between(directory, prefix):
    """Parts of a directory that import others: part, the other, file."""
    for path in sorted(directory.rglob("*.py")):
        part = path.relative_to(directory).parts[0].removesuffix(".py")
        for module in imported(path):
            if module.startswith(prefix):
                other = module.removeprefix(prefix).partition(".")[0]
                if part not in (other, "__init__", "__main__"):
                    yield part, other, path.relative_to(directory)


def test_the_parts_of_the_workflow_import_downwards():
    found = list(imports_between(SOURCE / "burstcast_workflow", "burstcast_workflow."))
    assert {part for part, *_ in found} >= {"stages", "figures", "config", "jobs"}
    up = [
        (part, other, path)
        for part, other, path in found
        if part not in PARTS[PARTS.index(other) :]
    ]
    assert up == []


@pytest.mark.parametrize("package", PACKAGES)
def test_packages_import_downwards(package):
    above = {*PACKAGES[PACKAGES.index(package) + 1 :], "burstcast_report"}
    above |= {"snaketrust"} if package == "burstcast" else set()
    above |= {"burstcast"} if package == "snaketrust" else set()
    for path in sorted((SOURCE / package).rglob("*.py")):
        assert not above & {module.partition(".")[0] for module in imported(path)}, path
