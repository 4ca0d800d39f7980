"""Figures by name: the module ``burstcast.figures.<name>`` is one figure.

Its docstring is the caption, and its function ``draw`` draws it, of what its arguments declare
(`burstcast.base.declared`). A new figure is one new module; nothing has to be registered.
"""

import inspect
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from matplotlib.figure import Figure

import burstcast.figures
from burstcast.base.declared import File, declaring, files_of, paths_of
from burstcast.base.discovery import imported, module_names
from burstcast.figures.parts.style import styled

_OTHERS = ("parts", "registry")


@dataclass(frozen=True)
class Drawn:
    """A figure: its place in the report, the cases that it is made for, and its function."""

    section: str  #: name of the section of the report that shows the figure
    position: int  #: place in that section: figures with smaller numbers come first
    #: choice of cases that the figure is made for, a property of
    #: `burstcast_workflow.campaign.shown.Choices`. The first case has the plain name, the figures
    #: of the others end in ``_<case>``.
    cases: str
    only_flows: bool  #: whether only cases with a velocity field have the figure
    needs_networks: bool  #: whether there is nothing to draw in a campaign without networks
    draw: Callable[..., Figure]

    def __call__(self, **arguments: Any) -> Figure:
        """Draw the figure, in the shared style."""
        return self.draw(**arguments)

    @cached_property
    def files(self) -> dict[str, File]:
        """Files that it is made of, by the name of the argument."""
        return files_of(self.draw)

    @cached_property
    def paths(self) -> list[str]:
        """Paths of its settings."""
        return paths_of(self.draw)

    @property
    def published(self) -> bool:
        """Whether it shows the paper's values, if they are wanted: in the argument ``published``.

        They are a table, or None.
        """
        return "published" in inspect.signature(self.draw).parameters

    @property
    def always_published(self) -> bool:
        """Whether it has no meaning without the paper's values."""
        parameters = inspect.signature(self.draw).parameters
        return self.published and parameters["published"].default is inspect.Parameter.empty


def figure(
    *,
    section: str,
    position: int,
    cases: str = "example_case",
    only_flows: bool = False,
    needs_networks: bool = False,
) -> Callable[[Callable[..., Figure]], Drawn]:
    """Declare that a function draws a figure (`Drawn`)."""
    return lambda draw: Drawn(
        section, position, cases, only_flows, needs_networks, declaring(styled(draw))
    )


def available_figures() -> list[str]:
    """Names of all the figures, sorted."""
    return [name for name in module_names(burstcast.figures) if name not in _OTHERS]


def figure_of(name: str) -> Drawn:
    """The figure of a name."""
    drawn = getattr(imported(f"burstcast.figures.{name}"), "draw", None)
    if not isinstance(drawn, Drawn):
        raise TypeError(
            f"burstcast/figures/{name}.py has no function draw with the decorator "
            f"@figure(section=..., position=...)"
        )
    return drawn


def caption(name: str) -> str:
    """Caption of a figure in reStructuredText, on one line."""
    return " ".join((imported(f"burstcast.figures.{name}").__doc__ or "").split())
