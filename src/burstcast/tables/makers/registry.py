"""Tables of a case by name: the module ``burstcast.tables.makers.<name>`` makes one, or several.

`Declaration` says what they are made of, and the function ``make`` gives their rows by the name of
the table. Key columns of the case need not be among them.
"""

import ast
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from types import ModuleType
from typing import Any

from burstcast.declared_settings import paths_by_argument
from burstcast.discovery import imported
from burstcast.forecasters._names import ForecasterName

Rows = list[dict[str, Any]]
"""Rows of a table: values by column."""

PATH = "path"
"""Declares that an input is the path of the file, of which only some rows are read."""


@dataclass(frozen=True)
class Declaration:
    """Inputs of tables, by the names of the arguments of ``make``."""

    #: variables that are read of each input, where it is a NetCDF file: none stands for all of
    #: them; or `PATH`. The input is the content of the file: variables and attributes, what a JSON
    #: file says, or a table; None where a case has no such file.
    inputs: Mapping[str, str] = field(default_factory=dict)
    #: likewise of inputs that are files of all forecasters, or of all runs of control: each is a
    #: list of `Gathered`
    gathered: Mapping[str, str] = field(default_factory=dict)
    #: paths of settings in the config (`burstcast.declared_settings`). ``case.`` stands for the
    #: case; ``case`` is its name.
    settings: str = ""

    @property
    def paths(self) -> dict[str, str]:
        """Path of each setting by the name of its argument."""
        return paths_by_argument(self.settings)


@dataclass(frozen=True)
class Gathered:
    """A file of each forecaster, or of each run of control, of a case."""

    name: ForecasterName  #: forecaster, or controller, of the file
    content: Mapping[str, Any]  #: content of the file (see `Declaration`)
    #: settings of a run of control; empty for other files
    plan: Mapping[str, Any] = field(default_factory=dict)


def settings_of(name: str) -> list[str]:
    """Paths of the settings that a module of tables declares, without importing it."""
    declared = _assigned(name, "TABLES")
    assert isinstance(declared, ast.Call)
    said = "".join(ast.unparse(one.value) for one in declared.keywords if one.arg == "settings")
    if "{SETTINGS}" in said:
        shared = ast.literal_eval(_assigned("_probabilities", "SETTINGS"))
        said = said.replace("{SETTINGS}", shared)
    paths = paths_by_argument(said.removeprefix("f").strip("'")).values()
    return [path for path in paths if path != "case"]


def _assigned(name: str, wanted: str) -> ast.expr:
    """Expression that a module assigns to a name."""
    text = Path(__file__).with_name(f"{name}.py").read_text(encoding="utf-8")
    found = (node for node in ast.parse(text).body if isinstance(node, ast.Assign))
    return next(node.value for node in found if ast.unparse(node.targets[0]) == wanted)


def maker(name: str) -> ModuleType:
    """Import a module of tables, which has ``TABLES``, its declaration, and ``make``."""
    return imported(f"burstcast.tables.makers.{name}")
