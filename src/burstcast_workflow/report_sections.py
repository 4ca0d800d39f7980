"""The report in its order: in which section each figure and each table stands."""

from collections.abc import Mapping
from dataclasses import dataclass

from burstcast.discovery import suggestion
from burstcast.figures.registry import Declaration, available_figures, declaration
from burstcast_workflow.tables.declarations import TABLES
from burstcast_workflow.tables.registry import with_percentiles


@dataclass(frozen=True)
class Section:
    """Figures and tables that belong together, by their names, in the order of the report.

    Attributes
    ----------
    name
        Name in the declarations of figures and tables.
    title
        Title in the report.
    """

    name: str
    title: str

    @property
    def figures(self) -> list[str]:
        """Names of its figures."""
        return [name for name, figure in FIGURES.items() if figure.section == self.name]

    @property
    def tables(self) -> list[str]:
        """Names of its tables, in the order of their declarations."""
        return with_percentiles(
            name for name, table in TABLES.items() if table.section == self.name
        )


SECTIONS = (
    Section("data", "Flow and data"),
    Section("networks", "Networks and their training"),
    Section("forecasts", "Forecasts of extreme events"),
    Section("horizon", "Prediction horizon"),
    Section("probabilities", "Probabilities and alarms"),
    Section("long_term", "Long-term statistics"),
    Section("control", "Control"),
    Section("warnings", "Warning signs"),
)
"""All sections, in the order of the report."""


def _figures() -> Mapping[str, Declaration]:
    sections = [section.name for section in SECTIONS]
    found = {name: declaration(name) for name in available_figures()}
    for name, figure in found.items():
        if figure.section not in sections:
            raise ValueError(
                f"the figure {name} declares the section {figure.section!r}"
                f"{suggestion(figure.section, sections)}; the sections are {', '.join(sections)}"
            )
    place = {name: (sections.index(one.section), one.position) for name, one in found.items()}
    return {name: found[name] for name in sorted(found, key=place.__getitem__)}


FIGURES = _figures()
"""Declarations of all figures by name, in the order of the report."""


def category(kind: str, name: str) -> str:
    """Section of a figure or a table, as Snakemake is told it.

    Parameters
    ----------
    kind
        "figures" or "tables".
    name
        Of the figure or table.

    Raises
    ------
    LookupError
        If it is in none.
    """
    for number, section in enumerate(SECTIONS, start=1):
        if name in getattr(section, kind):
            return f"{number} {section.title}"
    raise LookupError(f"{name} has no place in the report: its declaration must name its section")
