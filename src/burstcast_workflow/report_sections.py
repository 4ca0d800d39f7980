"""The report in its order: in which section each figure and each table stands."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any


@dataclass(frozen=True)
class Section:
    """Figures and tables that belong together, by their names, in the order of the report."""

    title: str
    figures: tuple[str, ...] = ()
    tables: tuple[str, ...] = ()


def _names(text: str) -> tuple[str, ...]:
    return tuple(text.split())


SECTIONS = (
    Section(
        "Flow and data",
        _names("observable_and_density"),
        _names("dataset data_generation_parameters"),
    ),
    Section(
        "Networks and their training",
        _names("network_schematic validation_strategies search_landscape"),
        _names("network_hyperparameters hyperparameters_percentiles hyperparameters"),
    ),
    Section(
        "Forecasts of extreme events",
        _names(
            "prediction_schematic prediction_examples classification_scores observed_components "
            "midplane_planes vorticity_isosurfaces"
        ),
        _names(
            "classification_percentiles classification classification_intervals "
            "training_realisations"
        ),
    ),
    Section(
        "Prediction horizon",
        _names("horizon_schematic horizon_evaluations horizon_by_size by_reynolds"),
        _names("horizon_percentiles horizon horizon_intervals horizon_differences"),
    ),
    Section(
        "Probabilities and alarms",
        _names("forecast_skill reliability economic_value alarm_lead_times committee_event"),
        _names(
            "probability_scores probability_differences reliability economic_value lead_times "
            "alarm_curves threshold_sweep"
        ),
    ),
    Section(
        "Long-term statistics",
        _names("long_term_density profile_errors midplane_mean_square survival lyapunov_spectrum"),
        _names(
            "statistics_percentiles statistics statistics_intervals survival_percentiles survival "
            "survival_curve_percentiles survival_curve lyapunov_spectrum_percentiles "
            "lyapunov_spectrum kaplan_yorke_percentiles kaplan_yorke"
        ),
    ),
    Section(
        "Control",
        _names(
            "control_schematic suppressed_event control_tradeoff control_density control_frontier"
        ),
        _names(
            "control_percentiles control control_density control_strategies control_differences"
        ),
    ),
    Section("Warning signs", tables=_names("warnings")),
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


def category_of_table(table: str) -> str | Callable[[Any], str]:
    """Section of a table, told its name; of a wildcard's, a function of the job's wildcards."""
    if "{" not in table:
        return category("tables", table)
    return lambda wildcards: category("tables", wildcards.table)
