"""The report in its order: in which section each figure and each table stands."""

from dataclasses import dataclass
from pathlib import Path

from burstcast_workflow.tables.declarations import TABLES
from burstcast_workflow.tables.registry import with_percentiles


@dataclass(frozen=True)
class Section:
    """Figures and tables that belong together, by their names, in the order of the report.

    Attributes
    ----------
    name
        Name in the declarations of tables.
    title
        Title in the report.
    figures
        Names of its figures.
    """

    name: str
    title: str
    figures: tuple[str, ...] = ()

    @property
    def tables(self) -> list[str]:
        """Names of its tables, in the order of their declarations."""
        return with_percentiles(
            name for name, table in TABLES.items() if table.section == self.name
        )


def _names(text: str) -> tuple[str, ...]:
    return tuple(text.split())


SECTIONS = (
    Section("data", "Flow and data", _names("observable_and_density")),
    Section(
        "networks",
        "Networks and their training",
        _names("network_schematic validation_strategies search_landscape"),
    ),
    Section(
        "forecasts",
        "Forecasts of extreme events",
        _names(
            "prediction_schematic prediction_examples classification_scores observed_components "
            "midplane_planes vorticity_isosurfaces"
        ),
    ),
    Section(
        "horizon",
        "Prediction horizon",
        _names("horizon_schematic horizon_evaluations horizon_by_size by_reynolds"),
    ),
    Section(
        "probabilities",
        "Probabilities and alarms",
        _names("forecast_skill reliability economic_value alarm_lead_times committee_event"),
    ),
    Section(
        "long_term",
        "Long-term statistics",
        _names("long_term_density profile_errors midplane_mean_square survival lyapunov_spectrum"),
    ),
    Section(
        "control",
        "Control",
        _names(
            "control_schematic suppressed_event control_tradeoff control_density control_frontier"
        ),
    ),
    Section("warnings", "Warning signs"),
)
"""All sections: figures in the order of the paper, of tables what is read first."""


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
    raise LookupError(f"{name} has no place in the report: give it one in {Path(__file__).name}")
