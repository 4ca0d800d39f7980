"""Figures by name: the module ``burstcast.figures.<name>`` is one figure.

Its docstring is the caption, `Declaration` says what it is made of, and its function ``draw`` draws
it. A new figure is one new module; nothing has to be registered.

The caption and the declaration are read from the module's text, which takes a thousandth of the
time that importing Matplotlib takes: both must stand before the first function or class.
"""

import ast
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from types import ModuleType

import burstcast.figures
from burstcast.declared_settings import paths_by_argument
from burstcast.discovery import imported, module_names

_OTHERS = ("parts", "registry")


@dataclass(frozen=True)
class Declaration:
    """Inputs and settings of a figure, by the names of the arguments of its function ``draw``.

    The declaration is a call with literals only.
    """

    section: str  #: name of the section of the report that shows the figure
    position: int  #: place in that section: figures with smaller numbers come first
    #: file of each input: the place that it lies in, and its name there. ``case`` is the directory
    #: of the figure's case, ``example`` of the example network. The input is the content of the
    #: file: a table as a DataFrame, a NetCDF file as a mapping of its variables and attributes, a
    #: JSON file as a mapping. A place with several directories gives a list.
    #: ``<file>.nc:<variable>`` is one variable.
    inputs: Mapping[str, str] = field(default_factory=dict)
    #: paths of settings in the config (`burstcast.declared_settings`). ``case.`` stands for the
    #: figure's case; ``shown.`` for what the campaign chooses to show.
    settings: str = ""
    #: name of the choice of cases that the figure is made for. The first case has the plain name,
    #: the figures of the others end in ``_<case>``.
    cases: str = "example"
    only_flows: bool = False  #: whether only cases with a velocity field have the figure
    #: whether the figure shows the paper's published values, if these are wanted: as a table in the
    #: argument ``published``, or None
    published: bool = False

    @property
    def paths(self) -> dict[str, str]:
        """Path of each setting by the name of its argument."""
        return paths_by_argument(self.settings)


def available_figures() -> list[str]:
    """Names of all the figures, sorted."""
    return [name for name in module_names(burstcast.figures) if name not in _OTHERS]


def figure_module(name: str) -> ModuleType:
    """Import the module of a figure, which has ``FIGURE``, its declaration, and ``draw``."""
    return imported(f"burstcast.figures.{name}")


@cache
def declaration(name: str) -> Declaration:
    """Declaration of a figure, without importing its module."""
    for node in _head(name).body:
        if isinstance(node, ast.Assign) and ast.unparse(node.targets[0]) == "FIGURE":
            assert isinstance(node.value, ast.Call)
            values = {str(one.arg): ast.literal_eval(one.value) for one in node.value.keywords}
            return Declaration(**values)
    raise ValueError(
        f"the figure {name} has no declaration: write FIGURE = Declaration(...) in "
        f"burstcast/figures/{name}.py, before the first function or class"
    )


@cache
def caption(name: str) -> str:
    """Caption of a figure in reStructuredText, on one line."""
    return " ".join((ast.get_docstring(_head(name)) or "").split())


@cache
def _head(name: str) -> ast.Module:
    """Syntax tree of what stands in a module before two blank lines: no function, no class."""
    text = Path(__file__).with_name(f"{name}.py").read_text(encoding="utf-8")
    return ast.parse(text.partition("\n\n\n")[0])
